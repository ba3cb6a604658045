//! The answer to a `diagnose` job.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::{
    AsMeasured, Discrepancy, Identification, Linearity, MeasurementFault, ParameterEstimate,
    Provenance, ValidBand, Validation,
};

/// Verdict of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The base model explains the data to within its noise.
    Adequate,
    /// With the named causes the model explains the data to within its noise.
    Explained,
    /// The named causes improve the model significantly, but it still leaves more than the noise.
    Improved,
    /// The model is wrong, and no known effect is found to be the cause.
    Unexplained,
}

impl Verdict {
    /// Its name, as results have it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Adequate => "adequate",
            Self::Explained => "explained",
            Self::Improved => "improved",
            Self::Unexplained => "unexplained",
        }
    }
}

/// Reduction of the prediction error on held-out data, which neither a fit nor the choice of the
/// causes has used.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Gain {
    /// NRMSE of the base model on the held-out data.
    pub heldout_nrmse_before: f64,
    /// NRMSE of the extended model on the held-out data.
    pub heldout_nrmse_after: f64,
    /// `heldout_nrmse_before` divided by `heldout_nrmse_after`.
    pub ratio: f64,
    /// 95 % interval of the ratio.
    pub interval95: [f64; 2],
    /// χ² per degree of freedom of the base model; null if the noise is unknown.
    pub chi2_per_dof_before: Option<f64>,
    /// χ² per degree of freedom of the extended model; null if the noise is unknown.
    pub chi2_per_dof_after: Option<f64>,
    /// Description of the held-out data.
    pub heldout: String,
}

/// An effect that the base model lacks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Cause {
    /// Id of the effect.
    pub effect: String,
    /// Its parameters by name.
    pub parameters: IndexMap<String, ParameterEstimate>,
    /// Probability that this effect is really present, as opposed to any rival effect or none.
    pub confidence: f64,
    /// Ratio of two amounts of χ² beyond the noise: what is left by the best model that has neither
    /// this effect nor the effects most like it, over what is left by the model with all causes.
    /// Null if the answer is older than this figure.
    #[serde(default)]
    pub margin: Option<f64>,
    /// What it means for the machine.
    pub explanation: String,
    /// Improvement by this effect alone; null if it cannot be measured.
    pub gain: Option<Gain>,
    /// Ids of effects that these data cannot distinguish from it.
    pub equivalents: Vec<String>,
}

/// An effect that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Candidate {
    /// Id of the effect.
    pub effect: String,
    /// Its cost after refitting: χ², or the weighted sum of squares if the noise is unknown.
    pub cost: f64,
    /// Reduction of −2 ln(likelihood) by the effect. That is the reduction of χ², or, if the noise
    /// is unknown or does not limit the model, of the logarithm of the cost times the degrees of
    /// freedom.
    pub delta_chi2: f64,
    /// Information criterion; the smallest wins.
    pub criterion: f64,
    /// NRMSE on held-out data; null if there was none.
    pub heldout_error: Option<f64>,
    /// Why it is not named as a cause; null if it is.
    pub rejected: Option<String>,
}

/// The experiment that would best distinguish between the causes still in doubt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct NextExperiment {
    /// Magnitude, input units.
    pub magnitude: f64,
    /// Fundamental, rad/s.
    pub omega_rad_s: f64,
    /// Why this experiment.
    pub reason: String,
}

/// The answer to a `diagnose` job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Diagnosis {
    /// The verdict.
    pub verdict: Verdict,
    /// How linear the measured response is, before any model; null if the data do not tell, or if
    /// the answer is older than this figure.
    #[serde(default)]
    pub linearity: Option<Linearity>,
    /// Faults of the measurement that were found. Everything else in this answer is for the
    /// measurement with these corrected.
    #[serde(default)]
    pub measurement: Vec<MeasurementFault>,
    /// The answer to the measurement with its faults; null if it has none.
    #[serde(default)]
    pub as_measured: Option<AsMeasured>,
    /// Faults of the measurement that would explain it about as well in the place of the causes.
    /// They are not corrected.
    #[serde(default)]
    pub rival_faults: Vec<MeasurementFault>,
    /// Where the base model is wrong.
    pub discrepancy: Discrepancy,
    /// Effects that the base model lacks, strongest first.
    pub causes: Vec<Cause>,
    /// Every effect that was tried.
    pub candidates: Vec<Candidate>,
    /// Improvement by all causes together; null if no cause is named.
    pub gain: Option<Gain>,
    /// The base model, fitted to all data.
    pub base: Identification,
    /// The model with the causes, fitted to all data; null if no cause is named.
    pub extended: Option<Identification>,
    /// Where the final model may be used: that with the causes or, if none is named, the base model.
    /// Null if the answer is older than this figure.
    #[serde(default)]
    pub valid_band: Option<ValidBand>,
    /// What to measure next; null if nothing is in doubt.
    pub next_experiment: Option<NextExperiment>,
    /// Validation of both models on a second measurement; null if there is none.
    pub validation: Option<Validation>,
    /// What this diagnosis cannot determine, in sentences. Limitations of the base model are in
    /// `base`.
    pub limitations: Vec<String>,
    /// What is needed to reproduce the answer.
    pub provenance: Provenance,
}

impl Diagnosis {
    /// Whether any test could be made of the base model. Without one, nothing speaks for an adequate
    /// model, either.
    pub fn is_tested(&self) -> bool {
        let tests = &self.discrepancy.tests;
        tests.is_empty() || tests.iter().any(|test| test.p_value.is_some())
    }
}
