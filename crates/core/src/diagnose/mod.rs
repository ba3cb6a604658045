//! Diagnosis: where the base model is wrong, and which physical effect it lacks.
//!
//! Before any model, `linearity` tells from the data how much of the response is noise, and how much
//! is not linear.
//!
//! 1. `residuals`: the residuals of the base model are tested for being noise, by magnitude,
//!    frequency, harmonic and order of acquisition. If they are not, the regions in which the
//!    simulation departs most are found and described in words.
//! 2. `search`: every effect of the library is tried beside the base model by a score test at one
//!    linearization, and the most promising effects are fitted together with it.
//! 3. `selection`: an effect counts if it gains more than any effect gains by chance (a family-wise
//!    threshold). Among the models of such effects the marginal likelihood decides. This is done
//!    for several actuator orders, and the answer is assembled.
//! 4. `holdout`: parts of the measurement are held out in turn. The causes are chosen and fitted
//!    without them, and their predictions are compared with those of the base model.
//! 5. `faults`: where a fault of the measurement explains it better than effects do, the
//!    measurement is mended and diagnosed again.
//! 6. `inspection`: before a diagnosis, what looks wrong with a measurement, and which effects it can
//!    show at which size.
//! 7. `plan`: before anything is measured, which experiments would show most.
//! 8. `validation`: a stored answer is tested on another measurement, which need not be periodic.

mod doubt;
mod error;
mod faults;
#[cfg(test)]
mod fixtures;
mod holdout;
mod inspection;
mod limitations;
mod linearity;
mod plan;
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
use crate::observer::{Observer, Steady};

pub use error::{DiagnoseError, ValidateError};
pub use faults::as_understood;
pub use inspection::inspect;
pub use linearity::linearity;
pub use plan::{ExcitationError, ExcitationKind, PlanError, excitation, plan};
pub use validation::{diagnose_validated, validate};

use progress::Part;
use residuals::discrepancy;

/// Fits the base model to a measurement and reports where it is wrong, without searching for the
/// cause.
///
/// # Errors
/// See [`DiagnoseError`].
pub fn examine(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<(Identification, Discrepancy), DiagnoseError> {
    let steady = Steady::new(observer);
    steady.rest_is_certain();
    let fit = identify::fit_base(measurement, request, &steady);
    let examined = fit.map(|fit| {
        let discrepancy = discrepancy::of(&fit, request.options.seed, observer);
        (fit.identification, discrepancy)
    });
    Ok(identify::unless_cancelled(observer, examined)?)
}

/// Fits the base model to a measurement, reports where it is wrong, names the effects that it lacks
/// and extends it with them.
///
/// # Errors
/// See [`DiagnoseError`].
pub fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    let steady = Steady::new(observer);
    diagnose_part(measurement, request, Part::of(&steady))
}

/// The same as a part of a computation.
fn diagnose_part(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let diagnosis = faults::diagnose(&measurement.repeated(), request, part);
    identify::unless_cancelled(&part, diagnosis)
}
