//! A stored answer, tried on another measurement.

use serde::{Deserialize, Serialize};

use super::{Gain, IdentifyOptions, Unanswered, Verdict};

/// How well one model predicts the measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidatedModel {
    /// ‖Y − Ŷ‖/‖Y‖ over all complex components compared, or over all samples of a
    /// motion that does not repeat; null where the measurement is zero in all of them.
    pub nrmse: Option<f64>,
    /// Root mean square of the residuals, response units.
    pub rms: f64,
    /// χ² per real datum, of which none was fitted; null where the noise of the
    /// measurement is unknown.
    pub chi2_per_dof: Option<f64>,
    /// Complex (of harmonic 0: real) components, or samples, compared: those that every model
    /// has a response for.
    pub components: usize,
    /// Experiments that this model has no response for.
    pub unanswered: Vec<Unanswered>,
}

/// Both models of an answer on the same data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidatedModels {
    /// The base model.
    pub base: ValidatedModel,
    /// The model with the causes; null where none is named.
    pub extended: Option<ValidatedModel>,
}

/// What one named cause gains on the measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidatedCause {
    /// Id of the effect.
    pub effect: String,
    /// What it alone gains; null where the answer has no model with it alone.
    pub gain: Option<Gain>,
}

/// A quantity that a motion begins with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct BeginningValue {
    /// Which, in words.
    pub quantity: String,
    /// Its value, in the units of the measurement.
    pub value: f64,
    /// Why no axis is likely to begin so, in words; null where one may.
    #[serde(default)]
    pub implausible: Option<String>,
}

/// How a motion that does not repeat was compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidatedMotion {
    /// Its index in the measurement.
    pub experiment: usize,
    /// From its first sample to the last, s.
    pub duration_s: f64,
    /// Seconds at its beginning that are not compared.
    pub unscored_s: f64,
    /// Whether the measurement says with which velocity it begins.
    pub beginning_given: bool,
    /// What the base model was estimated to begin with; empty: at rest.
    pub base: Vec<BeginningValue>,
    /// What the model with the causes was estimated to begin with; empty: at rest.
    pub extended: Vec<BeginningValue>,
}

/// What is needed to compute a validation again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ValidationProvenance {
    /// Version of servoscope that validated.
    pub software_version: String,
    /// SHA-256 of the bytes that the models were fitted to, hexadecimal.
    pub fitted_data_sha256: String,
    /// SHA-256 of the bytes of the measurement they are tried on, hexadecimal.
    pub validation_data_sha256: String,
    /// Version of servoscope that fitted.
    pub fitted_by_version: String,
    /// Every option of the fit.
    pub options: IdentifyOptions,
}

/// A stored answer, tried on another measurement: nothing is fitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Validation {
    /// SHA-256 of the bytes of the measurement, hexadecimal.
    pub data_sha256: String,
    /// What the response is: `velocity`, `position` or `acceleration`.
    pub response_quantity: String,
    /// Its unit, as the upload gives it; empty where it does not.
    pub response_unit: String,
    /// How well each model predicts the measurement.
    pub models: ValidatedModels,
    /// What the causes together gain; null where none is named, or where there is
    /// too little to give the ratio an interval.
    pub gain: Option<Gain>,
    /// How motions that do not repeat were compared; empty for periodic data.
    #[serde(default)]
    pub motions: Vec<ValidatedMotion>,
    /// What each named cause gains, in the order of the diagnosis.
    pub causes: Vec<ValidatedCause>,
    /// The verdict of the diagnosis, one step lower (explained, improved,
    /// unexplained) where the causes hurt here: the whole interval of the ratio is
    /// below 1. Null for an identification, which has none.
    pub verdict: Option<Verdict>,
    /// What a person should know of it, in sentences.
    pub remarks: Vec<String>,
    /// What is needed to compute it again.
    pub provenance: ValidationProvenance,
}
