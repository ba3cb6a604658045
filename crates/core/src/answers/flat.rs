//! Answers as flat rows with one value per column, for tables and for plots over time.

use serde::Serialize;

use super::{JobKind, Verdict};

/// Result of one job.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ResultRow {
    /// Time of the measurement, RFC 3339; if the upload does not state it, the time of storage.
    pub at: String,
    /// Id of the job.
    pub job_id: String,
    /// Id of the measurement.
    pub measurement_id: String,
    /// Name of the measurement.
    pub name: Option<String>,
    /// Machine measured.
    pub machine: Option<String>,
    /// Axis measured.
    pub axis: Option<String>,
    /// Kind of job.
    pub kind: JobKind,
    /// Verdict of a diagnosis; null for an identification.
    pub verdict: Option<Verdict>,
    /// Ids of the named causes, strongest first, separated by spaces.
    pub causes: Option<String>,
    /// Confidence of the strongest cause.
    pub confidence: Option<f64>,
    /// Improvement: residual on held-out data without the causes divided by that with them.
    pub ratio: Option<f64>,
    /// Lower end of the 95 % interval of `ratio`.
    pub ratio_low95: Option<f64>,
    /// Upper end of the 95 % interval of `ratio`.
    pub ratio_high95: Option<f64>,
    /// NRMSE of the base model.
    pub base_nrmse: f64,
    /// NRMSE of the best model: the one with the causes, or the base model if there are none.
    pub nrmse: f64,
    /// χ² per degree of freedom of the best model; null if the noise is unknown.
    pub chi2_per_dof: Option<f64>,
    /// Whether the best model explains the data to within its noise; null if the noise is unknown.
    pub adequate: Option<bool>,
    /// Whether the data were enough to test the base model; if not, `adequate` as a verdict says
    /// only that no error was found. Null for an identification.
    pub tested: Option<bool>,
}

impl ResultRow {
    /// Names of the columns.
    pub const COLUMNS: &[&str] = &[
        "at",
        "job_id",
        "measurement_id",
        "name",
        "machine",
        "axis",
        "kind",
        "verdict",
        "causes",
        "confidence",
        "ratio",
        "ratio_low95",
        "ratio_high95",
        "base_nrmse",
        "nrmse",
        "chi2_per_dof",
        "adequate",
        "tested",
    ];
}

/// One parameter of an axis, as identified from one measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct HistoryRow {
    /// Time of the measurement, RFC 3339; if the upload does not state it, the time of storage.
    pub at: String,
    /// Id of the parameter.
    pub parameter: String,
    /// Display name of the parameter.
    pub name: String,
    /// Value.
    pub value: f64,
    /// Standard deviation.
    pub std: Option<f64>,
    /// Lower end of the 95 % interval.
    pub low95: Option<f64>,
    /// Upper end of the 95 % interval.
    pub high95: Option<f64>,
    /// Unit.
    pub unit: String,
    /// Difference from the previous value, in the same unit; null for the first.
    pub change: Option<f64>,
    /// Whether the change exceeds the joint 95 % interval of both values.
    pub changed: bool,
    /// Ids of the causes in the model that the parameter belongs to, separated by spaces.
    pub causes: Option<String>,
    /// Machine measured.
    pub machine: Option<String>,
    /// Axis measured.
    pub axis: Option<String>,
    /// Id of the measurement.
    pub measurement_id: String,
    /// Id of the job.
    pub job_id: String,
}

impl HistoryRow {
    /// Names of the columns.
    pub const COLUMNS: &[&str] = &[
        "at",
        "parameter",
        "name",
        "value",
        "std",
        "low95",
        "high95",
        "unit",
        "change",
        "changed",
        "causes",
        "machine",
        "axis",
        "measurement_id",
        "job_id",
    ];
}
