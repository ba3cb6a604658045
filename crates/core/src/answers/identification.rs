//! The answer to an `identify` job.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::{IdentifyOptions, Method, Unanswered};

/// Where the weights of the fit come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum NoiseSource {
    /// Standard deviations in the upload, or the option `noise_std`.
    Given,
    /// Scatter of repeats of the same experiment.
    Repeats,
    /// Scatter from period to period of a record.
    Periods,
    /// Unknown: uniform weights, scale estimated from the residual.
    Estimated,
}

/// One estimated parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ParameterEstimate {
    /// Best value, in `unit`; null where the data says nothing of it.
    pub value: Option<f64>,
    /// Standard deviation; null where it is not identifiable.
    pub std: Option<f64>,
    /// 95 % interval; null where it is not identifiable.
    pub interval95: Option<[f64; 2]>,
    /// Unit, made of the upload's input and response units.
    pub unit: String,
    /// Whether the value lies on the edge of what is physically possible.
    pub at_bound: bool,
    /// Whether the data determines it.
    pub identifiable: bool,
}

/// The linear block G(s) = A(s)·K/(s + a).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct TransferFunction {
    /// Coefficients, highest power of s first.
    pub numerator: Vec<f64>,
    /// Coefficients, highest power of s first; the leading one is 1.
    pub denominator: Vec<f64>,
    /// Poles as [re, im], rad/s.
    pub poles: Vec<[f64; 2]>,
    /// G(0) = K/a, response units per input unit.
    pub dc_gain: f64,
}

/// How well the model explains the data.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Fit {
    /// Sum of squared weighted residuals; null where the noise is unknown.
    pub chi2: Option<f64>,
    /// Real data less fitted parameters, at least 0.
    pub dof: i64,
    /// χ² per degree of freedom; null where the noise is unknown.
    pub chi2_per_dof: Option<f64>,
    /// ‖Y − Ŷ‖/‖Y‖ over all complex components compared.
    pub nrmse: f64,
    /// Root mean square of the complex residuals, response units.
    pub rms_residual: f64,
    /// Probability of a χ² at least as large if the model were right.
    pub p_value: Option<f64>,
    /// Whether the residual is no larger than the noise (p ≥ 0.01), and smaller than what is
    /// simulated; null where the noise is unknown or no degree of freedom is left.
    pub adequate: Option<bool>,
    /// Factor by which every standard deviation was widened because the model
    /// leaves more than noise: √(χ²/dof), at least 1.
    pub uncertainty_scale: f64,
    /// Experiments in which the model has no response of the excitation's period: they are in no
    /// sum, neither in χ² nor in the degrees of freedom nor in the intervals.
    #[serde(default)]
    pub unanswered: Vec<Unanswered>,
}

/// One stage of the computation and where it ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Stage {
    /// `closed_form`; `network`; the search: `colony`, `swarm`, `genetic`, `adaptive_genetic`,
    /// `descents` or `evolution`; `refinement`.
    pub name: String,
    /// Simulations of the whole measurement it used.
    pub evaluations: u64,
    /// Simulations it was allowed; null where something else ends it.
    #[serde(default)]
    pub budget: Option<u64>,
    /// Wall-clock seconds it took.
    pub seconds: f64,
    /// Cost (χ², or the sum of squares where the noise is unknown) it reached.
    pub cost: f64,
    /// Parameters after it, in the units of `parameters`.
    pub parameters: IndexMap<String, f64>,
    /// Why it ended.
    pub stop_reason: String,
}

/// Correlations of the estimated parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Correlations {
    /// Names of rows and columns.
    pub names: Vec<String>,
    /// Symmetric, ones on the diagonal.
    pub matrix: Vec<Vec<f64>>,
}

/// One actuator order that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct OrderCandidate {
    /// Actuator order.
    pub actuator_order: u8,
    /// Its cost after refinement: χ², or χ² in units of the estimated noise.
    pub chi2: f64,
    /// Parameters fitted.
    pub parameters: usize,
    /// Cost plus what the additional parameters must pay; smallest wins.
    pub criterion: f64,
}

/// How the actuator order was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct OrderChoice {
    /// The order taken.
    pub actuator_order: u8,
    /// One sentence for a person.
    pub explanation: String,
    /// Every order tried.
    pub candidates: Vec<OrderCandidate>,
}

/// What is needed to compute the same answer again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Provenance {
    /// Version of servoscope.
    pub software_version: String,
    /// SHA-256 of the uploaded bytes, hexadecimal.
    pub data_sha256: String,
    /// Every option in effect, defaults included.
    pub options: IdentifyOptions,
    /// Actuator order asked for; null: chosen from the data.
    pub actuator_order: Option<u8>,
}

/// The answer to an `identify` job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Identification {
    /// Method that computed it.
    pub method: Method,
    /// Seed of every random choice.
    pub seed: u64,
    /// Where the weights come from.
    pub noise: NoiseSource,
    /// Estimates by name: `pole`, `constant`, `dc_gain`, `fc_plus`, `fc_minus`,
    /// `actuator_pole` or `natural_frequency` and `damping_ratio`.
    pub parameters: IndexMap<String, ParameterEstimate>,
    /// The linear block.
    pub transfer_function: TransferFunction,
    /// How well the model explains the data.
    pub fit: Fit,
    /// Correlations of the identifiable parameters.
    pub correlations: Correlations,
    /// How the actuator order was chosen; null where it was asked for.
    pub order_choice: Option<OrderChoice>,
    /// The stages in order.
    pub stages: Vec<Stage>,
    /// Why the last stage ended.
    pub stop_reason: String,
    /// What this data cannot tell, and what was left out, in sentences.
    pub limitations: Vec<String>,
    /// What is needed to compute it again.
    pub provenance: Provenance,
}
