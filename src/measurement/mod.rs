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
mod sampling;
mod significance;
mod spectrum;
mod transient;
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
    /// negative, a frequency or deviation not positive, or a repeat not aligned
    /// with the data it deviates from.
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
