//! What a base model gets wrong, where, and why.
//!
//! A base model is fitted; what it leaves is laid out by magnitude, frequency,
//! harmonic and order of acquisition (`layout`), tested for being noise
//! (`statistics`, `whiteness`), and where it is not, the parts in which the
//! simulation departs most are found (`regions`, `patterns`) and said in words
//! (`sentence`); `discrepancy` puts it together.
//!
//! Then every effect of the library is tried beside the base model (`anchor`,
//! `probes`, `scan`) and refitted with it (`search`). An effect is named where it
//! gains more than chance makes any effect gain (`family`, `null`); between those
//! of which that holds, the evidence decides (`evidence`, `causes`). `study` puts
//! it together for one order of the actuator.

mod anchor;
mod causes;
mod discrepancy;
mod evidence;
mod family;
mod groups;
mod layout;
mod next_experiment;
mod null;
mod patterns;
mod probes;
mod progress;
mod regions;
mod residual;
mod scan;
mod search;
mod sentence;
mod statistics;
mod study;
mod subspace;
mod whiteness;

#[cfg(test)]
mod tests;

use crate::answers::{Diagnosis, Discrepancy, Identification, PlantRequest};
use crate::identify::{self, IdentifyError, IdentifyRequest, Workbench};
use crate::measurement::Measurement;
use crate::observer::Observer;

use progress::Part;
use study::Study;

/// Share of the largest component below which a difference between model and data
/// says nothing: two good simulations of one machine agree to no more (contract, section 3).
const ROUNDING: f64 = 1e-5;

/// Share of a diagnosis that is fitting the base model.
const FITTING: f64 = 0.1;

/// Why a diagnosis gave no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DiagnoseError {
    /// The base model could not be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
}

impl From<DiagnoseError> for IdentifyError {
    fn from(DiagnoseError::Identify(error): DiagnoseError) -> Self {
        error
    }
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
    let seed = request.options.seed;
    let whole = Part { whole: observer, span: [0.0, 1.0] };
    let fitting = whole.part([0.0, FITTING]);
    let workbench = Workbench::new(measurement, request, &fitting)?;
    let order = workbench.order();
    if request.plant.is_some() || order == 0 {
        return Study::new(&workbench, whole.part([FITTING, 1.0]), seed)?.diagnosis();
    }
    let study = Study::new(&workbench, whole.part([FITTING, 0.5]), seed)?;
    // A delay or a lag may have been taken for one more order of the actuator.
    let plant = Some(PlantRequest { actuator_order: order - 1 });
    let request = IdentifyRequest { plant, ..*request };
    let fitting = whole.part([0.5, 0.5 + FITTING]);
    let lower = Workbench::new(measurement, &request, &fitting)?;
    let lower = Study::new(&lower, whole.part([0.5 + FITTING, 1.0]), seed)?;
    let advantage = study.criterion() + evidence::ORDER - lower.criterion();
    if advantage > causes::EQUIVALENT {
        return lower.diagnosis();
    }
    let mut answer = study.diagnosis()?;
    if advantage > -causes::EQUIVALENT && !lower.chosen.is_empty() {
        answer.limitations.push(format!(
            "the actuator's order was chosen from the data: one of order {} with {} would \
             explain it about as well",
            order - 1,
            lower.chosen.join(" and ")
        ));
    }
    Ok(answer)
}
