//! What a base model gets wrong, where, and why.
//!
//! 1. `residuals`: the base model is fitted; what it leaves is laid out by magnitude, frequency,
//!    harmonic and order of acquisition, and tested for being noise. Where it is not, the regions
//!    in which the simulation departs most are found and said in words.
//! 2. `search`: every effect of the library is tried beside the base model by a score test, from
//!    one linearization, and the most promising are refitted with it.
//! 3. `selection`: an effect counts where it gains more than chance makes any effect gain (a
//!    family-wise threshold); among those, the evidence decides. That is done for every order of
//!    the actuator, and put together as an answer.
//! 4. `holdout`: parts of the measurement are held out in turn, the causes are chosen and fitted
//!    anew without them, and what they predict is compared with what the base model predicts.
//! 5. `validation`: an answer is tried on another measurement, or on motions that do not repeat.

mod error;
mod holdout;
mod limitations;
mod progress;
mod residuals;
mod search;
mod selection;
#[cfg(test)]
mod tests;
mod validation;

use crate::answers::{Diagnosis, Discrepancy, Identification};
use crate::identify::{self, IdentifyRequest};
use crate::measurement::Measurement;
use crate::observer::Observer;

pub use error::{DiagnoseError, ValidateError};
pub use validation::{diagnose_validated, validate};

use progress::Part;
use residuals::discrepancy;
use selection::weighting_choice;

/// Fits the base model to a measurement and says where it is wrong, without
/// looking for the cause.
///
/// # Errors
/// See [`DiagnoseError`].
pub fn examine(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<(Identification, Discrepancy), DiagnoseError> {
    let fit = identify::fit_base(measurement, request, observer)?;
    let discrepancy = discrepancy::of(&fit, request.options.seed);
    Ok((fit.identification, discrepancy))
}

/// Fits the base model to a measurement, says where it is wrong, names the
/// effects it lacks and extends it with them.
///
/// # Errors
/// See [`DiagnoseError`].
pub fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    let whole = Part { whole: observer, span: [0.0, 1.0] };
    weighting_choice::diagnose(measurement, request, whole)
}
