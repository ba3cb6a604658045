//! How linear the measured response is, from the data alone.

use serde::{Deserialize, Serialize};

/// The best linear approximation of the measured response, and what of the response is noise and
/// nonlinear distortion, before any model is fitted.
///
/// R. Pintelon, J. Schoukens, *System Identification: A Frequency Domain Approach*, 2nd ed. 2012,
/// chapters 3 and 4.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Linearity {
    /// Magnitudes of the input, the smallest first.
    pub levels: Vec<LinearityLevel>,
    /// Change of the gain from the smallest to the largest magnitude, relative to the gain at the
    /// largest (rms over the lines that both excite); null if there is one magnitude.
    pub change_with_level: Option<Share>,
    /// All of it in one sentence.
    pub sentence: String,
}

/// The response at one magnitude of the input.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct LinearityLevel {
    /// Median of half the peak-to-peak value of the input, input units.
    pub magnitude: f64,
    /// Number of inputs with different phases of their lines; 1 for single cosines.
    pub realisations: usize,
    /// The best linear approximation at the excited lines, lowest frequency first.
    pub approximation: Vec<LinearLine>,
    /// Response at lines that are not excited, lowest frequency first. Of single cosines, all even
    /// or odd harmonics together, at the frequency of the cosine.
    pub distortion: Vec<DistortionLine>,
    /// Noise of the response at the excited lines; null if it is not known.
    pub noise: Option<f64>,
    /// Response at even multiples of the lowest common frequency of the input that are not excited;
    /// null if none was measured.
    pub even: Option<Share>,
    /// The same at odd multiples.
    pub odd: Option<Share>,
    /// Response at the excited lines that depends on the phases of the input; null if there is one
    /// realisation.
    pub stochastic: Option<Share>,
}

/// A part of the response, relative to the response at the excited lines (ratio of root mean
/// squares).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Share {
    /// The part, less what noise makes of it; 0 if noise alone makes as much. With the noise, if
    /// that is not known.
    pub value: f64,
    /// Smallest part that would be told from noise (three standard deviations); null if the noise
    /// is not known.
    pub detectable: Option<f64>,
}

/// The best linear approximation at one line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct LinearLine {
    /// Angular frequency, rad/s.
    pub omega_rad_s: f64,
    /// Response over input, real and imaginary part, response units per input unit.
    pub gain: [f64; 2],
    /// Standard deviation of each part that the noise causes; null if it is not known.
    pub noise_std: Option<f64>,
    /// Standard deviation of each part that noise and distortion cause together, from the scatter
    /// of the realisations; null if there is one.
    pub total_std: Option<f64>,
    /// Peak amplitude of the response, response units; root mean square over the realisations.
    pub amplitude: f64,
    /// Root mean square of what noise makes of it, response units; null if it is not known.
    pub noise: Option<f64>,
}

/// Whether a line is an even or an odd multiple of the lowest common frequency of the input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Parity {
    /// What a nonlinearity that is not odd makes.
    Even,
    /// What an odd nonlinearity makes, such as symmetric friction.
    Odd,
}

/// The response at a line that the input does not excite; where those are many, the root mean square
/// over neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct DistortionLine {
    /// Angular frequency, rad/s.
    pub omega_rad_s: f64,
    /// Even or odd.
    pub parity: Parity,
    /// Peak amplitude, response units.
    pub amplitude: f64,
    /// Root mean square of what noise alone makes of it, response units; null if it is not known.
    pub noise: Option<f64>,
}
