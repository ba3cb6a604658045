//! Method `abc-ann`, the one that the paper proposes: a neural network proposes parameters, an
//! artificial bee colony (`bee_colony`) searches, Levenberg–Marquardt refines.

use std::convert::Infallible;

use rand_chacha::ChaCha8Rng;

use crate::answers::{ColonyOptions, IdentifyOptions};

use super::super::bee_colony;
use super::super::optimiser::{Optimiser, Search, Stop};
use super::steps::Steps;

pub(super) const STEPS: Steps =
    Steps { closed_form: true, network: true, search: Some(&BeeColony), refinement: true };

struct BeeColony;

impl Optimiser for BeeColony {
    fn stage(&self) -> &'static str {
        "colony"
    }

    fn is_enabled(&self, options: &IdentifyOptions) -> bool {
        options.colony.enabled
    }

    fn budget(&self, options: &IdentifyOptions) -> usize {
        // The colony spends its budget in whole cycles.
        let ColonyOptions { food_sources, .. } = options.colony;
        food_sources * (2 * cycles(options) + 1)
    }

    fn search(&self, search: &mut Search<'_>, rng: &mut ChaCha8Rng) -> Result<Infallible, Stop> {
        let colony = ColonyOptions { cycles: cycles(search.options), ..search.options.colony };
        let (objective, initial) = (search.objective, search.initial);
        let outcome = bee_colony::search(objective, initial, &colony, rng, &mut |cycle| {
            let mean = cycle.mean_cost.is_finite().then_some(cycle.mean_cost);
            search.pass_on(cycle.cycle, cycle.evaluations, cycle.best_cost, mean)
        });
        search.adopt(&outcome.best, outcome.cost, outcome.evaluations);
        Err(match outcome.stop {
            bee_colony::StopReason::Cancelled => Stop::Cancelled,
            bee_colony::StopReason::CyclesDone => Stop::EveryCycleEnded,
        })
    }
}

/// Number of cycles: as many as the evaluation budget allows, if there is one.
fn cycles(options: &IdentifyOptions) -> usize {
    let ColonyOptions { food_sources, cycles, .. } = options.colony;
    let paid = |budget: usize| (budget / food_sources).saturating_sub(1) / 2;
    options.evaluation_budget.map_or(cycles, paid)
}
