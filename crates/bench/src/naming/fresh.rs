//! Checks the gain reported by a diagnosis against a fresh measurement of the same machine.

use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use servoscope_core::answers::{Comparison, Diagnosis};
use servoscope_core::diagnose::DiagnoseError;
use servoscope_core::identify::compare;
use servoscope_core::measurement::Measurement;

use super::MakeError;
use super::build_case::Made;
use crate::machines::draw::{Draw, DrawError, NoiseStatement, log_uniform};
use crate::machines::simulator::Settings;

/// Number of frequencies at every magnitude, each drawn from its own part of the range.
const FREQUENCIES: usize = 48;

/// The gain reported by a diagnosis, and the gain on fresh data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fresh {
    /// Ratio of the errors, as reported by the diagnosis.
    pub ratio: f64,
    /// Its 95 % interval.
    pub interval95: [f64; 2],
    /// χ² per degree of freedom of the extended model on the held-out data.
    pub chi2_per_dof_after: Option<f64>,
    /// Ratio of the errors of the same two models on fresh data.
    pub found: f64,
}

impl Fresh {
    /// Whether the interval contains the ratio on fresh data.
    pub fn held(&self) -> bool {
        (self.interval95[0]..=self.interval95[1]).contains(&self.found)
    }
}

/// Measures the machine of a draw again, at the magnitudes of its design, at many other
/// frequencies within its range and with the same noise. Then compares both models of the diagnosis
/// with that. `None` if the diagnosis reports no gain.
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
    let responses = made.instrument.responses(&machine, &Settings::default())?;
    let experiments = responses.experiments_with(&made.noise, NoiseStatement::Std, rng);
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

/// Random frequencies at each magnitude of the design, in its order of acquisition.
///
/// A diagnosis holds out every frequency of the design except the lowest and the highest. Each
/// represents the range nearer to it than to its neighbours on a logarithmic scale. The new
/// frequencies are drawn from the union of these ranges.
fn design(machine: &Draw, rng: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
    let mut omegas: Vec<f64> = machine.design.iter().map(|point| point.1).collect();
    omegas.sort_by(f64::total_cmp);
    omegas.dedup();
    let half_way = |i: usize| (omegas[i] * omegas[i + 1]).sqrt();
    let (slowest, fastest) = (half_way(0), half_way(omegas.len() - 2));
    let at = |i: usize| slowest * (fastest / slowest).powf(i as f64 / FREQUENCIES as f64);
    let mut magnitudes: Vec<f64> = machine.design.iter().map(|point| point.0).collect();
    magnitudes.dedup();
    let mut design = Vec::new();
    for magnitude in magnitudes {
        design.extend((0..FREQUENCIES).map(|i| (magnitude, log_uniform(at(i), at(i + 1), rng))));
    }
    design
}

/// Σ|Y − Ŷ|².
fn squares(comparison: &Comparison) -> f64 {
    let harmonics = comparison.experiments.iter().flat_map(|e| &e.harmonics);
    let left = harmonics.map(|h| [0, 1].map(|i| (h.measured[i] - h.simulated[i]).powi(2)));
    left.flatten().sum()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::machines::draw::draw;

    #[test]
    fn fresh_points_lie_nearer_to_what_was_held_out_than_to_the_ends() {
        let machine = draw(0, 3);
        let fresh = design(&machine, &mut ChaCha8Rng::seed_from_u64(1));
        assert_eq!(fresh.len(), 3 * FREQUENCIES);
        let half_way = |i: usize| (machine.design[i].1 * machine.design[i + 1].1).sqrt();
        let held_out = half_way(0)..=half_way(14);
        assert!(fresh.iter().all(|(_, omega)| held_out.contains(omega)));
        // The range is divided into equal parts, with one frequency in each.
        let mut of_first = fresh[..FREQUENCIES].iter().map(|(_, omega)| *omega);
        let part = (held_out.end() / held_out.start()).powf(1.0 / FREQUENCIES as f64);
        let ends = [of_first.clone().next().unwrap(), of_first.next_back().unwrap()];
        assert!(ends[0] < held_out.start() * part && ends[1] > held_out.end() / part);
        for (magnitude, omega) in &fresh {
            assert!(machine.design.iter().any(|point| point.0 == *magnitude), "{magnitude}");
            assert!(machine.design.iter().all(|point| point.1 != *omega), "{omega}");
        }
    }

    #[test]
    fn an_interval_contains_the_values_between_its_ends() {
        let fresh =
            Fresh { ratio: 2.0, interval95: [1.5, 2.5], chi2_per_dof_after: None, found: 2.4 };
        assert!(fresh.held() && !Fresh { found: 2.6, ..fresh }.held());
    }
}
