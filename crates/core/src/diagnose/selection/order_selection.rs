//! Which order of the actuator goes with which causes.
//!
//! Fitted alone, the base model may take up a missing effect as a higher order of its actuator: a delay
//! or a lag acts much like one. Where the order is left to the data, every lower order is therefore
//! studied as well.

use std::iter;

use crate::answers::{Diagnosis, PlantRequest};
use crate::identify::{FitSession, IdentifyRequest};
use crate::measurement::Measurement;

use super::causes::EQUIVALENT;
use super::evidence::ORDER;
use super::order_study::OrderStudy;
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::progress::{Part, Quiet};

/// Shares of the whole: every effect alone, several together with the best order and with
/// the next best, and what they gain.
const SINGLES: [f64; 2] = [0.0, 0.5];
const COMBINING: [[f64; 2]; 2] = [[0.5, 0.65], [0.65, 0.8]];
const CONCLUDING: [f64; 2] = [0.8, 1.0];

/// The diagnosis with the order that was asked for; where none was, with that of `first`,
/// which the base model takes without any effect, unless a lower one is clearly better. Of
/// records that one alone is studied.
///
/// # Errors
/// See [`DiagnoseError`].
pub(crate) fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    first: &FitSession<'_>,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let (seed, most) = (request.options.seed, request.options.most_effects);
    let suited = first.order();
    let lower: Vec<IdentifyRequest> = (0..suited)
        .filter(|_| request.plant.is_none() && first.has_cosines_alone())
        .map(|actuator_order| IdentifyRequest {
            plant: Some(PlantRequest { actuator_order }),
            ..*request
        })
        .collect();
    let quietly = Quiet(&part);
    let mut others = Vec::with_capacity(lower.len());
    for request in &lower {
        others.push(FitSession::new(measurement, request, &quietly)?);
    }
    let workbenches: Vec<&FitSession<'_>> = iter::once(first).chain(&others).collect();
    let each = 1.0 / workbenches.len() as f64;
    let mut studies = Vec::with_capacity(workbenches.len());
    for (i, session) in workbenches.iter().enumerate() {
        let own = part.part(SINGLES).part([i, i + 1].map(|end| end as f64 * each));
        studies.push(OrderStudy::new(session, own, seed)?);
    }
    let standing = |study: &OrderStudy<'_>| {
        weight(study) - if study.order() == suited { EQUIVALENT } else { 0.0 }
    };
    studies.sort_by(|a, b| standing(a).total_cmp(&standing(b)));
    studies[0].combine(part.part(COMBINING[0]), most, measurement)?;
    if !studies[0].explained() && studies.len() > 1 {
        studies[1].combine(part.part(COMBINING[1]), most, measurement)?;
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
    let part = part.part(CONCLUDING);
    let mut answer = best.conclusion().diagnosis(measurement, request, part)?;
    answer.limitations.extend(said);
    Ok(answer)
}

/// −2 ln of what speaks for an order and its causes.
fn weight(study: &OrderStudy<'_>) -> f64 {
    study.criterion() + ORDER * f64::from(study.order())
}

fn described(study: &OrderStudy<'_>) -> String {
    match study.chosen.as_slice() {
        [] => format!("order {} alone", study.order()),
        causes => format!("order {} with {}", study.order(), causes.join(" and ")),
    }
}
