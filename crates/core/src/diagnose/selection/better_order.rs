//! The order of the actuator, chosen again beside the effects that were found.

use super::causes::EQUIVALENCE_MARGIN;
use super::evidence::ACTUATOR_ORDER_COST;
use super::order_selection::criterion;
use super::order_study::OrderStudy;
use crate::diagnose::doubt::Halt;
use crate::diagnose::progress::Quiet;
use crate::identify::{FitSession, IdentifyRequest};

/// The session of that one of other orders which is best, and better than the order of a study beside
/// the effects that were chosen there. The base model of a machine with a large effect is so wrong
/// that its own order means little.
pub(super) fn better_order<'a>(
    study: &OrderStudy<'_>,
    others: &'a [IdentifyRequest],
    first: &FitSession<'a>,
    observer: &'a Quiet<'a>,
) -> Result<Option<FitSession<'a>>, Halt> {
    if study.chosen.is_empty() {
        return Ok(None);
    }
    let own = criterion(study);
    let mut best: Option<(f64, FitSession<'_>)> = None;
    for request in others {
        let session = first.beside(request, observer)?;
        let cost = ACTUATOR_ORDER_COST * f64::from(session.order());
        let Some(criterion) = study.criterion_beside(&session).map(|own| own + cost) else {
            continue;
        };
        // A higher order must be clearly better; a lower one is simpler.
        let margin = if session.order() > study.order() { EQUIVALENCE_MARGIN } else { 0.0 };
        if criterion < best.as_ref().map_or(own - margin, |best| best.0) {
            best = Some((criterion, session));
        }
    }
    Ok(best.map(|(_, session)| session))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::PlantRequest;
    use crate::diagnose::fixtures::{multisine_record, plant};
    use crate::diagnose::progress::Part;
    use crate::machines::simulator::Effect;
    use crate::observer::Silent;
    use crate::plant::{Actuator, Plant};

    /// Whether another order is better beside what is found at one, on a record with an asymmetric
    /// gain.
    fn better([order, other]: [u8; 2], actuator: Actuator) -> bool {
        let effects = [Effect::new("gain_asymmetry", [("gamma", 0.15)])];
        let record = multisine_record(Plant { actuator, ..plant() }, &effects, None, 5);
        let of_order = |actuator_order| IdentifyRequest {
            plant: Some(PlantRequest { actuator_order }),
            ..IdentifyRequest::default()
        };
        let (request, others) = (of_order(order), [of_order(other)]);
        let first = FitSession::new(&record, &request, &Silent).unwrap();
        let part = Part::of(&Silent);
        let study = OrderStudy::new(&first, part, 1).unwrap();
        assert_eq!(study.chosen, ["gain_asymmetry"]);
        let observer = Quiet(&part);
        better_order(&study, &others, &first, &observer).unwrap().is_some()
    }

    #[test]
    fn the_order_is_chosen_again_beside_the_effect_that_is_found() {
        let lagging = Actuator::FirstOrder { corner_rad_s: 400.0 };
        assert_eq!([[0, 1], [1, 0]].map(|orders| better(orders, lagging)), [true, false]);
        assert_eq!([[0, 1], [1, 0]].map(|orders| better(orders, Actuator::Direct)), [false, true]);
    }
}
