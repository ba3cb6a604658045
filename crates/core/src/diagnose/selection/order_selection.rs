//! Joint choice of the actuator order and the causes.
//!
//! The base model alone may absorb a missing effect by a higher actuator order, because a delay or
//! a lag acts much like an actuator pole. If the user did not give the order, every lower order is
//! therefore studied as well, and the orders are compared by their criteria.

use std::iter;

use crate::answers::{Diagnosis, PlantRequest};
use crate::identify::{FitSession, IdentifyRequest};
use crate::measurement::Measurement;

use super::causes::EQUIVALENCE_MARGIN;
use super::evidence::ACTUATOR_ORDER_COST;
use super::order_study::OrderStudy;
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::progress::{Part, Quiet};

/// Shares of the progress.
struct Spans {
    /// Every effect alone, at every order.
    singles: [f64; 2],
    /// Several effects together, at the best order and at the second best.
    combining: [[f64; 2]; 2],
    /// Cross-validation and assembly of the answer.
    concluding: [f64; 2],
}

impl Spans {
    fn of(orders: usize) -> Self {
        match orders {
            1 => {
                let combining = [[0.3, 0.75], [0.75, 0.75]];
                Self { singles: [0.0, 0.3], combining, concluding: [0.75, 1.0] }
            }
            _ => {
                let combining = [[0.5, 0.65], [0.65, 0.8]];
                Self { singles: [0.0, 0.5], combining, concluding: [0.8, 1.0] }
            }
        }
    }
}

/// Diagnoses with the actuator order that was requested. If none was, the order is that of
/// `first`, which suits the base model without any effect, unless a lower order is better by more
/// than [`EQUIVALENCE_MARGIN`]. On time records only the order of `first` is studied.
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
        others.push(first.beside(request, &quietly)?);
    }
    let sessions: Vec<&FitSession<'_>> = iter::once(first).chain(&others).collect();
    let each = 1.0 / sessions.len() as f64;
    let spans = Spans::of(sessions.len());
    let mut studies = Vec::with_capacity(sessions.len());
    for (i, session) in sessions.iter().enumerate() {
        let own = part.part(spans.singles).part([i, i + 1].map(|end| end as f64 * each));
        studies.push(OrderStudy::new(session, own, seed)?);
    }
    let ranking_criterion = |study: &OrderStudy<'_>| {
        criterion(study) - if study.order() == suited { EQUIVALENCE_MARGIN } else { 0.0 }
    };
    studies.sort_by(|a, b| ranking_criterion(a).total_cmp(&ranking_criterion(b)));
    studies[0].combine(part.part(spans.combining[0]), most, measurement)?;
    if !studies[0].explained() && studies.len() > 1 {
        studies[1].combine(part.part(spans.combining[1]), most, measurement)?;
        studies.sort_by(|a, b| ranking_criterion(a).total_cmp(&ranking_criterion(b)));
    }
    let mut said = Vec::new();
    let best = studies.remove(0);
    if best.order() < suited {
        said.push(format!(
            "without any effect the data asks for an actuator of order {suited}; better is {}",
            described(&best)
        ));
    }
    if let Some(other) =
        studies.iter().find(|other| criterion(other) - criterion(&best) < EQUIVALENCE_MARGIN)
    {
        said.push(format!(
            "the actuator's order was chosen from the data: {} would explain it about as well",
            described(other)
        ));
    }
    let part = part.part(spans.concluding);
    let mut answer = best.conclusion().diagnosis(measurement, part)?;
    answer.limitations.extend(said);
    Ok(answer)
}

/// −2 ln evidence of an order with its causes.
fn criterion(study: &OrderStudy<'_>) -> f64 {
    study.criterion() + ACTUATOR_ORDER_COST * f64::from(study.order())
}

fn described(study: &OrderStudy<'_>) -> String {
    match study.chosen.as_slice() {
        [] => format!("order {} alone", study.order()),
        causes => format!("order {} with {}", study.order(), causes.join(" and ")),
    }
}
