//! Joint choice of the actuator order and the causes.
//!
//! The base model alone may absorb a missing effect by a higher actuator order, because a delay or
//! a lag acts much like an actuator pole. If the user did not give the order, every lower order is
//! therefore studied as well, and the orders are compared by their criteria.

use std::cmp::Ordering;
use std::iter;

use crate::answers::{Diagnosis, Identification, PlantRequest};
use crate::identify::{FitSession, IdentifyRequest};

use super::actuator_doubt::ActuatorDoubt;
use super::better_order::better_order;
use super::causes::EQUIVALENCE_MARGIN;
use super::evidence::ACTUATOR_ORDER_COST;
use super::order_study::OrderStudy;
use super::rival_faults::doubt;
use super::spans::Spans;
use crate::diagnose::doubt::{Data, Halt};
use crate::diagnose::faults::suspects::{CLEARLY_BETTER, Suspected};
use crate::diagnose::faults::words;
use crate::diagnose::progress::{Part, Quiet};

/// What faults beside an effect, or several beside none, may cost at most for that: about two rows.
/// A further effect may show in a few rows alone. Tuned.
const LARGEST_CLEAR_PRICE: f64 = 50.0;

/// Highest order of an actuator.
const HIGHEST_ORDER: u8 = 2;

/// What a search with the weights of the base model ends with.
pub(super) enum Found {
    /// The answer.
    Answer(Box<Diagnosis>),
    /// The best model of one effect at most, from which other weights follow than those of the base
    /// model. No effects were combined.
    OtherWeights(Box<Identification>),
}

/// Diagnoses with the weights of a session; see [`unless_reweighted`].
///
/// # Errors
/// See [`crate::diagnose::DiagnoseError`]; and the faults of the measurement, if it is doubted and
/// has any.
pub(super) fn diagnose(
    data: Data<'_>,
    request: &IdentifyRequest,
    first: &FitSession<'_>,
    part: Part<'_>,
) -> Result<Diagnosis, Halt> {
    match search(data, request, first, false, part)? {
        Found::Answer(answer) => Ok(*answer),
        Found::OtherWeights(_) => unreachable!("the weights stay"),
    }
}

/// Diagnoses with the weights of a session, unless others follow from the best single effect: then it
/// ends before effects are combined.
///
/// The actuator has the order that was requested. If none was, the order is that of `first`, which suits
/// the base model without any effect, unless a lower order is better by more than
/// [`EQUIVALENCE_MARGIN`]. On time records the order of `first` is studied, or lower ones in its place if
/// its actuator is in doubt. Then, beside the effects that are found, a higher order is taken if it is
/// better by as much, or, on time records, a lower one if it is better and the actuator is beyond the
/// excited band. Where one effect explains a table, no higher order is tried.
///
/// # Errors
/// As of [`diagnose`].
pub(super) fn unless_reweighted(
    data: Data<'_>,
    request: &IdentifyRequest,
    first: &FitSession<'_>,
    part: Part<'_>,
) -> Result<Found, Halt> {
    search(data, request, first, true, part)
}

fn search(
    data: Data<'_>,
    request: &IdentifyRequest,
    first: &FitSession<'_>,
    may_be_reweighted: bool,
    part: Part<'_>,
) -> Result<Found, Halt> {
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
        // Of a table the next best order stays, to be studied where this one is not enough.
        studies.truncate(usize::from(of_cosines));
        studies.insert(0, OrderStudy::new(&better, part.part(spans.again), seed)?);
    }
    if may_be_reweighted {
        let found = studies[0].best()?;
        if !first.has_weights_of(&found)? {
            return Ok(Found::OtherWeights(Box::new(found)));
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
    Ok(Found::Answer(Box::new(answer)))
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
    use crate::plant::{Actuator, Friction, Plant};

    /// The parameters of the best single effect, if other weights follow from it.
    fn reweighted_by(measurement: &Measurement) -> Option<Vec<String>> {
        let request = request();
        let session = FitSession::new(measurement, &request, &Silent).unwrap();
        let data = Data { measurement, doubted: false, lead_s: 0.0 };
        match unless_reweighted(data, &request, &session, Part::of(&Silent)).unwrap() {
            Found::OtherWeights(model) => Some(model.parameters.into_keys().collect()),
            Found::Answer(_) => None,
        }
    }

    // What the base model leaves of a saturation is far larger at the highest magnitude.
    #[test]
    fn weights_that_a_single_effect_changes_are_settled_before_effects_are_combined() {
        let effects = vec![Effect::new("actuator_saturation", [("limit", 1.2)])];
        let noise_statement = NoiseStatement::Silent;
        let saturated = Draw { effects, harmonics: 5, noise_statement, ..draw(0, 3) };
        let saturated = measure(&saturated, 1).unwrap();
        let found = reweighted_by(&saturated).unwrap();
        assert!(found.iter().any(|name| name == "actuator_saturation.limit"), "{found:?}");
        assert_eq!(reweighted_by(&noisy(&exact(), NoiseStatement::Silent, 1)), None);
    }

    // Without the backlash the actuator's lag is not worth a parameter.
    #[test]
    fn a_higher_order_is_tried_beside_an_effect_that_is_not_enough() {
        let (actuator, friction) =
            (Actuator::FirstOrder { corner_rad_s: 90.6 }, Friction::coulomb(0.258, 0.265));
        let plant = Plant { viscous_rate_rad_s: 6.68, constant: 24.8, actuator, friction };
        let joint = [("load_inertia_fraction", 0.3), ("stiffness", 13.0), ("damping", 0.0794)];
        let gap = [("gap", 0.00955)];
        let effects = vec![Effect::new("backlash", joint.into_iter().chain(gap))];
        let omegas = (0..14).map(|i| 1.336 * 40f64.powf(f64::from(i) / 13.0));
        let design = omegas.flat_map(|omega| [0.775, 1.29, 2.15].map(|m| (m, omega))).collect();
        let (noise_db, noise_statement) = (Some(54.0), NoiseStatement::Silent);
        let draw = Draw { plant, effects, design, harmonics: 3, noise_db, noise_statement };
        let measurement = &measure(&draw, 6).unwrap();
        let request = IdentifyRequest { plant: None, ..request() };
        let session = FitSession::new(measurement, &request, &Silent).unwrap();
        assert_eq!(session.order(), 0);
        let data = Data { measurement, doubted: false, lead_s: 0.0 };
        let part = Part::of(&Silent);
        let step = |session: &FitSession<'_>| match unless_reweighted(data, &request, session, part)
            .unwrap()
        {
            Found::OtherWeights(model) => *model,
            Found::Answer(answer) => answer.extended.unwrap(),
        };
        let model = step(&session);
        let model = step(&session.weighted_by(&model, &Silent).unwrap());
        let has = |parameter: &str| model.parameters.contains_key(parameter);
        assert!(has("backlash.gap") && has("actuator_pole"), "{:?}", model.parameters);
    }
}
