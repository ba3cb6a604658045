//! Comparison of the measured with the simulated response, harmonic by harmonic.

use serde::{Deserialize, Serialize};

/// One harmonic, measured and simulated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ComparedHarmonic {
    /// Harmonic k: 0 = mean, 1 = fundamental, 2 …
    pub order: usize,
    /// Line Uₖ of the input as [re, im], input units; zero if not excited.
    pub input: [f64; 2],
    /// Measured Yₖ as [re, im], response units; im of harmonic 0 is 0.
    pub measured: [f64; 2],
    /// Simulated Yₖ as [re, im], response units. That of a single period of a position has the jump at
    /// its end that fits best.
    pub simulated: [f64; 2],
    /// Standard deviation of re and of im each, response units: given, from the repeats, or
    /// estimated from the residual.
    pub std: f64,
}

/// One experiment, measured and simulated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ComparedExperiment {
    /// Its index in the measurement.
    pub experiment: usize,
    /// Half the peak-to-peak value of the input, input units.
    pub magnitude: f64,
    /// Fundamental, rad/s.
    pub omega_rad_s: f64,
    /// Position in the order of acquisition, if known.
    pub run: Option<f64>,
    /// Harmonics that were compared, ascending.
    pub harmonics: Vec<ComparedHarmonic>,
}

/// An experiment for which the model has no response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Unanswered {
    /// Its index in the measurement.
    pub experiment: usize,
    /// Half the peak-to-peak value of the input, input units; null for a motion that does not
    /// repeat.
    #[serde(default)]
    pub magnitude: Option<f64>,
    /// Fundamental, rad/s; null for a motion that does not repeat.
    #[serde(default)]
    pub omega_rad_s: Option<f64>,
    /// The reason, in words.
    pub reason: String,
}

/// A measurement and its simulation by a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Comparison {
    /// Unit of the input, as stated in the upload; empty if not stated.
    pub input_unit: String,
    /// Unit of the response, as stated in the upload; empty if not stated.
    pub response_unit: String,
    /// Kind of the response: `velocity`, `position` or `acceleration`.
    pub response_quantity: String,
    /// Whether `std` is estimated from the residual, because the noise is unknown.
    pub std_estimated: bool,
    /// Experiments in the order of the measurement.
    pub experiments: Vec<ComparedExperiment>,
    /// Experiments that are left out because the model has no response of their period.
    pub unanswered: Vec<Unanswered>,
}
