//! What a key has stored and computes.

/// What a key has stored, has waiting, and has computed of late.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Usage {
    /// Measurements.
    pub measurements: i64,
    /// Bytes of their files.
    pub bytes: i64,
    /// Jobs that wait or run.
    pub unfinished: i64,
    /// How long its jobs have run within the time that was asked for, milliseconds. Each attempt
    /// counts, and so do those of jobs that were deleted.
    pub computed_ms: i64,
}
