//! Where a simulation departs from the measurement.

use serde::{Deserialize, Serialize};

/// One test of whether residuals are noise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ResidualTest {
    /// What is tested: `size`, `frequency`, `magnitude`, `harmonic`, `run`, …
    pub name: String,
    /// Value of the statistic.
    pub statistic: f64,
    /// Probability of a statistic at least as large if the residuals were noise;
    /// null where the test has no data.
    pub p_value: Option<f64>,
    /// Whether it passes at its share of the family-wise level.
    pub passed: bool,
    /// What it means, one sentence.
    pub explanation: String,
}

/// Residuals of one group: a magnitude, a band of frequency, a harmonic, a
/// stretch of the acquisition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ResidualGroup {
    /// Lower end of the group, in the unit of its axis.
    pub from: f64,
    /// Upper end; equal to `from` where the group is one value.
    pub to: f64,
    /// Complex (of harmonic 0: real) residuals in the group.
    pub count: usize,
    /// Root mean square of the real components in standard deviations: 1 is noise.
    pub rms_sigmas: f64,
    /// Root mean square of the complex residuals, response units.
    pub rms_response: f64,
    /// The same as a share of the root mean square of the measured values.
    pub relative: f64,
}

/// A contiguous part of the measurement in which the simulation is wrong.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Pattern {
    /// Smallest and largest magnitude, input units; null: every one.
    pub magnitudes: Option<[f64; 2]>,
    /// Lowest and highest frequency of the fundamental (of the line, where the
    /// input has many), hertz; null: every one.
    pub frequencies_hz: Option<[f64; 2]>,
    /// Harmonics concerned; empty: every one.
    pub harmonics: Vec<usize>,
    /// First and last run; null: every one.
    pub runs: Option<[f64; 2]>,
    /// Residuals in it.
    pub count: usize,
    /// Root mean square of the residuals in standard deviations.
    pub rms_sigmas: f64,
    /// Root mean square of the complex residuals, response units.
    pub rms_response: f64,
    /// Mean of |measured|/|simulated| − 1 over it, weighted with the simulated
    /// size; null where nothing is simulated there.
    pub relative_size: Option<f64>,
    /// Mean phase by which the measurement leads the simulation, degrees,
    /// likewise.
    pub phase_deg: Option<f64>,
    /// Share of the whole excess χ² that lies in it.
    pub share: f64,
    /// What a test engineer reads.
    pub sentence: String,
}

/// Where a simulation departs from the measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Discrepancy {
    /// One sentence for a person.
    pub sentence: String,
    /// Whether the residuals are noise, by every test together.
    pub noise_like: bool,
    /// The tests.
    pub tests: Vec<ResidualTest>,
    /// Parts in which the simulation is wrong, largest first.
    pub patterns: Vec<Pattern>,
    /// By magnitude, input units.
    pub by_magnitude: Vec<ResidualGroup>,
    /// By frequency, hertz.
    pub by_frequency: Vec<ResidualGroup>,
    /// By harmonic.
    pub by_harmonic: Vec<ResidualGroup>,
    /// By order of acquisition; empty where it is not known.
    pub by_run: Vec<ResidualGroup>,
}
