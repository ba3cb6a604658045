//! The answer to an `identify` job.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::{IdentifyOptions, Method, ReadingDoubt, Unanswered};

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
    /// Unknown. The weights follow from a law of the noise that is fitted to the scatter of the
    /// residuals, or are uniform where there is none; the size of the noise is estimated from the
    /// residual.
    Estimated,
}

/// One estimated parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ParameterEstimate {
    /// Best estimate, in `unit`; null if the data contain no information about it.
    pub value: Option<f64>,
    /// Standard deviation; null if the parameter is not identifiable.
    pub std: Option<f64>,
    /// 95 % interval; null if the parameter is not identifiable.
    pub interval95: Option<[f64; 2]>,
    /// Unit, composed of the upload's input and response units.
    pub unit: String,
    /// Whether the value lies at a bound of the physically possible range.
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
    /// Sum of squared weighted residuals; null if the noise is unknown.
    pub chi2: Option<f64>,
    /// Degrees of freedom: number of real data minus number of fitted parameters and of other numbers
    /// that are estimated with them, such as samples of the input that were cut off; at least 0.
    pub dof: i64,
    /// χ² per degree of freedom; null if the noise is unknown.
    pub chi2_per_dof: Option<f64>,
    /// ‖Y − Ŷ‖/‖Y‖ over all complex components compared.
    pub nrmse: f64,
    /// Root mean square of the complex residuals, response units.
    pub rms_residual: f64,
    /// Probability of a χ² at least as large if the model is right.
    pub p_value: Option<f64>,
    /// Whether the residual is no larger than the noise (p ≥ 0.01) and smaller than the simulated
    /// response; null if the noise is unknown or no degree of freedom is left.
    pub adequate: Option<bool>,
    /// Factor by which every standard deviation is widened if the model is not adequate: √(χ²/dof),
    /// at least 1.
    pub uncertainty_scale: f64,
    /// Experiments for which the model has no response of the excitation's period. They are left
    /// out of χ², of the degrees of freedom and of the intervals.
    #[serde(default)]
    pub unanswered: Vec<Unanswered>,
    /// How the noise depends on the size of the response, where that was estimated: from repeats of
    /// a table, or, where nothing states the noise of a table, from what the model leaves. Null
    /// where the noise is given, comes from a record, or follows no such law.
    #[serde(default)]
    pub noise_law: Option<NoiseLaw>,
}

/// The noise of a datum Y: its re and im each have the variance additive² + (proportional·|Y|)².
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct NoiseLaw {
    /// The additive part, response units.
    pub additive: NoisePart,
    /// The proportional part, a share of |Y|.
    pub proportional: NoisePart,
}

/// One part of the noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct NoisePart {
    /// The estimate; 0 where the data show none.
    pub value: f64,
    /// Interval that holds the true value with a probability of about 95 %.
    pub interval95: [f64; 2],
}

/// One stage of the computation and its result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Stage {
    /// `closed_form`, `network`, a search (`colony`, `swarm`, `genetic`, `adaptive_genetic`,
    /// `descents` or `evolution`), or `refinement`.
    pub name: String,
    /// Simulations of the whole measurement it used.
    pub evaluations: u64,
    /// Simulations it was allowed; null if it has another stopping criterion.
    #[serde(default)]
    pub budget: Option<u64>,
    /// Wall-clock seconds it took.
    pub seconds: f64,
    /// Cost it reached: χ², or the sum of squares if the noise is unknown.
    pub cost: f64,
    /// Parameters after it, in the units of `parameters`.
    pub parameters: IndexMap<String, f64>,
    /// Why it ended.
    pub stop_reason: String,
}

impl Stage {
    /// Simulations of some stages together, at most `u64::MAX`: a result that is read from a file may
    /// state any numbers.
    pub fn evaluations_of<'a>(stages: impl IntoIterator<Item = &'a Self>) -> u64 {
        stages.into_iter().fold(0, |sum, stage| sum.saturating_add(stage.evaluations))
    }
}

/// Correlations of the estimated parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Correlations {
    /// Names of rows and columns.
    pub names: Vec<String>,
    /// Symmetric matrix with ones on the diagonal.
    pub matrix: Vec<Vec<f64>>,
}

/// One actuator order that was tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct OrderCandidate {
    /// Actuator order.
    pub actuator_order: u8,
    /// Its cost after refinement: χ², or the sum of squares if the noise is unknown.
    pub chi2: f64,
    /// Number of fitted parameters.
    pub parameters: usize,
    /// Cost plus a penalty for the number of parameters; the smallest wins.
    pub criterion: f64,
}

/// How the actuator order was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct OrderChoice {
    /// The chosen order.
    pub actuator_order: u8,
    /// The reason in one sentence.
    pub explanation: String,
    /// Every order tried.
    pub candidates: Vec<OrderCandidate>,
}

/// What is needed to reproduce the answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Provenance {
    /// Version of servoscope.
    pub software_version: String,
    /// SHA-256 of the uploaded bytes, hexadecimal.
    pub data_sha256: String,
    /// Every option in effect, defaults included.
    pub options: IdentifyOptions,
    /// Requested actuator order; null if it was chosen from the data.
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
    /// How the actuator order was chosen; null if it was requested.
    pub order_choice: Option<OrderChoice>,
    /// The stages in order.
    pub stages: Vec<Stage>,
    /// Why the last stage ended.
    pub stop_reason: String,
    /// What looks wrong with the measurement, from the data alone.
    #[serde(default)]
    pub doubts: Vec<ReadingDoubt>,
    /// What these data cannot determine, and what was left out, in sentences.
    pub limitations: Vec<String>,
    /// What is needed to reproduce the answer.
    pub provenance: Provenance,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::sample;

    #[test]
    fn the_sum_of_absurd_numbers_of_simulations_is_the_largest_number() {
        let of = |evaluations| sample::stage("refinement", evaluations, 0.1, 1.0);
        assert_eq!(Stage::evaluations_of(&[of(2), of(3)]), 5);
        assert_eq!(Stage::evaluations_of(&[of(u64::MAX), of(3)]), u64::MAX);
    }
}
