//! Which order of the actuator goes with which causes.
//!
//! What an axis lacks may have been taken for a higher order of its actuator when the base
//! model was fitted alone: a delay or a lag is much like one. So where the order is left to
//! the data, every lower one is studied as well.

use crate::answers::Diagnosis;
use crate::identify::{IdentifyRequest, Workbench};

use super::DiagnoseError;
use super::causes::EQUIVALENT;
use super::evidence::ORDER;
use super::progress::Part;
use super::study::Study;

/// Share of the whole that looking at every effect alone takes.
const SINGLES: f64 = 0.5;

/// The diagnosis with the best of some base models: that which was chosen without any
/// effect comes first, and stays unless another is clearly better.
///
/// # Errors
/// See [`DiagnoseError`].
pub(super) fn diagnose(
    workbenches: &[Workbench<'_>],
    part: Part<'_>,
    request: &IdentifyRequest,
) -> Result<Diagnosis, DiagnoseError> {
    let (seed, most) = (request.options.seed, request.options.most_effects);
    let suited = workbenches[0].order();
    let each = SINGLES / workbenches.len() as f64;
    let mut studies = Vec::with_capacity(workbenches.len());
    for (i, workbench) in workbenches.iter().enumerate() {
        let begin = i as f64 * each;
        studies.push(Study::new(workbench, part.part([begin, begin + each]), seed)?);
    }
    let standing =
        |study: &Study<'_>| weight(study) - if study.order() == suited { EQUIVALENT } else { 0.0 };
    studies.sort_by(|a, b| standing(a).total_cmp(&standing(b)));
    studies[0].combine(part.part([SINGLES, 0.75]), most)?;
    if !studies[0].explained() && studies.len() > 1 {
        studies[1].combine(part.part([0.75, 1.0]), most)?;
        studies.sort_by(|a, b| standing(a).total_cmp(&standing(b)));
    }
    let mut said = Vec::new();
    let best = studies.remove(0);
    if best.order() < suited {
        said.push(format!(
            "without any effect the data asks for an actuator of order {suited}; better is {}",
            described(&best)
        ));
    }
    if let Some(other) = studies.iter().find(|other| weight(other) - weight(&best) < EQUIVALENT) {
        said.push(format!(
            "the actuator's order was chosen from the data: {} would explain it about as well",
            described(other)
        ));
    }
    let mut answer = best.diagnosis()?;
    answer.limitations.extend(said);
    Ok(answer)
}

/// −2 ln of what speaks for an order and its causes.
fn weight(study: &Study<'_>) -> f64 {
    study.criterion() + ORDER * f64::from(study.order())
}

fn described(study: &Study<'_>) -> String {
    match study.chosen.as_slice() {
        [] => format!("order {} alone", study.order()),
        causes => format!("order {} with {}", study.order(), causes.join(" and ")),
    }
}
