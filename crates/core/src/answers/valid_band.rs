//! The band in which a model may be used.

use serde::{Deserialize, Serialize};

/// A band in which a model departs from the measurement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct BandDeparture {
    /// Lowest frequency, hertz.
    pub from_hz: f64,
    /// Highest frequency, hertz.
    pub to_hz: f64,
    /// Measured over simulated gain where they differ most, dB.
    pub gain_db: f64,
    /// Phase by which the measurement leads the simulation where they differ most, degrees.
    pub phase_deg: f64,
}

impl BandDeparture {
    /// How far the model is off: |gain| over 3 dB, or |phase| over 20°, whichever is larger.
    pub fn severity(&self) -> f64 {
        (self.gain_db.abs() / 3.0).max(self.phase_deg.abs() / 20.0)
    }
}

/// Where a model follows the measured frequency response, and where it departs from it by more than
/// about 3 dB or 20°, beyond the noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidBand {
    /// The widest band without a departure, in octaves: lowest and highest frequency, hertz; null
    /// if the model departs everywhere.
    pub usable_hz: Option<[f64; 2]>,
    /// Bands in which the model departs, lowest first.
    pub departures: Vec<BandDeparture>,
    /// Both in one sentence.
    pub sentence: String,
}
