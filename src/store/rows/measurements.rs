//! Rows of measurements and their files.

use super::Millis;

/// One file of an upload, as it came.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileRow {
    /// Name used in messages.
    pub name: String,
    /// Media type of the request or part it came in.
    pub content_type: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// What is listed and shown of a measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementRow {
    /// UUID version 7.
    pub id: String,
    /// When it was stored; ignored on insertion.
    pub created_at_ms: Millis,
    /// Name the upload or the request gives.
    pub name: Option<String>,
    /// The machine.
    pub machine: Option<String>,
    /// The axis of the machine.
    pub axis: Option<String>,
    /// Who measured.
    pub operator: Option<String>,
    /// When it was measured, RFC 3339.
    pub measured_at: Option<String>,
    /// JSON object of strings.
    pub labels: String,
    /// Hexadecimal digest of the data.
    pub sha256: String,
    /// Number of experiments.
    pub experiments: i64,
    /// Highest harmonic of any experiment.
    pub highest_harmonic: i64,
    /// Smallest magnitude, input units.
    pub magnitude_min: f64,
    /// Largest magnitude, input units.
    pub magnitude_max: f64,
    /// Lowest fundamental, rad/s.
    pub omega_min_rad_s: f64,
    /// Highest fundamental, rad/s.
    pub omega_max_rad_s: f64,
    /// JSON array: remarks of the reader.
    pub notes: String,
    /// JSON of what input and response are; `None` for a row of an earlier version.
    pub quantities: Option<String>,
    /// JSON array: names of its files in the order of the upload; ignored on insertion.
    pub files: String,
    /// What one simulation with the base model is estimated to take, s; `None` for a row of an
    /// earlier version.
    pub simulation_s: Option<f64>,
    /// What a diagnosis is estimated to take beside the search of the base model, s; likewise.
    pub diagnosis_s: Option<f64>,
}

/// Which measurements to list; `None` accepts every value.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MeasurementFilter {
    /// The machine.
    pub machine: Option<String>,
    /// The axis.
    pub axis: Option<String>,
    /// Labels and their values, all of which must match.
    pub labels: Vec<(String, String)>,
    /// Stored at this time or later.
    pub since_ms: Option<Millis>,
    /// Stored before this time.
    pub until_ms: Option<Millis>,
    /// Measured at this time or later, where the upload says when.
    pub measured_since_ms: Option<Millis>,
    /// Measured before this time, where the upload says when.
    pub measured_until_ms: Option<Millis>,
    /// With this text in the name, machine, axis, operator, a label or the name of a file.
    pub text: Option<String>,
    /// Digest of the data.
    pub sha256: Option<String>,
}

/// What a measurement says of itself, beside its data.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Description {
    /// Its name.
    pub name: Option<String>,
    /// The machine.
    pub machine: Option<String>,
    /// The axis of the machine.
    pub axis: Option<String>,
    /// Who measured.
    pub operator: Option<String>,
    /// When it was measured, RFC 3339.
    pub measured_at: Option<String>,
    /// JSON object of labels.
    pub labels: String,
}

/// What another reading of a measurement's files changes.
#[derive(Debug, Clone, PartialEq)]
pub struct RereadRow {
    /// What was read; id, time of storing and what the measurement says of itself are ignored.
    pub row: MeasurementRow,
    /// Name of the file that carries what is given beside the others.
    pub given_name: &'static str,
    /// That file; `None`: nothing is given.
    pub given: Option<FileRow>,
}

/// What became of another reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rereading {
    /// It is stored.
    Stored,
    /// There is a job on the measurement: nothing was changed.
    HasJobs,
    /// There is no measurement with this id.
    Unknown,
}
