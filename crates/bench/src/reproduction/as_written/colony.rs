//! The paper's colony: Table I, Figure 3, and the objective in it.
//!
//! Ten food sources, fifty cycles, one dimension a step. The objective compares parameters with
//! the *known* target parameters: nothing is measured, and nothing is simulated.
//!
//! What cannot be followed to the letter: the paper gives no range for the parameters (here 0 to
//! twice the target, a sign known beforehand), no limit after which a source is abandoned (here
//! the customary sources × parameters), and takes the probabilities p of the onlookers from a
//! fitness that it does not define (here from ranks).

use std::ops::ControlFlow;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use servoscope_core::answers::{ColonyOptions, ColonyVariant};
use servoscope_core::identify::bee_colony;

use super::super::system::System;
use super::{largest_error, targets};

/// How the sum over the deviations is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// As printed, Σ (P_actual − P_set): it has no least value, only a corner of the range.
    AsPrinted,
    /// With absolute values, which must be meant.
    Absolute,
}

impl Objective {
    /// Both.
    pub const ALL: [Objective; 2] = [Objective::AsPrinted, Objective::Absolute];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Objective::AsPrinted => "as printed",
            Objective::Absolute => "with absolute values",
        }
    }
}

/// Where a colony ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Colony {
    /// Largest relative error of a parameter.
    pub error: f64,
    /// Objectives evaluated.
    pub evaluations: usize,
}

struct Distance {
    objective: Objective,
    targets: Vec<f64>,
}

impl Distance {
    /// Parameters at a point of the cube: from 0 to twice the target.
    fn parameters(&self, cube: &[f64]) -> Vec<f64> {
        cube.iter().zip(&self.targets).map(|(share, target)| 2.0 * share * target).collect()
    }
}

impl bee_colony::Objective for Distance {
    fn dimension(&self) -> usize {
        self.targets.len()
    }

    fn cost(&self, cube: &[f64]) -> f64 {
        let parameters = self.parameters(cube);
        let deviations = parameters.iter().zip(&self.targets).map(|(set, actual)| actual - set);
        match self.objective {
            Objective::AsPrinted => deviations.sum(),
            Objective::Absolute => deviations.map(f64::abs).sum(),
        }
    }
}

/// Flies the paper's colony.
pub(super) fn fly(system: System, objective: Objective, seed: u64) -> Colony {
    let distance = Distance { objective, targets: targets(system) };
    let options = ColonyOptions { variant: ColonyVariant::Literal, ..ColonyOptions::default() };
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let outcome =
        bee_colony::search(&distance, &[], &options, rng, &mut |_| ControlFlow::Continue(()));
    let error = largest_error(&distance.parameters(&outcome.best), &distance.targets);
    Colony { error, evaluations: outcome.evaluations }
}

#[cfg(test)]
mod tests {
    use super::super::super::figure_of_merit::median;
    use super::*;

    // 1010 evaluations in all, one dimension a step: percents, not the 0.004 % that was printed.
    #[test]
    fn with_absolute_values_it_comes_near_the_targets_and_as_printed_to_a_corner() {
        for system in System::ALL {
            let errors = |objective| -> Vec<f64> {
                (1..=20).map(|seed| fly(system, objective, seed).error).collect()
            };
            let near = median(&errors(Objective::Absolute));
            assert!((4e-5..0.2).contains(&near), "{near}");
            // Positive parameters go to the upper end, negative ones to 0: 100 % off.
            assert!(errors(Objective::AsPrinted).iter().all(|error| *error > 0.9));
        }
    }
}
