//! The misfit as a function on the unit cube, for global searches.

use super::bee_colony::Objective;
use super::objective::Misfit;
use super::optimiser::{Descent, Smooth};
use super::refine;
use super::refine::Patience;

/// The misfit over the unit cube, with K solved for.
pub(super) struct OverCube<'a> {
    /// The misfit.
    pub misfit: &'a Misfit<'a>,
}

impl Objective for OverCube<'_> {
    fn dimension(&self) -> usize {
        self.misfit.coordinates.len() - 1
    }

    fn cost(&self, cube: &[f64]) -> f64 {
        if self.misfit.observer.cancelled() {
            return f64::INFINITY;
        }
        let mut point = self.misfit.coordinates.within_search(cube);
        self.misfit.solve_for_constant(&mut point)
    }
}

impl Smooth for OverCube<'_> {
    fn descend(&self, from: &[f64], most: usize, on_step: &mut dyn FnMut(usize, f64)) -> Descent {
        let mut start = self.misfit.coordinates.within_search(from);
        self.misfit.solve_for_constant(&mut start);
        // Solving for K took one evaluation.
        let patience = Patience { evaluations: most as u64 - 1, ..refine::THOROUGH };
        let refined = refine::refine(self.misfit, &start, patience, &mut |_, used, cost| {
            on_step(used as usize + 1, cost);
        });
        Descent {
            point: self.misfit.coordinates.share_of_search_unclamped(&refined.point),
            cost: refined.cost,
            evaluations: refined.evaluations as usize + 1,
        }
    }
}
