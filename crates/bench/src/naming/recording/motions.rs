//! The motions that are recorded: multisines, and a trajectory in a position loop.

use servoscope_core::measurement::Complex;

use crate::machines::closed_loop::PositionLoop;
use crate::machines::draw::Draw;
use crate::machines::records::PeriodicMotion;
use crate::machines::simulator::{Effect, Machine, Settings, respond};

/// Lines of a multisine, and of the command in a position loop.
pub(super) const LINES: usize = 200;
/// Highest harmonic of the response that is simulated.
pub(super) const HARMONICS: usize = 300;
/// Ratio of the two levels.
const LEVEL_RATIO: f64 = 2.0;
/// Highest velocity of a trajectory, as a multiple of that at the lowest magnitude of a table, at
/// low frequency and without friction.
const TRAJECTORY_VELOCITY: f64 = 1.5;
/// Fundamental of a trajectory and bandwidth of its loop, as multiples of a.
const TRAJECTORY_RATES: [f64; 2] = [0.1, 2.0];

/// Every motion of a record, of the whole machine and, with the same input, of that without its
/// small effects.
pub(super) type Motions = Vec<[PeriodicMotion; 2]>;

/// The same multisine at one or two levels, its response up to a harmonic.
pub(super) fn multisines(
    machine: &Draw,
    dominant: usize,
    levels: usize,
    input: Vec<Complex>,
    harmonics: usize,
) -> Option<Motions> {
    let (_, band_rad_s) = *machine.design.last()?;
    let omega_rad_s = band_rad_s / LINES as f64;
    let level = |level: usize| {
        let factor = LEVEL_RATIO.powi(-(level as i32));
        let input: Vec<_> = input.iter().map(|line| factor * line).collect();
        let share = level as f64 / (levels - 1).max(1) as f64;
        let of = |effects: &[Effect]| {
            let machine = Machine { plant: machine.plant, effects };
            let settings = Settings::default();
            let response =
                respond(&machine, share, omega_rad_s, &input, harmonics, &settings).ok()?;
            Some(PeriodicMotion { omega_rad_s, input: input.clone(), response, mean_velocity: 0.0 })
        };
        Some([of(&machine.effects)?, of(&machine.effects[..dominant])?])
    };
    (0..levels).map(level).collect()
}

/// The trajectory as the whole machine follows it, and what its command does without the small
/// effects.
pub(super) fn trajectory(machine: &Draw, dominant: usize) -> Option<Motions> {
    let plant = machine.plant;
    let a = plant.viscous_rate_rad_s;
    let [omega, bandwidth] = TRAJECTORY_RATES;
    let lowest = machine.design.first()?.0;
    let position_loop = PositionLoop {
        omega_rad_s: omega * a,
        velocity: TRAJECTORY_VELOCITY * lowest * plant.constant / a,
        bandwidth_rad_s: bandwidth * a,
        lines: LINES,
        harmonics: HARMONICS,
    };
    let settings = Settings::default();
    let whole = Machine { plant, effects: &machine.effects };
    let motion = position_loop.motion(&whole, 0.0, &settings).ok()??;
    let without_small = Machine { plant, effects: &machine.effects[..dominant] };
    let PeriodicMotion { omega_rad_s, input, .. } = motion.clone();
    let response = respond(&without_small, 0.0, omega_rad_s, &input, HARMONICS, &settings).ok()?;
    let other = PeriodicMotion { omega_rad_s, input, response, mean_velocity: 0.0 };
    Some(positions(vec![[motion, other]]))
}

/// The same motions with their velocities as positions.
pub(super) fn positions(motions: Motions) -> Motions {
    motions.into_iter().map(|both| both.map(PeriodicMotion::converted_to_position)).collect()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::machines::records::multisine;
    use crate::naming::recording::fixtures::machine;

    #[test]
    fn two_levels_are_the_same_multisine_and_the_input_does_not_depend_on_small_effects() {
        let machine = machine();
        let input = multisine(LINES, 1.0, &mut ChaCha8Rng::seed_from_u64(1));
        let motions = multisines(&machine, 1, 2, input, HARMONICS).unwrap();
        let [[whole, dominant], [lower, _]] = &motions[..] else { panic!("two levels") };
        assert_eq!((whole.input.len(), &whole.input), (LINES + 1, &dominant.input));
        assert_ne!(whole.response, dominant.response);
        for (high, low) in whole.input.iter().zip(&lower.input) {
            assert_eq!(*low, high / LEVEL_RATIO);
        }
    }
}
