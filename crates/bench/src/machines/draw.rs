//! Draws random machines and experiment designs, and makes measurements of them.

mod measure;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

pub use super::noise::{NoiseStatement, noise_std, observe};
pub use measure::{DrawError, measure};

use super::simulator::Effect;
use crate::plant::{Actuator, Friction, Plant};

/// Number of magnitudes of a drawn design.
const MAGNITUDES: usize = 3;
/// Number of its frequencies at each magnitude.
const FREQUENCIES: usize = 16;

/// A machine and how it is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Draw {
    /// The base model of the machine.
    pub plant: Plant,
    /// Effects beyond the base model.
    pub effects: Vec<Effect>,
    /// Magnitude (input units) and fundamental (rad/s) of each experiment.
    pub design: Vec<(f64, f64)>,
    /// Highest harmonic measured.
    pub harmonics: usize,
    /// N of "N dB": re and im of every harmonic have a standard deviation of median|Y₁|·10^(−N/20),
    /// with the median over all experiments. `None`: no noise, and none stated.
    pub noise_db: Option<f64>,
    /// How the measurement states its noise.
    pub noise_statement: NoiseStatement,
}

/// Draws a machine whose actuator has the given order (0, 1 or 2), and a stepped-sine design for
/// it with a noise of 60 dB, stated as standard deviations.
///
/// | quantity | range |
/// | --- | --- |
/// | a | 2 … 50 1/s, log-uniform |
/// | K/a | 0.2 … 5 response units per input unit, log-uniform |
/// | (Fc⁺ + Fc⁻)/2 | 0.1 … 2 input units, log-uniform |
/// | Fc⁺ − Fc⁻ | ± 30 % of that, uniform |
/// | p, order 1 | 1 … 8 a, log-uniform |
/// | ωₙ, order 2 | 2 … 8 a, log-uniform |
/// | ζ, order 2 | 0.05 … 0.7, log-uniform |
/// | lowest magnitude | 1.9 … 2.6 times the larger Coulomb level, uniform; then × 2 and × 4 |
/// | frequencies | 16, log-spaced from 0.15 a to 10 a (2.5 ωₙ at order 2) |
///
/// The static level is the Coulomb level, harmonics are 0 to 7.
///
/// # Panics
/// If the order is above 2.
pub fn draw(actuator_order: u8, seed: u64) -> Draw {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let a = log_uniform(2.0, 50.0, rng);
    let constant = a * log_uniform(0.2, 5.0, rng);
    let level = log_uniform(0.1, 2.0, rng);
    let half_difference = 0.5 * level * rng.random_range(-0.3..=0.3);
    let friction = Friction::coulomb(level + half_difference, level - half_difference);
    let actuator = match actuator_order {
        0 => Actuator::Direct,
        1 => Actuator::FirstOrder { corner_rad_s: a * log_uniform(1.0, 8.0, rng) },
        2 => Actuator::SecondOrder {
            natural_frequency_rad_s: a * log_uniform(2.0, 8.0, rng),
            damping_ratio: log_uniform(0.05, 0.7, rng),
        },
        order => panic!("no actuator has order {order}"),
    };
    let highest_rad_s = match actuator {
        Actuator::SecondOrder { natural_frequency_rad_s, .. } => 2.5 * natural_frequency_rad_s,
        _ => 10.0 * a,
    };
    let lowest_rad_s = 0.15 * a;
    let lowest_magnitude = friction.fc_plus.max(friction.fc_minus) * rng.random_range(1.9..=2.6);
    let band_rad_s = [lowest_rad_s, highest_rad_s];
    let design = stepped_sine(lowest_magnitude, MAGNITUDES, band_rad_s, FREQUENCIES);
    Draw {
        plant: Plant { viscous_rate_rad_s: a, constant, actuator, friction },
        effects: Vec::new(),
        design,
        harmonics: 7,
        noise_db: Some(60.0),
        noise_statement: NoiseStatement::Std,
    }
}

/// A design of magnitudes that double, from the lowest one (input units), each at the same
/// frequencies (at least 2), log-spaced over a band (rad/s).
pub fn stepped_sine(
    lowest_magnitude: f64,
    magnitudes: usize,
    band_rad_s: [f64; 2],
    frequencies: usize,
) -> Vec<(f64, f64)> {
    let [lowest_rad_s, highest_rad_s] = band_rad_s;
    let at = |index: usize| {
        let share = index as f64 / (frequencies - 1) as f64;
        lowest_rad_s * (highest_rad_s / lowest_rad_s).powf(share)
    };
    let factors = (0..magnitudes).map(|index| 2.0_f64.powi(index as i32));
    factors
        .flat_map(|factor| (0..frequencies).map(move |i| (factor * lowest_magnitude, at(i))))
        .collect()
}

pub(crate) fn log_uniform(low: f64, high: f64, rng: &mut ChaCha8Rng) -> f64 {
    low * (high / low).powf(rng.random_range(0.0..=1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn machines_and_designs_lie_in_their_ranges() {
        for (order, seed) in (0..3).flat_map(|order| (0..40).map(move |seed| (order, seed))) {
            let Draw { plant, design, harmonics, .. } = draw(order, seed);
            let a = plant.viscous_rate_rad_s;
            assert!((2.0..=50.0).contains(&a));
            let friction = plant.friction;
            let (low, high) =
                (friction.fc_plus.min(friction.fc_minus), friction.fc_plus.max(friction.fc_minus));
            assert!(high - low <= 0.15 * (high + low) + 1e-12);
            assert_eq!(
                (friction.fs_plus, friction.fs_minus),
                (friction.fc_plus, friction.fc_minus)
            );
            assert_eq!((plant.actuator.order(), harmonics, design.len()), (order, 7, 48));
            let [first, last] = [design[0], design[47]];
            assert!((1.9..=2.6).contains(&(first.0 / high)));
            assert!((last.0 / first.0 - 4.0).abs() < 1e-12);
            assert!((first.1 / a - 0.15).abs() < 1e-12);
            let top = match plant.actuator {
                Actuator::SecondOrder { natural_frequency_rad_s: wn, .. } => 2.5 * wn,
                _ => 10.0 * a,
            };
            assert!((last.1 / top - 1.0).abs() < 1e-12);
        }
        assert_ne!(draw(0, 1), draw(0, 2));
    }
}
