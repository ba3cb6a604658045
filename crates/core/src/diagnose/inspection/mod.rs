//! Looks at a measurement before it is diagnosed: what looks wrong with it, and what it can show.

mod detectability;
mod size;
#[cfg(test)]
mod tests;

use crate::answers::Inspection;
use crate::identify::{IdentifyError, IdentifyRequest, unless_cancelled};
use crate::measurement::Measurement;
use crate::observer::{Observer, Steady};

use super::DiagnoseError;
use super::progress::Part;

/// Looks at a measurement before it is diagnosed: what looks wrong with it, and which effects it can
/// show at which size.
///
/// A measurement to which the base model cannot be fitted is no error: the answer says why.
///
/// # Errors
/// If the request is invalid or the observer cancels.
pub fn inspect(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Inspection, DiagnoseError> {
    let steady = Steady::new(observer);
    steady.rest_is_certain();
    let measurement = &*measurement.repeated();
    let doubts = measurement.doubts();
    let found = detectability::of(measurement, request, Part::of(&steady));
    let (detectability, obstacle) = match unless_cancelled(&steady, found) {
        Ok(found) => (Some(found), None),
        Err(IdentifyError::Unusable { reason }) => (None, Some(reason)),
        Err(error) => return Err(error.into()),
    };
    Ok(Inspection { doubts, detectability, obstacle })
}
