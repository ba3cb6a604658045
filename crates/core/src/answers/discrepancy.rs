//! Where a simulation deviates from the measurement.

use serde::{Deserialize, Serialize};

/// One test of whether the residuals are noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ResidualTest {
    /// Name of the test: `size`, `frequency`, `magnitude`, `harmonic`, `run`, …
    pub name: String,
    /// Value of the statistic.
    pub statistic: f64,
    /// Probability of a statistic at least as large if the residuals were noise; null if the data
    /// does not allow the test.
    pub p_value: Option<f64>,
    /// Whether the test passes at its share of the family-wise error rate.
    pub passed: bool,
    /// The result in one sentence.
    pub explanation: String,
}

/// Residuals of one group: a magnitude, a frequency band, a harmonic, or a range of runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ResidualGroup {
    /// Lower end of the group, in the unit by which it is grouped.
    pub from: f64,
    /// Upper end; equal to `from` if the group is one value.
    pub to: f64,
    /// Number of complex residuals (real ones for harmonic 0) in the group.
    pub count: usize,
    /// Root mean square of the real components in standard deviations; 1 for pure noise.
    pub rms_sigmas: f64,
    /// Root mean square of the complex residuals, response units.
    pub rms_response: f64,
    /// `rms_response` divided by the root mean square of the measured values.
    pub relative: f64,
}

/// A contiguous region of the measurement in which the simulation is wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Pattern {
    /// Smallest and largest magnitude, input units; null: all magnitudes.
    pub magnitudes: Option<[f64; 2]>,
    /// Lowest and highest frequency of the fundamental (of the single line, if the input has many),
    /// hertz; null: all frequencies.
    pub frequencies_hz: Option<[f64; 2]>,
    /// Harmonics concerned; empty: all harmonics.
    pub harmonics: Vec<usize>,
    /// First and last run; null: all runs.
    pub runs: Option<[f64; 2]>,
    /// Number of residuals in the region.
    pub count: usize,
    /// Root mean square of the residuals in standard deviations.
    pub rms_sigmas: f64,
    /// Root mean square of the complex residuals, response units.
    pub rms_response: f64,
    /// Mean of |measured|/|simulated| − 1 over the region, weighted by the simulated size; null if
    /// the simulation is zero there.
    pub relative_size: Option<f64>,
    /// Mean phase by which the measurement leads the simulation, degrees, with the same weights;
    /// null if the simulation is zero there.
    pub phase_deg: Option<f64>,
    /// Share of the total excess χ² that lies in the region.
    pub share: f64,
    /// The pattern in one sentence, for a test engineer.
    pub sentence: String,
}

/// Where a simulation deviates from the measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Discrepancy {
    /// Summary in one sentence.
    pub sentence: String,
    /// Whether all tests together accept the residuals as noise.
    pub noise_like: bool,
    /// The tests.
    pub tests: Vec<ResidualTest>,
    /// Regions in which the simulation is wrong, largest first.
    pub patterns: Vec<Pattern>,
    /// Residuals by magnitude, input units.
    pub by_magnitude: Vec<ResidualGroup>,
    /// Residuals by frequency, hertz.
    pub by_frequency: Vec<ResidualGroup>,
    /// Residuals by harmonic.
    pub by_harmonic: Vec<ResidualGroup>,
    /// Residuals by order of acquisition; empty if it is unknown.
    pub by_run: Vec<ResidualGroup>,
}
