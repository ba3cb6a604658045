//! Faults of the measurement as rivals of what was found at any order of the actuator.

use crate::answers::MeasurementFault;
use crate::diagnose::doubt::{Data, Halt, Suspicion};
use crate::diagnose::faults::suspects::Suspected;

use super::evidence::ACTUATOR_ORDER_COST;
use super::order_study::OrderStudy;

/// Faults of the measurement that explain it about as well as effects of the machine do.
pub(super) struct Alternative {
    /// The faults.
    pub faults: Vec<MeasurementFault>,
    /// By how much their −2 ln evidence is lower.
    lead: f64,
}

impl Alternative {
    /// Posterior probability of the effects beside the faults.
    pub fn share_of_effects(&self) -> f64 {
        1.0 / (1.0 + (0.5 * self.lead).exp())
    }
}

/// What the best model of any order with faults of the measurement is to the best without any, if it is
/// better and `is_clear`.
///
/// # Errors
/// Halts where it is better by more than a margin of −2 ln evidence.
pub(super) fn doubt(
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
