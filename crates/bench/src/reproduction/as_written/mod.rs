//! The paper's equations, implemented one by one and as literally as possible. No method of the
//! service uses this code.

mod colony;
mod network;
mod topology;

pub use colony::{Colony, Objective};
pub use network::{Network, Rule};
pub use topology::{SelfOscillation, Topology};

use super::system::System;

/// Results of the literal implementation.
#[derive(Debug, Clone, PartialEq)]
pub struct AsWritten {
    /// Results of the colony, by system and objective; one per seed.
    pub colonies: Vec<(System, Objective, Vec<Colony>)>,
    /// Results of the network, by system, rule and learning rate; one per seed.
    pub networks: Vec<(System, Rule, f64, Vec<Network>)>,
    /// The topology of Figure 1, with friction around the whole of G2.
    pub topology: Topology,
}

/// Ends of the range that the paper gives for the learning rate.
const LEARNING_RATES: [f64; 2] = [0.2, 0.5];

/// Runs the literal implementation with every seed.
pub fn as_written(seeds: std::ops::RangeInclusive<u64>) -> AsWritten {
    let mut colonies = Vec::new();
    let mut networks = Vec::new();
    for system in System::ALL {
        for objective in Objective::ALL {
            let found = seeds.clone().map(|seed| colony::run(system, objective, seed));
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

/// The targets of a system as real numbers, which the paper's equations need. A conjugate pair of
/// roots becomes a real and an imaginary part.
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

/// Largest relative deviation from the targets; infinite if one is NaN.
fn largest_error(found: &[f64], targets: &[f64]) -> f64 {
    let errors = found.iter().zip(targets).map(|(found, target)| (found / target - 1.0).abs());
    errors.fold(0.0, |worst, error| if error.is_nan() { f64::INFINITY } else { worst.max(error) })
}
