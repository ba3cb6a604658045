//! Method `ga-ann`, the paper's hybrid technique: like `abc-ann`, with a genetic algorithm of fixed
//! rates in place of the colony.

use super::genetic::{Fitness, Genetic, Rates};
use super::steps::Steps;

pub(super) const STEPS: Steps = Steps {
    closed_form: true,
    network: true,
    search: Some(&Genetic { stage: "genetic", rates: &Fixed }),
    refinement: true,
};

/// Nine pairs of ten are crossed, and on average one gene of a child is mutated; both rates are
/// those of K. Deb and R. Agrawal, Complex Systems 9 (1995) 115.
struct Fixed;

impl Rates for Fixed {
    fn crossover(&self, _: &Fitness, _: f64) -> f64 {
        0.9
    }

    fn mutation(&self, _: &Fitness, _: f64, genes: usize) -> f64 {
        1.0 / genes as f64
    }
}
