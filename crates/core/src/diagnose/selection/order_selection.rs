//! Joint choice of the actuator order and the causes.
//!
//! The base model alone may absorb a missing effect by a higher actuator order, because a delay or
//! a lag acts much like an actuator pole. If the user did not give the order, every lower order is
//! therefore studied as well, and the orders are compared by their criteria.

use std::cmp::Ordering;
use std::iter;

use crate::answers::{Diagnosis, MeasurementFault, PlantRequest};
use crate::identify::{FitSession, IdentifyRequest};

use super::actuator_doubt::ActuatorDoubt;
use super::better_order::better_order;
use super::causes::EQUIVALENCE_MARGIN;
use super::evidence::ACTUATOR_ORDER_COST;
use super::order_study::OrderStudy;
use super::spans::Spans;
use crate::diagnose::doubt::{Data, Halt, Suspicion};
use crate::diagnose::faults::suspects::{CLEARLY_BETTER, Suspected};
use crate::diagnose::faults::words;
use crate::diagnose::progress::{Part, Quiet};

/// What faults beside an effect, or several beside none, may cost at most for that: about two rows.
/// A further effect may show in a few rows alone. Tuned.
const LARGEST_CLEAR_PRICE: f64 = 50.0;

/// Highest order of an actuator.
const HIGHEST_ORDER: u8 = 2;

/// Whether the weights of a session stay as they are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Weights {
    /// They follow from what the base model leaves, and are to follow from what the best single effect
    /// leaves before effects are combined.
    Open,
    /// They stay.
    Settled,
}

/// Diagnoses with the actuator order that was requested. If none was, the order is that of
/// `first`, which suits the base model without any effect, unless a lower order is better by more
/// than [`EQUIVALENCE_MARGIN`]. On time records the order of `first` is studied, or lower ones in its
/// place if its actuator is in doubt. Then, beside the effects that are found, a higher order is taken if
/// it is better by as much, or a lower one if it is better and the actuator is beyond the excited band.
///
/// # Errors
/// See [`crate::diagnose::DiagnoseError`]; the faults of the measurement, if it is doubted and has any;
/// and the best model of one effect, if the weights are open and those that follow from it are others.
pub(super) fn diagnose(
    data: Data<'_>,
    request: &IdentifyRequest,
    first: &FitSession<'_>,
    weights: Weights,
    part: Part<'_>,
) -> Result<Diagnosis, Halt> {
    let measurement = data.measurement;
    let (seed, most) = (request.options.seed, request.options.most_effects);
    let suited = first.order();
    let of_order = |actuator_order| IdentifyRequest {
        plant: Some(PlantRequest { actuator_order }),
        ..*request
    };
    let (is_open, of_cosines) = (request.plant.is_none(), first.has_cosines_alone());
    let of_record = is_open && !of_cosines;
    let actuator_doubt = of_record.then(|| ActuatorDoubt::of(first, seed)).flatten();
    let tries_lower = is_open && of_cosines || actuator_doubt.is_some();
    let gives_way = actuator_doubt.is_some() && suited > 0;
    let lower: Vec<IdentifyRequest> = (0..suited).filter(|_| tries_lower).map(of_order).collect();
    let may_be_better = |order: &u8| match order.cmp(&suited) {
        Ordering::Less => !tries_lower && first.actuator_is_fast(),
        Ordering::Equal => gives_way,
        Ordering::Greater => true,
    };
    let others: Vec<IdentifyRequest> =
        (0..=HIGHEST_ORDER).filter(|order| is_open && may_be_better(order)).map(of_order).collect();
    let quietly = Quiet(&part);
    let mut lower_sessions = Vec::with_capacity(lower.len());
    for request in &lower {
        lower_sessions.push(first.beside(request, &quietly)?);
    }
    let sessions: Vec<&FitSession<'_>> =
        iter::once(first).filter(|_| !gives_way).chain(&lower_sessions).collect();
    let better;
    let each = 1.0 / sessions.len() as f64;
    let spans = Spans::of(sessions.len(), !others.is_empty());
    let mut studies = Vec::with_capacity(sessions.len());
    for (i, session) in sessions.iter().enumerate() {
        let own = part.part(spans.singles).part([i, i + 1].map(|end| end as f64 * each));
        studies.push(OrderStudy::new(session, own, seed)?);
    }
    let ranking_criterion = |study: &OrderStudy<'_>| {
        criterion(study) - if study.order() == suited { EQUIVALENCE_MARGIN } else { 0.0 }
    };
    studies.sort_by(|a, b| ranking_criterion(a).total_cmp(&ranking_criterion(b)));
    let is_settled = of_cosines && studies[0].explained();
    let others = if is_settled { &[][..] } else { &others };
    if let Some(session) = better_order(&studies[0], others, first, &quietly)? {
        better = session;
        studies.truncate(if of_cosines { 1 } else { 0 });
        studies.insert(0, OrderStudy::new(&better, part.part(spans.again), seed)?);
    }
    if weights == Weights::Open {
        let found = studies[0].best()?;
        if !first.has_weights_of(&found)? {
            return Err(Halt::OtherWeights(Box::new(found)));
        }
    }
    if data.doubted && !studies[0].explained() {
        let is_clear = |found: &Suspected| {
            let is_only_one = found.effects == 0 && found.faults.len() == 1;
            is_only_one || found.price < LARGEST_CLEAR_PRICE
        };
        // A fault of a record costs more than chance gains.
        let margin = if first.has_cosines_alone() { CLEARLY_BETTER } else { 0.0 };
        doubt(&studies, data, margin, &is_clear)?;
    }
    studies[0].combine(part.part(spans.combining[0]), most, measurement)?;
    if !studies[0].explained() && studies.len() > 1 {
        studies[1].combine(part.part(spans.combining[1]), most, measurement)?;
        studies.sort_by(|a, b| ranking_criterion(a).total_cmp(&ranking_criterion(b)));
    }
    let mut said = Vec::new();
    let mut alternative = None;
    if data.doubted {
        // Data are not left out for what effects explain about as well. Of records none are.
        let explained = studies[0].explained() && !studies[0].chosen.is_empty();
        let leaves_out = first.has_cosines_alone();
        let margin = if explained && leaves_out { EQUIVALENCE_MARGIN } else { 0.0 };
        alternative = doubt(&studies, data, margin, &|_| true)?;
    }
    let best = studies.remove(0);
    if best.order() != suited {
        said.push(match &actuator_doubt {
            Some(ActuatorDoubt::UnshownResonance { sentence }) if best.order() < suited => {
                sentence.clone()
            }
            _ => format!(
                "without effects, an actuator of order {suited} fits best; {} fits better still and \
                 was chosen",
                described(&best)
            ),
        });
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
    if let Some(alternative) = alternative {
        let share = alternative.share_of_effects();
        answer.causes.iter_mut().for_each(|cause| cause.confidence *= share);
        answer.rival_faults = alternative.faults;
        words::describe_suspects(&mut answer.rival_faults, measurement);
    }
    answer.limitations.extend(said);
    Ok(answer)
}

