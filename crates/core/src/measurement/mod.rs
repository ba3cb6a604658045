//! Measured data: a list of experiments with periodic inputs, or of motions whose input does not
//! repeat.
//!
//! [`formats`] parses files into a [`Measurement`]. A `Measurement` is always valid: its fields
//! are private, and its constructors check them.

mod bad_samples;
mod clipping;
mod convolution;
mod doubts;
mod experiment;
mod fitted_periods;
pub mod formats;
mod intersample;
mod metadata;
mod noise_size;
mod notes;
mod period;
mod period_drift;
mod record;
mod record_error;
mod repetition;
mod resolution;
mod rest_to_rest;
mod sampling;
mod scatter;
mod settling;
mod significance;
mod size;
mod spectrum;
mod stated_period;
mod transient;
mod travel;
mod units;
mod waveform;

use std::collections::BTreeMap;
use std::sync::Arc;

pub use bad_samples::{BadSample, BadSamples};
pub(crate) use doubts::per_cent;
pub use experiment::{ChannelRange, Clipping, Experiment, Harmonic, Repeat};
pub(crate) use metadata::after_number;
pub use metadata::{Loop, Metadata, Quantity, ResponseKind};
pub use record::{Record, RecordStatement};
pub use record_error::RecordError;
pub use transient::{Beginning, Intersample, Transient};
pub(crate) use waveform::{half_peak_to_peak, peak};

/// A line of an input counts as excited if it is larger than this share of the largest line
/// (tuned).
pub(crate) const EXCITED_SHARE: f64 = 0.02;

/// Complex number; angles in radians.
pub type Complex = nalgebra::Complex<f64>;

/// A measurement: inputs, responses, their scatter, and metadata.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    metadata: Metadata,
    experiments: Vec<Experiment>,
    transients: Vec<Transient>,
    /// Remarks of the file reader for the user: unknown columns, dropped periods, …
    notes: Vec<String>,
    sha256: String,
    /// First and last position in the order of acquisition.
    acquisition: Option<[f64; 2]>,
    lines: Arc<Lines>,
}

/// Lines of a file by experiment, harmonic and repeat.
pub(crate) type Lines = BTreeMap<(usize, usize, usize), u64>;

/// Why a measurement is invalid, independent of the file format it came from.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum InvalidMeasurement {
    /// The measurement has no experiment.
    #[error("the measurement has no experiment")]
    Empty,
    /// One experiment has an invalid value.
    #[error("experiment {experiment}: {reason}")]
    Experiment {
        /// Index of the experiment, from 0.
        experiment: usize,
        /// What is wrong with it.
        reason: String,
    },
}

impl Measurement {
    /// Makes a measurement of periodic experiments.
    ///
    /// `sha256` is the hexadecimal digest of the bytes it was read from.
    ///
    /// # Errors
    /// If there is no experiment, a value is not finite, a magnitude is negative, a frequency or
    /// standard deviation is not positive, a repeat does not have the same harmonics as the mean,
    /// or a value is outside the range that floating-point arithmetic can handle.
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
        Ok(Self {
            metadata,
            experiments,
            transients: Vec::new(),
            notes: notes::cut(notes),
            sha256,
            acquisition,
            lines: Arc::default(),
        })
    }

    /// Makes a measurement of motions that do not repeat. Models can be validated on it. A fit takes
    /// only motions that begin and end at rest: see [`Measurement::repeated`].
    ///
    /// # Errors
    /// If there is no motion, or one has a value that is not finite, too few samples, or no
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
        Ok(Self {
            metadata,
            experiments: Vec::new(),
            transients,
            notes: notes::cut(notes),
            sha256,
            acquisition,
            lines: Arc::default(),
        })
    }

    /// A copy of the measurement with one more experiment at the end.
    ///
    /// # Errors
    /// As for [`Measurement::new`].
    pub fn with(&self, experiment: Experiment) -> Result<Self, InvalidMeasurement> {
        let Self { metadata, experiments, notes, sha256, .. } = self.clone();
        let experiments = experiments.into_iter().chain([experiment]).collect();
        Self::new(metadata, experiments, notes, sha256)
    }

    /// The same measurement with other metadata.
    #[must_use]
    pub fn with_metadata(self, metadata: Metadata) -> Self {
        Self { metadata, ..self }
    }

    /// The metadata.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// The experiments, in the order of the upload.
    pub fn experiments(&self) -> &[Experiment] {
        &self.experiments
    }

    /// Motions that do not repeat, in the order of the upload. A measurement has either motions or
    /// experiments, never both.
    pub fn transients(&self) -> &[Transient] {
        &self.transients
    }

    /// First and last position in the order of acquisition, if known.
    pub fn acquisition(&self) -> Option<[f64; 2]> {
        self.acquisition
    }

    /// Remarks of the file reader for the user; where there are very many, the last one says how many
    /// more.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The line of the file that gives a harmonic of an experiment, or of one repeat of it (in the
    /// order of the file); `None` if it is not known, or if several repeats give it.
    pub fn line(&self, experiment: usize, order: usize, repeat: Option<usize>) -> Option<u64> {
        let line = |repeat: usize| self.lines.get(&(experiment, order, repeat)).copied();
        match repeat {
            Some(repeat) => line(repeat),
            None => line(0).filter(|_| line(1).is_none()),
        }
    }

    /// The same measurement with the lines of its file, by experiment, harmonic and repeat.
    pub(crate) fn with_lines(self, lines: Lines) -> Self {
        Self { lines: Arc::new(lines), ..self }
    }

    /// Hexadecimal SHA-256 of the bytes it was read from.
    pub fn sha256(&self) -> &str {
        &self.sha256
    }
}

/// Checks that the largest response, and the ratio of every standard deviation to it, are within
/// the limits of [`size`].
fn check_sizes(experiments: &[Experiment]) -> Result<(), InvalidMeasurement> {
    let wrong = |experiment, reason| InvalidMeasurement::Experiment { experiment, reason };
    let all_harmonics = || {
        let of = |(index, e)| -> Vec<(usize, Harmonic)> {
            let e: &Experiment = e;
            e.response.iter().map(|harmonic| (index, *harmonic)).collect()
        };
        experiments.iter().enumerate().flat_map(of)
    };
    let size = |harmonic: &Harmonic| harmonic.value.re.abs().max(harmonic.value.im.abs());
    let largest = all_harmonics().max_by(|a, b| size(&a.1).total_cmp(&size(&b.1)));
    let Some((index, largest)) = largest.map(|(index, harmonic)| (index, size(&harmonic))) else {
        return Ok(());
    };
    if let Some(reason) = size::fault("a largest response", largest) {
        return Err(wrong(index, reason));
    }
    let within = 1.0 / size::LARGEST_DEVIATION..=size::LARGEST_DEVIATION;
    let stated = all_harmonics().filter_map(|(index, harmonic)| Some((index, harmonic.std?)));
    let out_of_range =
        stated.filter(|_| largest > 0.0).find(|(_, std)| !within.contains(&(std / largest)));
    match out_of_range {
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
