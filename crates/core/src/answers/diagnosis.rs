//! The answer to a `diagnose` job.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::{Discrepancy, Identification, ParameterEstimate, Provenance, Validation};

/// What a diagnosis comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The base model explains the data to within its noise.
    Adequate,
    /// With the named causes the model explains the data to within its noise.
    Explained,
    /// The causes help beyond doubt, and something remains.
    Improved,
    /// The model is wrong and no known effect is its cause.
    Unexplained,
}

/// Gain on data that neither a fit nor the choice of the cause has seen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Gain {
    /// NRMSE of the base model on it.
    pub heldout_nrmse_before: f64,
    /// NRMSE of the extended model on it.
    pub heldout_nrmse_after: f64,
    /// Before over after.
    pub ratio: f64,
    /// 95 % interval of the ratio.
    pub interval95: [f64; 2],
    /// χ² per degree of freedom before; null where the noise is unknown.
    pub chi2_per_dof_before: Option<f64>,
    /// The same after.
    pub chi2_per_dof_after: Option<f64>,
    /// What was held out.
    pub heldout: String,
}

/// An effect that the base simulation misses.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Cause {
    /// Id of the effect.
    pub effect: String,
    /// Its parameters by name.
    pub parameters: IndexMap<String, ParameterEstimate>,
    /// Probability that it is truly present, against every rival and none.
    pub confidence: f64,
    /// What it means for the machine.
    pub explanation: String,
    /// What it alone gains; null where that cannot be measured.
    pub gain: Option<Gain>,
    /// Ids of effects that this data cannot tell from it.
    pub equivalents: Vec<String>,
}

/// An effect that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Candidate {
    /// Id of the effect.
    pub effect: String,
    /// Its cost after refitting: χ², or the weighted sum of squares where the noise is unknown.
    pub cost: f64,
    /// By how much it lowers −2 ln of the likelihood: χ², or where noise is unknown or not what
    /// limits the model, the logarithm of the cost times the degrees of freedom.
    pub delta_chi2: f64,
    /// Information criterion; smallest wins.
    pub criterion: f64,
    /// NRMSE on data held out; null where there was none.
    pub heldout_error: Option<f64>,
    /// Why it is not a cause; null where it is.
    pub rejected: Option<String>,
}

/// The experiment that would separate the causes in doubt best.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct NextExperiment {
    /// Magnitude, input units.
    pub magnitude: f64,
    /// Fundamental, rad/s.
    pub omega_rad_s: f64,
    /// Why there.
    pub reason: String,
}

/// The answer to a `diagnose` job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Diagnosis {
    /// What it comes to.
    pub verdict: Verdict,
    /// Where the base simulation is wrong.
    pub discrepancy: Discrepancy,
    /// What it misses, strongest first.
    pub causes: Vec<Cause>,
    /// Every effect that was tried.
    pub candidates: Vec<Candidate>,
    /// What all causes together gain; null where none is named.
    pub gain: Option<Gain>,
    /// The base model, fitted to everything.
    pub base: Identification,
    /// The same with the causes; null where none is named.
    pub extended: Option<Identification>,
    /// What to measure next; null where nothing is in doubt.
    pub next_experiment: Option<NextExperiment>,
    /// What a second measurement says of both models; null where there is none.
    pub validation: Option<Validation>,
    /// What this diagnosis cannot tell, in sentences; what concerns the base
    /// model is in `base`.
    pub limitations: Vec<String>,
    /// What is needed to compute it again.
    pub provenance: Provenance,
}