/// Faults of the measurement that explain it about as well as effects of the machine do.
struct Alternative {
    faults: Vec<MeasurementFault>,
    /// By how much their −2 ln evidence is lower.
    lead: f64,
}

impl Alternative {
    /// Posterior probability of the effects beside the faults.
    fn share_of_effects(&self) -> f64 {
        1.0 / (1.0 + (0.5 * self.lead).exp())
    }
}

/// What the best model of any order with faults of the measurement is to the best without any, if it is
/// better and `is_clear`.
///
/// # Errors
/// Halts where it is better by more than a margin of −2 ln evidence.
fn doubt(
    studies: &[OrderStudy<'_>],
    data: Data<'_>,
    margin: f64,
    is_clear: &dyn Fn(&Suspected) -> bool,
) -> Result<Option<Alternative>, Halt> {
    let order_cost = |study: &OrderStudy<'_>| ACTUATOR_ORDER_COST * f64::from(study.order());
    let without = studies.iter().map(|study| study.best_criterion() + order_cost(study));
    let without = without.fold(f64::INFINITY, f64::min);
    let explaining = studies.iter().find(|study| study.explained()).map(|study| &study.chosen);
    let suspected = studies.iter().filter_map(|study| {
        let suspected = study.suspected(data.lead_s, explaining).filter(is_clear)?;
        let lead = without - suspected.criterion - order_cost(study);
        Some(Alternative { faults: suspected.faults, lead })
    });
    let best = suspected.max_by(|a, b| a.lead.total_cmp(&b.lead));
    match (best, studies.first()) {
        (Some(best), Some(study)) if best.lead > margin => {
            let as_measured = study.as_measured()?;
            Err(Halt::Faults(Box::new(Suspicion { faults: best.faults, as_measured })))
        }
        (best, _) => Ok(best.filter(|best| best.lead > 0.0)),
    }
}

/// −2 ln evidence of an order with its causes.
pub(super) fn criterion(study: &OrderStudy<'_>) -> f64 {
    study.criterion() + ACTUATOR_ORDER_COST * f64::from(study.order())
}

fn described(study: &OrderStudy<'_>) -> String {
    match study.chosen.as_slice() {
        [] => format!("order {} alone", study.order()),
        causes => format!("order {} with {}", study.order(), causes.join(" and ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{exact, noisy, request};
    use crate::machines::draw::{Draw, NoiseStatement, draw, measure};
    use crate::machines::simulator::Effect;
    use crate::measurement::Measurement;
    use crate::observer::Silent;

    /// Whether the search ends at a single effect whose weights are others than those of the base model;
    /// `parameter` is one of this effect.
    fn ends_at(parameter: &str, measurement: &Measurement, weights: Weights) -> bool {
        let request = request();
        let session = FitSession::new(measurement, &request, &Silent).unwrap();
        let data = Data { measurement, doubted: false, lead_s: 0.0 };
        match diagnose(data, &request, &session, weights, Part::of(&Silent)) {
            Err(Halt::OtherWeights(model)) => model.parameters.contains_key(parameter),
            answer => answer.is_err(),
        }
    }

    // What the base model leaves of a saturation is far larger at the highest magnitude.
    #[test]
    fn weights_that_a_single_effect_changes_are_settled_before_effects_are_combined() {
        let effects = vec![Effect::new("actuator_saturation", [("limit", 1.2)])];
        let noise_statement = NoiseStatement::Silent;
        let saturated = Draw { effects, harmonics: 5, noise_statement, ..draw(0, 3) };
        let saturated = measure(&saturated, 1).unwrap();
        let limit = "actuator_saturation.limit";
        assert!(ends_at(limit, &saturated, Weights::Open));
        assert!(!ends_at(limit, &saturated, Weights::Settled));
        assert!(!ends_at(limit, &noisy(&exact(), NoiseStatement::Silent, 1), Weights::Open));
    }
}
