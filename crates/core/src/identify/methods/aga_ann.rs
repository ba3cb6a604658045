//! Method `aga-ann`, the paper's adaptive hybrid technique: like `ga-ann`, with rates that adapt to
//! the spread of the fitness.
//!
//! ```text
//!   p_c = k₁ (f_max − f′)/(f_max − f̄) where f′ ≥ f̄, else k₃     f′ the fitter of two parents
//!   p_m = k₂ (f_max − f)/(f_max − f̄)  where f ≥ f̄,  else k₄     f the fitness of the mutated
//!   k₁ = k₃ = 1, k₂ = k₄ = 0.5
//! ```
//!
//! M. Srinivas and L. M. Patnaik, IEEE Trans. Systems, Man, and Cybernetics 24 (1994) 656,
//! doi:10.1109/21.286385. Good solutions are protected, those below the mean are disrupted, and
//! both rates rise when all solutions are alike. The authors mutate every solution with a rate of
//! at least 0.005, so that the best does not take over the population. A child has no fitness yet
//! when it is mutated, so the fitness of its parent is used.

use super::genetic::{Fitness, Genetic, Rates};
use super::steps::Steps;

pub(super) const STEPS: Steps = Steps {
    closed_form: true,
    network: true,
    search: Some(&Genetic { stage: "adaptive_genetic", rates: &Adaptive }),
    refinement: true,
};

const K1: f64 = 1.0;
const K2: f64 = 0.5;
const K3: f64 = 1.0;
const K4: f64 = 0.5;

/// Smallest mutation rate, that of the fittest.
const LEAST_MUTATION: f64 = 0.005;

struct Adaptive;

impl Rates for Adaptive {
    fn crossover(&self, fitness: &Fitness, fitter: f64) -> f64 {
        share_below_best(fitness, fitter).map_or(K3, |share| K1 * share)
    }

    fn mutation(&self, fitness: &Fitness, of: f64, _: usize) -> f64 {
        share_below_best(fitness, of).map_or(K4, |share| (K2 * share).max(LEAST_MUTATION))
    }
}

/// (f_max − f)/(f_max − f̄): 0 for the best, 1 for the mean. `None` below the mean, and if all
/// individuals are alike.
fn share_below_best(fitness: &Fitness, of: f64) -> Option<f64> {
    let spread = fitness.best - fitness.mean;
    (of >= fitness.mean && spread > 0.0).then(|| (fitness.best - of) / spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rates_are_zero_for_the_best_and_full_at_the_mean_and_below() {
        let fitness = Fitness { best: 4.0, mean: 2.0 };
        let crossover = |f| Adaptive.crossover(&fitness, f);
        assert_eq!([4.0, 3.0, 2.0, -1.0].map(crossover), [0.0, 0.5, 1.0, 1.0]);
        let mutation = |f| Adaptive.mutation(&fitness, f, 4);
        assert_eq!([4.0, 3.0, 2.0, -1.0].map(mutation), [0.005, 0.25, 0.5, 0.5]);
    }

    #[test]
    fn where_all_are_alike_both_rates_are_full() {
        let alike = Fitness { best: 1.0, mean: 1.0 };
        assert_eq!(
            (Adaptive.crossover(&alike, 1.0), Adaptive.mutation(&alike, 1.0, 4)),
            (1.0, 0.5)
        );
    }
}
