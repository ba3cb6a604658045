//! Rows as they are stored: neither domain values nor what a client sees.

mod jobs;
mod measurements;
mod results;

pub use jobs::{JobFilter, JobRow, NewJobRow, Priority, Status};
pub use measurements::{
    Description, FileRow, MeasurementFilter, MeasurementRow, RereadRow, Rereading,
};
pub use results::{AxisRow, ConvergencePoint, ResultFilter, StoredResult};

/// Milliseconds since 1970-01-01 UTC, by the database's clock.
pub type Millis = i64;

/// A client's promise that requests with this key are one request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IdempotencyKey {
    /// The client's key.
    pub key: String,
    /// Hexadecimal digest of what was asked.
    pub body_sha256: String,
}

/// What an insertion came to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Inserted {
    /// A new resource.
    Created,
    /// The key was used before for the same request; this resource answers it.
    Replayed(String),
    /// The key was used before for another request.
    KeyReused,
}

/// A page of a list, newest first.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Page {
    /// At most this many rows.
    pub limit: u32,
    /// Only rows with a smaller id; `None`: from the newest.
    pub before: Option<String>,
}

/// What was removed because it was old.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Expired {
    /// Measurements, with their files.
    pub measurements: u64,
    /// Jobs, with results and history.
    pub jobs: u64,
}
