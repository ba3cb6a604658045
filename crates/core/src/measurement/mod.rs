//! What was measured: a list of experiments, each with one periodic input, or motions whose
//! input does not repeat.
//!
//! Text becomes a [`Measurement`] in [`formats`], and a `Measurement` cannot be
//! invalid: its fields are private and [`Measurement::new`] checks them.

mod experiment;
pub mod formats;
mod metadata;
mod period;
mod record;
mod repetition;
mod sampling;
mod scatter;
mod significance;
mod size;
mod spectrum;
mod transient;
mod units;
mod waveform;

pub use experiment::{Experiment, Harmonic, Repeat};
pub use metadata::{Loop, Metadata, Quantity, ResponseKind};
pub use record::{Record, RecordError};
pub use transient::{Beginning, Intersample, Transient};

/// Complex number; angles in radians.
pub type Complex = nalgebra::Complex<f64>;

/// A measured response: what was done, what came back, and how certain it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    metadata: Metadata,
    experiments: Vec<Experiment>,
    transients: Vec<Transient>,
    /// Remarks of the reader for the user: unknown columns, dropped periods, …
    notes: Vec<String>,
    sha256: String,
    /// First and last position in the order of acquisition.
    acquisition: Option<[f64; 2]>,
}

/// A measurement that cannot be used, whatever text it came from.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InvalidMeasurement {
    /// No experiment at all.
    #[error("the measurement has no experiment")]
    Empty,
    /// A value of one experiment is unusable.
    #[error("experiment {experiment}: {reason}")]
    Experiment {
        /// Index of the experiment, from 0.
        experiment: usize,
        /// What is wrong with it.
        reason: String,
    },
}

impl Measurement {
    /// Joins experiments to a measurement.
    ///
    /// `sha256` is the hexadecimal digest of the bytes it was read from.
    ///
    /// # Errors
    /// When there is no experiment, or a value is not finite, a magnitude
    /// negative, a frequency or deviation not positive, a repeat not aligned
    /// with the data it deviates from, or a size beyond what can be computed with.
    pub fn new(
        metadata: Metadata,
        experiments: Vec<Experiment>,
        notes: Vec<String>,
        sha256: String,
    ) -> Result<Self, InvalidMeasurement> {
        if experiments.is_empty() {
            return Err(InvalidMeasurement::Empty);
        }
        for (index, experiment) in experiments.iter().enumerate() {
            experiment
                .check()
                .map_err(|reason| InvalidMeasurement::Experiment { experiment: index, reason })?;
        }
        check_sizes(&experiments)?;
        let runs = || experiments.iter().filter_map(|experiment| experiment.run);
        let acquisition = runs().reduce(f64::min).zip(runs().reduce(f64::max));
        let acquisition = acquisition.map(|(first, last)| [first, last]);
        Ok(Self { metadata, experiments, transients: Vec::new(), notes, sha256, acquisition })
    }

    /// Joins motions that do not repeat to a measurement that has no experiment: models can be
    /// tried on it, and none be fitted to it.
    ///
    /// # Errors
    /// When there is no motion, or one has a value that is not finite, too few samples, or no
    /// samples left to compare.
    pub fn of_transients(
        metadata: Metadata,
        transients: Vec<Transient>,
        notes: Vec<String>,
        sha256: String,
    ) -> Result<Self, InvalidMeasurement> {
        if transients.is_empty() {
            return Err(InvalidMeasurement::Empty);
        }
        for (experiment, transient) in transients.iter().enumerate() {
            transient
                .check()
                .map_err(|reason| InvalidMeasurement::Experiment { experiment, reason })?;
        }
        let runs = || transients.iter().filter_map(|transient| transient.run);
        let acquisition = runs().reduce(f64::min).zip(runs().reduce(f64::max));
        let acquisition = acquisition.map(|(first, last)| [first, last]);
        Ok(Self { metadata, experiments: Vec::new(), transients, notes, sha256, acquisition })
    }

    /// Some of its experiments, or of their harmonics: a part, whose place in the order of
    /// acquisition is still counted over the whole.
    ///
    /// # Errors
    /// As for [`Measurement::new`].
    pub fn part(&self, experiments: Vec<Experiment>) -> Result<Self, InvalidMeasurement> {
        let Self { metadata, notes, sha256, acquisition, .. } = self.clone();
        Ok(Self { acquisition, ..Self::new(metadata, experiments, notes, sha256)? })
    }

    /// The same with one more experiment at the end.
    ///
    /// # Errors
    /// As for [`Measurement::new`].
    pub fn with(&self, experiment: Experiment) -> Result<Self, InvalidMeasurement> {
        let Self { metadata, experiments, notes, sha256, .. } = self.clone();
        let experiments = experiments.into_iter().chain([experiment]).collect();
        Self::new(metadata, experiments, notes, sha256)
    }

    /// What the upload says of itself.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// The experiments, in the order of the upload.
    pub fn experiments(&self) -> &[Experiment] {
        &self.experiments
    }

    /// Motions that do not repeat, in the order of the upload; a measurement with any has no
    /// experiment.
    pub fn transients(&self) -> &[Transient] {
        &self.transients
    }

    /// First and last position in the order of acquisition; of a part, of the whole it is of.
    pub fn acquisition(&self) -> Option<[f64; 2]> {
        self.acquisition
    }

    /// Remarks of the reader for the user.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Hexadecimal SHA-256 of the bytes it was read from.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }
}

/// The largest response can be computed with, and so can every deviation beside it.
fn check_sizes(experiments: &[Experiment]) -> Result<(), InvalidMeasurement> {
    let wrong = |experiment, reason| InvalidMeasurement::Experiment { experiment, reason };
    let every = || {
        let of = |(index, e)| -> Vec<(usize, Harmonic)> {
            let e: &Experiment = e;
            e.response.iter().map(|harmonic| (index, *harmonic)).collect()
        };
        experiments.iter().enumerate().flat_map(of)
    };
    let size = |harmonic: &Harmonic| harmonic.value.re.abs().max(harmonic.value.im.abs());
    let largest = every().max_by(|a, b| size(&a.1).total_cmp(&size(&b.1)));
    let Some((index, largest)) = largest.map(|(index, harmonic)| (index, size(&harmonic))) else {
        return Ok(());
    };
    if let Some(reason) = size::fault("a largest response", largest) {
        return Err(wrong(index, reason));
    }
    let within = 1.0 / size::LARGEST_DEVIATION..=size::LARGEST_DEVIATION;
    let told = every().filter_map(|(index, harmonic)| Some((index, harmonic.std?)));
    let odd = told.filter(|_| largest > 0.0).find(|(_, std)| !within.contains(&(std / largest)));
    match odd {
        Some((index, std)) => Err(wrong(
            index,
            format!(
                "a standard deviation of {std:e} beside a largest response of {largest:e} cannot \
                 be computed with: give it in units of the response, or leave it out"
            ),
        )),
        None => Ok(()),
    }
}
