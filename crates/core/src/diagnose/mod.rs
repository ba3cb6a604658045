//! What a base model gets wrong, where, and why.
//!
//! A base model is fitted; what it leaves is laid out by magnitude, frequency,
//! harmonic and order of acquisition (`layout`), tested for being noise
//! (`statistics`, `whiteness`), and where it is not, the parts in which the
//! simulation departs most are found (`regions`, `patterns`) and said in words
//! (`sentence`); `discrepancy` puts it together.
//!
//! Then every effect of the library is tried beside the base model (`anchor`,
//! `probes`, `grid`, `scan`) and refitted with it (`fitter`, `search`). An effect is named
//! where it gains more than chance makes any effect gain (`family`, `null`); between
//! those of which that holds, the evidence decides (`evidence`, `models`, `causes`).
//! `study` puts it together for one order of the actuator, and `orders` for several. Parts of
//! the measurement are then held out in turn (`folds`), the causes chosen and fitted anew
//! without them (`unseen`), and what they predict is compared (`gain`, `conclusion`).
//!
//! `validation` tries an answer on another measurement: what the models predict of it
//! (`predicted`) or of motions that do not repeat (`motions`), and what that comes to in words
//! (`remarks`).

mod anchor;
mod causes;
mod conclusion;
mod discrepancy;
mod evidence;
mod family;
mod fitter;
mod folds;
mod gain;
mod grid;
mod groups;
mod layout;
mod limitations;
mod models;
mod motions;
mod next_experiment;
mod null;
mod orders;
mod patterns;
mod predicted;
mod probes;
mod progress;
mod regions;
mod remarks;
mod residual;
mod scan;
mod search;
mod sentence;

mod statistics;
mod study;
mod subspace;
mod unseen;
mod validation;
mod weighing;
mod whiteness;

#[cfg(test)]
mod tests;

use crate::answers::{Diagnosis, Discrepancy, Identification};
use crate::identify::{self, IdentifyError, IdentifyRequest};
use crate::measurement::Measurement;
use crate::observer::Observer;

pub use validation::{ValidateError, diagnose_validated, validate};

use progress::Part;

/// Why a diagnosis gave no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DiagnoseError {
    /// The base model could not be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// The second measurement cannot be used.
    #[error("the second measurement: {0}")]
    Validation(#[from] ValidateError),
}

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
    weighing::diagnose(measurement, request, whole)
}
