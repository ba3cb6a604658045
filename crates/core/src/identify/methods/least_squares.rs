//! Method `least-squares`, a baseline: bounded Levenberg–Marquardt from several random starts
//! (multistart). It is what anybody would try first, and what a population search has to beat.

use std::convert::Infallible;

use rand_chacha::ChaCha8Rng;

use super::super::optimiser::{Optimiser, Search, Stop};
use super::steps::Steps;

pub(super) const STEPS: Steps =
    Steps { closed_form: false, network: false, search: Some(&MultiStart), refinement: true };

/// Number of starts, uniform over the search range: as many as the paper's colony has food sources.
const STARTS: usize = 10;

/// Evaluations of the shortest descent: solving for K, the derivatives, one step, and the
/// derivatives there.
const SHORTEST_DESCENT: usize = 4;

struct MultiStart;

impl Optimiser for MultiStart {
    fn stage(&self) -> &'static str {
        "descents"
    }

    fn search(&self, search: &mut Search<'_>, rng: &mut ChaCha8Rng) -> Result<Infallible, Stop> {
        for start in search.population(STARTS, rng) {
            if search.left() < SHORTEST_DESCENT {
                return Err(Stop::BudgetSpent);
            }
            search.descend(&start)?;
        }
        Err(Stop::EveryStartDescended)
    }
}
