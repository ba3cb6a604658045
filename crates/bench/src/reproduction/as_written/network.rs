//! The paper's network: equations 1 to 6.
//!
//! ```text
//!   yᵢ = w₁ᵢ/(1 + e^(−m₁)) + w₂ᵢ/(1 + e^(−m₂))   (4)      P_j = Σᵢ w_ij yᵢ            (3)
//!   E = P_target − P_out                          (2)      Δw = γ · P_out · E,  w ← w + Δw  (5, 6)
//! ```
//!
//! Its inputs are the two magnitudes. It has 20 hidden neurons and weights drawn from \[0, 1\], and
//! is trained until every |E| < 0.1.
//!
//! By equation 5 all weights into output j change by the same amount, so P_j follows the logistic
//! map P ← P + γ S P (T − P) with S = Σ yᵢ and the target T. Its fixed point P = T is stable only
//! if 0 < γ S T < 2. S is about 19 for the magnitudes used here, and the paper's γ is 0.2 to 0.5. A
//! negative target is never stable. Back-propagation has yᵢ in place of P_out ([`Rule::Gradient`]).
//! It is divided by Σ yᵢ² here (normalised rule of B. Widrow and M. Hoff), without which γ = 0.2
//! diverges, too.
//!
//! The paper leaves two details open. Equation 5 defines no error for the weights w₁ᵢ and w₂ᵢ, so
//! they stay as drawn (the text also sets them to 1). The data set of equation 1, from reference
//! \[2\], is not given, so the only sample is the target of the system.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::super::system::{MAGNITUDES, System};
use super::{largest_error, targets};

/// Number of hidden neurons, Table I.
const HIDDEN_NEURONS: usize = 20;

/// The paper stops training when every |E| is below this.
const CONVERGED_ERROR: f64 = 0.1;

/// Number of steps after which the training counts as not converging.
const MOST_STEPS: usize = 10_000;

/// Interpretation of equation 5.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// As printed.
    AsPrinted,
    /// With the input of the weight in place of the output.
    Gradient,
}

impl Rule {
    /// Both rules.
    pub const ALL: [Rule; 2] = [Rule::AsPrinted, Rule::Gradient];

    /// The rule in words.
    pub fn name(self) -> &'static str {
        match self {
            Rule::AsPrinted => "as printed",
            Rule::Gradient => "back-propagation, normalised",
        }
    }
}

/// Result of a training.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    /// Steps of equation 6.
    pub steps: usize,
    /// Whether every error fell below 0.1.
    pub converged: bool,
    /// Whether an output became infinite or NaN.
    pub overflowed: bool,
    /// Largest relative error of an output.
    pub error: f64,
}

/// Trains the paper's network on a system.
pub(super) fn train(system: System, rule: Rule, learning_rate: f64, seed: u64) -> Network {
    let targets = targets(system);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || rng.random_range(0.0..=1.0);
    let squash = MAGNITUDES.map(|m| 1.0 / (1.0 + (-m).exp()));
    let hidden: Vec<f64> =
        (0..HIDDEN_NEURONS).map(|_| draw() * squash[0] + draw() * squash[1]).collect();
    let mut weights: Vec<Vec<f64>> =
        targets.iter().map(|_| (0..HIDDEN_NEURONS).map(|_| draw()).collect()).collect();
    let power: f64 = hidden.iter().map(|y| y * y).sum();
    let mut steps = 0;
    loop {
        let outputs: Vec<f64> = weights
            .iter()
            .map(|weights| weights.iter().zip(&hidden).map(|(w, y)| w * y).sum())
            .collect();
        let errors: Vec<f64> = targets.iter().zip(&outputs).map(|(t, p)| t - p).collect();
        let converged = errors.iter().all(|error| error.abs() < CONVERGED_ERROR);
        let overflowed = outputs.iter().any(|output| !output.is_finite());
        if converged || overflowed || steps == MOST_STEPS {
            let error = largest_error(&outputs, &targets);
            return Network { steps, converged, overflowed, error };
        }
        for ((weights, output), error) in weights.iter_mut().zip(&outputs).zip(&errors) {
            for (weight, y) in weights.iter_mut().zip(&hidden) {
                *weight += match rule {
                    Rule::AsPrinted => learning_rate * output * error,
                    Rule::Gradient => learning_rate * error * y / power,
                };
            }
        }
        steps += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_printed_it_diverges_from_every_seed() {
        for (system, rate) in System::ALL.into_iter().flat_map(|s| [(s, 0.2), (s, 0.5)]) {
            for seed in 1..=20 {
                let network = train(system, Rule::AsPrinted, rate, seed);
                assert!(network.overflowed && network.steps < 100, "{network:?}");
            }
        }
    }

    // Each step multiplies the error by 1 − γ. From about 40 at most to 0.1 that takes
    // ln 400/−ln 0.8 = 27 steps.
    #[test]
    fn with_the_gradient_it_remembers_its_one_target_to_within_0_1() {
        for system in System::ALL {
            let network = train(system, Rule::Gradient, 0.2, 1);
            assert!(network.converged && network.steps < 35, "{network:?}");
            // An error of 0.1 is up to a quarter of Fc⁻ = 0.4.
            assert!(network.error < 0.25, "{network:?}");
        }
    }
}
