//! The paper as written: its equations one by one, each on its own, as far as they can be
//! followed to the letter. Nothing here is used by a method of the service.

mod colony;
mod network;
mod topology;

pub use colony::{Colony, Objective};
pub use network::{Network, Rule};
pub use topology::{SelfOscillation, Topology};

use super::system::System;

/// What the paper's own equations reach.
#[derive(Debug, Clone, PartialEq)]
pub struct AsWritten {
    /// Its colony, by system and objective.
    pub colonies: Vec<(System, Objective, Vec<Colony>)>,
    /// Its network, by system and rule, and learning rate.
    pub networks: Vec<(System, Rule, f64, Vec<Network>)>,
    /// Its figure 1 around the whole of G2.
    pub topology: Topology,
}

/// Ends of the range the paper gives for the learning rate.
const LEARNING_RATES: [f64; 2] = [0.2, 0.5];

/// Follows the paper's equations from every seed.
pub fn as_written(seeds: std::ops::RangeInclusive<u64>) -> AsWritten {
    let mut colonies = Vec::new();
    let mut networks = Vec::new();
    for system in System::ALL {
        for objective in Objective::ALL {
            let found = seeds.clone().map(|seed| colony::fly(system, objective, seed));
            colonies.push((system, objective, found.collect()));
        }
        for rule in Rule::ALL {
            for rate in LEARNING_RATES {
                let trained = seeds.clone().map(|seed| network::train(system, rule, rate, seed));
                networks.push((system, rule, rate, trained.collect()));
            }
        }
    }
    AsWritten { colonies, networks, topology: topology::measure() }
}

/// The targets of a system as the plain real numbers the paper's equations take: of a pair of
/// roots, real and imaginary part.
fn targets(system: System) -> Vec<f64> {
    let rows = system.targets();
    match system {
        System::G1 => rows.iter().map(|row| row.re).collect(),
        System::G2 => {
            let pair = [rows[0].re, rows[0].im];
            pair.into_iter().chain(rows[2..].iter().map(|row| row.re)).collect()
        }
    }
}

/// Largest relative deviation from the targets.
fn largest_error(found: &[f64], targets: &[f64]) -> f64 {
    let errors = found.iter().zip(targets).map(|(found, target)| (found / target - 1.0).abs());
    errors.fold(0.0, |worst, error| if error.is_nan() { f64::INFINITY } else { worst.max(error) })
}
