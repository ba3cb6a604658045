//! Answers as flat rows, one value a column: for tables, and for programs that draw
//! them over time.

use serde::Serialize;

use super::{JobKind, Verdict};

/// What came of one job.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ResultRow {
    /// When it was measured, RFC 3339; where the upload does not say, when it was stored.
    pub at: String,
    /// The job.
    pub job_id: String,
    /// The measurement.
    pub measurement_id: String,
    /// Its name.
    pub name: Option<String>,
    /// Its machine.
    pub machine: Option<String>,
    /// Its axis.
    pub axis: Option<String>,
    /// Kind of job.
    pub kind: JobKind,
    /// What a diagnosis comes to; null of an identification.
    pub verdict: Option<Verdict>,
    /// Ids of the causes named, strongest first, with a space between them.
    pub causes: Option<String>,
    /// Confidence of the strongest.
    pub confidence: Option<f64>,
    /// What the causes gain on data held out: error before over after.
    pub ratio: Option<f64>,
    /// Lower end of its 95 % interval.
    pub ratio_low95: Option<f64>,
    /// Upper end.
    pub ratio_high95: Option<f64>,
    /// NRMSE that the base model leaves.
    pub base_nrmse: f64,
    /// NRMSE that the model that explains the data best leaves.
    pub nrmse: f64,
    /// χ² per degree of freedom of that model; null where the noise is unknown.
    pub chi2_per_dof: Option<f64>,
    /// Whether that model explains the data to within its noise; null likewise.
    pub adequate: Option<bool>,
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
    ];
}

/// One parameter of an axis as one measurement has it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct HistoryRow {
    /// When it was measured, RFC 3339; where the upload does not say, when it was stored.
    pub at: String,
    /// The parameter.
    pub parameter: String,
    /// What it is called.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Its standard deviation.
    pub std: Option<f64>,
    /// Lower end of its 95 % interval.
    pub low95: Option<f64>,
    /// Upper end.
    pub high95: Option<f64>,
    /// Its unit.
    pub unit: String,
    /// Difference from the value before, in the same unit; null for the first.
    pub change: Option<f64>,
    /// Whether the change goes beyond the joint 95 % interval of both values.
    pub changed: bool,
    /// Ids of the causes in the model it is of, with a space between them.
    pub causes: Option<String>,
    /// The machine.
    pub machine: Option<String>,
    /// The axis.
    pub axis: Option<String>,
    /// The measurement.
    pub measurement_id: String,
    /// The job.
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
