//! The paper's bee colony: Table I, Figure 3, and the objective in it.
//!
//! It has ten food sources and fifty cycles, and changes one dimension per step. The objective
//! compares parameters with the *known* target parameters; nothing is measured or simulated.
//!
//! The paper leaves three details open. It gives no range for the parameters (here 0 to twice the
//! target, so the sign is known beforehand). It gives no limit after which a source is abandoned
//! (here the usual sources × parameters). It does not define the fitness that determines the
//! onlookers' probabilities (here ranks are used).

use std::ops::ControlFlow;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use servoscope_core::answers::{ColonyOptions, ColonyVariant};
use servoscope_core::identify::bee_colony;

use super::super::system::System;
use super::{largest_error, targets};

/// Interpretation of the sum of the deviations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    /// As printed, Σ (P_actual − P_set). It has no minimum, so the search ends in a corner of the
    /// range.
    AsPrinted,
    /// With absolute values, which is presumably what is meant.
    Absolute,
}

impl Objective {
    /// Both objectives.
    pub const ALL: [Objective; 2] = [Objective::AsPrinted, Objective::Absolute];

    /// The objective in words.
    pub fn name(self) -> &'static str {
        match self {
            Objective::AsPrinted => "as printed",
            Objective::Absolute => "with absolute values",
        }
    }
}

/// Result of a colony.
#[derive(Debug, Clone, PartialEq)]
pub struct Colony {
    /// Largest relative error of a parameter.
    pub error: f64,
    /// Number of evaluations of the objective.
    pub evaluations: usize,
}

struct Distance {
    objective: Objective,
    targets: Vec<f64>,
}

impl Distance {
    /// Parameters at a point of the unit cube, which maps to 0 … twice the target.
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

/// Runs the paper's colony.
pub(super) fn run(system: System, objective: Objective, seed: u64) -> Colony {
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

    // 1010 evaluations with one dimension per step leave an error of percents, not the printed
    // 0.004 %.
    #[test]
    fn with_absolute_values_it_comes_near_the_targets_and_as_printed_to_a_corner() {
        for system in System::ALL {
            let errors = |objective| -> Vec<f64> {
                (1..=20).map(|seed| run(system, objective, seed).error).collect()
            };
            let near = median(&errors(Objective::Absolute));
            assert!((4e-5..0.2).contains(&near), "{near}");
            // Positive parameters go to the upper end and negative ones to 0: an error of 100 %.
            assert!(errors(Objective::AsPrinted).iter().all(|error| *error > 0.9));
        }
    }
}
