//! What passes between a diagnosis and the search for faults of its measurement.

use crate::answers::{AsMeasured, MeasurementFault};
use crate::identify::IdentifyError;
use crate::measurement::Measurement;

use super::error::DiagnoseError;

/// A measurement to be diagnosed.
#[derive(Clone, Copy)]
pub(crate) struct Data<'a> {
    /// The measurement.
    pub measurement: &'a Measurement,
    /// Whether faults of it are looked for.
    pub doubted: bool,
    /// By how much its response was ahead of its input before that was mended, s.
    pub lead_s: f64,
}

/// Faults that were found before an answer was complete.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Suspicion {
    /// The faults; indices are those of the measurement that was diagnosed.
    pub faults: Vec<MeasurementFault>,
    /// The answer without them, as far as it was known.
    pub as_measured: AsMeasured,
}

/// Why a diagnosis ended without an answer.
#[derive(Debug)]
pub(crate) enum Halt {
    /// An error.
    Error(DiagnoseError),
    /// The measurement has faults.
    Faults(Box<Suspicion>),
}

impl From<DiagnoseError> for Halt {
    fn from(error: DiagnoseError) -> Self {
        Self::Error(error)
    }
}

impl From<IdentifyError> for Halt {
    fn from(error: IdentifyError) -> Self {
        Self::Error(error.into())
    }
}
