//! Validation of a stored answer on another measurement.

use serde::{Deserialize, Serialize};

use super::{Gain, IdentifyOptions, Unanswered, Verdict};

/// How well one model predicts the measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidatedModel {
    /// ‖Y − Ŷ‖/‖Y‖ over all complex components compared, or over all samples of a motion that does
    /// not repeat; null if the measurement is zero in all of them.
    pub nrmse: Option<f64>,
    /// Root mean square of the residuals, response units.
    pub rms: f64,
    /// χ² divided by the number of real data, since no parameter is fitted; null if the noise of
    /// the measurement is unknown.
    pub chi2_per_dof: Option<f64>,
    /// Number of complex components (real ones for harmonic 0) or samples compared: those for which
    /// every model has a response.
    pub components: usize,
    /// Experiments for which this model has no response.
    pub unanswered: Vec<Unanswered>,
}

/// Both models of an answer on the same data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidatedModels {
    /// The base model.
    pub base: ValidatedModel,
    /// The model with the causes; null if no cause is named.
    pub extended: Option<ValidatedModel>,
}

/// Improvement by one named cause on the measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidatedCause {
    /// Id of the effect.
    pub effect: String,
    /// Improvement by the effect alone; null if the answer has no model with this effect alone.
    pub gain: Option<Gain>,
}

/// One initial value of a motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct BeginningValue {
    /// Name of the quantity, in words.
    pub quantity: String,
    /// Its value, in the units of the measurement.
    pub value: f64,
    /// Why the value is implausible for a real axis, in words; null if it is plausible.
    #[serde(default)]
    pub implausible: Option<String>,
}

/// How a motion that does not repeat was compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidatedMotion {
    /// Its index in the measurement.
    pub experiment: usize,
    /// Time from its first sample to the last, s.
    pub duration_s: f64,
    /// Length of its beginning that is not compared, s.
    pub unscored_s: f64,
    /// Whether the measurement states the initial velocity.
    pub beginning_given: bool,
    /// Estimated initial state of the base model; empty: at rest.
    pub base: Vec<BeginningValue>,
    /// Estimated initial state of the model with the causes; empty: at rest.
    pub extended: Vec<BeginningValue>,
}

/// What is needed to reproduce a validation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidationProvenance {
    /// Version of servoscope that computed the validation.
    pub software_version: String,
    /// SHA-256 of the bytes that the models were fitted to, hexadecimal.
    pub fitted_data_sha256: String,
    /// SHA-256 of the bytes of the measurement they are validated on, hexadecimal.
    pub validation_data_sha256: String,
    /// Version of servoscope that fitted the models.
    pub fitted_by_version: String,
    /// Every option of the fit.
    pub options: IdentifyOptions,
}

/// Validation of a stored answer on another measurement, without refitting any parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Validation {
    /// SHA-256 of the bytes of the measurement, hexadecimal.
    pub data_sha256: String,
    /// Kind of the response: `velocity`, `position` or `acceleration`.
    pub response_quantity: String,
    /// Unit of the response, as stated in the upload; empty if not stated.
    pub response_unit: String,
    /// How well each model predicts the measurement.
    pub models: ValidatedModels,
    /// Improvement by all causes together; null if no cause is named, or if there is too little data
    /// for an interval of the ratio.
    pub gain: Option<Gain>,
    /// How motions that do not repeat were compared; empty for periodic data.
    #[serde(default)]
    pub motions: Vec<ValidatedMotion>,
    /// Improvement by each named cause, in the order of the diagnosis.
    pub causes: Vec<ValidatedCause>,
    /// The verdict of the diagnosis. It is lowered by one step (explained, improved, unexplained)
    /// if the causes make the prediction worse here, i.e. the whole interval of the ratio is below
    /// 1. Null for an identification, which has no verdict.
    pub verdict: Option<Verdict>,
    /// Remarks for the user, in sentences.
    pub remarks: Vec<String>,
    /// What is needed to reproduce the validation.
    pub provenance: ValidationProvenance,
}
