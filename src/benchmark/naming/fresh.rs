//! Whether a gain is what a fresh measurement of the same machine shows.

use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::MakeError;
use super::make::Made;
use crate::answers::{Comparison, Diagnosis};
use crate::benchmark::draw::{Draw, DrawError, NoiseStatement, log_uniform};
use crate::benchmark::responses::Responses;
use crate::benchmark::simulator::Settings;
use crate::diagnose::DiagnoseError;
use crate::identify::compare;
use crate::measurement::Measurement;

/// Frequencies at every magnitude, each drawn from its own part of the range.
const FREQUENCIES: usize = 48;

/// A gain as it was given, and as it is found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fresh {
    /// Ratio of the errors as the diagnosis gives it.
    pub ratio: f64,
    /// Its 95 % interval.
    pub interval95: [f64; 2],
    /// χ² per degree of freedom of the extended model on what was held out.
    pub chi2_per_dof_after: Option<f64>,
    /// The ratio of the same two models' errors on fresh data.
    pub found: f64,
}

impl Fresh {
    /// Whether the interval holds what was found.
    pub fn held(&self) -> bool {
        (self.interval95[0]..=self.interval95[1]).contains(&self.found)
    }
}

/// Measures a draw's machine at the magnitudes of its design and at many other frequencies
/// within its range, as noisy as before, and compares both models of a diagnosis with that.
/// `None` where it gives no gain.
///
/// # Errors
/// See [`MakeError`].
pub(super) fn fresh(
    made: &Made,
    diagnosis: &Diagnosis,
    rng: &mut ChaCha8Rng,
) -> Result<Option<Fresh>, MakeError> {
    let (Some(gain), Some(extended)) = (&diagnosis.gain, &diagnosis.extended) else {
        return Ok(None);
    };
    let machine = Draw { design: design(&made.machine, rng), ..made.machine.clone() };
    let responses = Responses::simulate(&machine, &Settings::default())?;
    let experiments = responses.experiments_with(made.noise_std, NoiseStatement::Std, rng);
    let metadata = made.measurement.metadata().clone();
    let measurement = Measurement::new(metadata, experiments, Vec::new(), String::new());
    let measurement = measurement.map_err(DrawError::from)?;
    let error = |model| -> Result<f64, MakeError> {
        Ok(squares(&compare(&measurement, model).map_err(DiagnoseError::from)?))
    };
    Ok(Some(Fresh {
        ratio: gain.ratio,
        interval95: gain.interval95,
        chi2_per_dof_after: gain.chi2_per_dof_after,
        found: (error(&diagnosis.base)? / error(extended)?).sqrt(),
    }))
}

/// Other frequencies, in the order of acquisition of the design.
fn design(machine: &Draw, rng: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
    let omegas = || machine.design.iter().map(|point| point.1);
    let (slowest, fastest) = (omegas().fold(f64::INFINITY, f64::min), omegas().fold(0.0, f64::max));
    let mut magnitudes: Vec<f64> = machine.design.iter().map(|point| point.0).collect();
    magnitudes.dedup();
    let mut design = Vec::new();
    for magnitude in magnitudes {
        design.extend((0..FREQUENCIES).map(|i| {
            let at = |i: usize| slowest * (fastest / slowest).powf(i as f64 / FREQUENCIES as f64);
            (magnitude, log_uniform(at(i), at(i + 1), rng))
        }));
    }
    design
}

/// Σ|Y − Ŷ|².
fn squares(comparison: &Comparison) -> f64 {
    let harmonics = comparison.experiments.iter().flat_map(|e| &e.harmonics);
    let left = harmonics.map(|h| [0, 1].map(|i| (h.measured[i] - h.simulated[i]).powi(2)));
    left.flatten().sum()
}
