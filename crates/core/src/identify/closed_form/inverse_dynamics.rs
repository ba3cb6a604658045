//! Mechanics from the measured motion and its input, whatever their course.

use std::iter;

use nalgebra::DMatrix;
use rustfft::FftPlanner;

use crate::identify::linear_least_squares::Decomposed;
use crate::identify::parameters::Prior;
use crate::identify::problem::{Prepared, Problem};
use crate::measurement::Complex;
use crate::plant::{Actuator, Friction, Plant};

/// Actuators for which equations are solved at once.
const AT_ONCE: usize = 64;
/// Range of their frequencies beyond that of the data, as a factor on either side.
const BEYOND: f64 = 3.0;
/// Ratio of neighbouring corner frequencies.
const CORNER_RATIO: f64 = 1.2;
/// Damping ratios. Neighbouring natural frequencies differ by as much: that is half the width of a
/// resonance at half its power.
const DAMPING_RATIOS: [f64; 4] = [0.03, 0.1, 0.3, 1.0];

/// One line of an experiment.
struct Line {
    omega_rad_s: f64,
    /// jω·V, V, S⁺ and −S⁻.
    columns: [Complex; 4],
    input: Complex,
}

/// Least squares for 1/K, a/K, Fc⁺ and Fc⁻ from the measured motion (inverse dynamics), beside each of
/// these actuators. The best is that of which the velocities err least.
pub(super) fn inverse_dynamics(problem: &Problem, actuators: &[Actuator]) -> Option<Plant> {
    let lines: Vec<Line> = problem.experiments.iter().flat_map(lines).collect();
    let part = |value: Complex, row: usize| [value.re, value.im][row % 2];
    let height = 2 * lines.len();
    let rows = DMatrix::from_fn(height, 4, |r, c| part(lines[r / 2].columns[c], r));
    let decomposed = Decomposed::of(rows.clone())?;
    let mut best: Option<(f64, Plant)> = None;
    for actuators in actuators.chunks(AT_ONCE) {
        let right = DMatrix::from_fn(height, actuators.len(), |r, c| {
            let Line { omega_rad_s, input, .. } = lines[r / 2];
            part(actuators[c].response(omega_rad_s) * input, r)
        });
        let solutions = decomposed.solve(&right)?;
        let left = right - &rows * &solutions;
        for (c, actuator) in actuators.iter().enumerate() {
            let [inertia, viscous, forward, backward] = [0, 1, 2, 3].map(|i| solutions[(i, c)]);
            if inertia <= 0.0 {
                continue;
            }
            let oscillating = lines.iter().enumerate().filter(|(_, line)| line.omega_rad_s > 0.0);
            let errors = oscillating.map(|(l, line)| {
                let torque = Complex::new(left[(2 * l, c)], left[(2 * l + 1, c)]);
                (torque / Complex::new(viscous, inertia * line.omega_rad_s)).norm_sqr()
            });
            let error: f64 = errors.sum();
            if best.as_ref().is_none_or(|(least, _)| error < *least) {
                // A rate that the regression finds negative is a small one.
                let smallest_rate = problem.prior.omega_low / 10.0;
                let plant = Plant {
                    viscous_rate_rad_s: (viscous / inertia).max(smallest_rate),
                    constant: 1.0 / inertia,
                    actuator: *actuator,
                    friction: Friction::coulomb(forward.max(0.0), backward.max(0.0)),
                };
                best = Some((error, plant));
            }
        }
    }
    best.map(|(_, plant)| plant)
}

/// An actuator of an order that is too fast for much of it to be seen.
pub(super) fn fast(order: u8, prior: &Prior) -> Actuator {
    let fast = prior.omega_high * BEYOND;
    match order {
        0 => Actuator::Direct,
        1 => Actuator::FirstOrder { corner_rad_s: fast },
        _ => Actuator::SecondOrder { natural_frequency_rad_s: fast, damping_ratio: 0.7 },
    }
}

/// Actuators of an order over the whole band.
pub(super) fn over_the_band(order: u8, prior: &Prior) -> Vec<Actuator> {
    let [low, high] = [prior.omega_low / BEYOND, prior.omega_high * BEYOND];
    let up = |ratio: f64| {
        iter::successors(Some(high), move |omega| Some(omega / ratio))
            .take_while(move |omega| *omega > low)
    };
    match order {
        0 => vec![Actuator::Direct],
        1 => up(CORNER_RATIO).map(|corner_rad_s| Actuator::FirstOrder { corner_rad_s }).collect(),
        _ => {
            let of_damping = |damping_ratio: f64| {
                up(1.0 + damping_ratio).map(move |natural_frequency_rad_s| Actuator::SecondOrder {
                    natural_frequency_rad_s,
                    damping_ratio,
                })
            };
            DAMPING_RATIOS.into_iter().flat_map(of_damping).collect()
        }
    }
}

/// The lines of an experiment, its means the last.
fn lines(experiment: &Prepared) -> Vec<Line> {
    let omega = experiment.excitation.omega_rad_s();
    let velocity = velocity_lines(experiment);
    let (forward, backward) = directions(&velocity);
    let input = experiment.excitation.input();
    let oscillating = experiment.targets.iter().filter(|target| target.order > 0);
    let mut lines: Vec<Line> = oscillating
        .map(|target| {
            let k = target.order;
            let omega_rad_s = k as f64 * omega;
            let acceleration = Complex::new(0.0, omega_rad_s) * velocity[k];
            Line {
                omega_rad_s,
                columns: [acceleration, velocity[k], forward[k], -backward[k]],
                input: input.get(k).copied().unwrap_or_default(),
            }
        })
        .collect();
    let real = |value: Complex| Complex::new(value.re, 0.0);
    let means = [Complex::default(), velocity[0], forward[0], -backward[0]].map(real);
    lines.push(Line { omega_rad_s: 0.0, columns: means, input: real(input[0]) });
    lines
}

/// Measured V₀ … V_H; harmonics that were not measured are 0.
fn velocity_lines(experiment: &Prepared) -> Vec<Complex> {
    let mut lines = vec![Complex::default(); experiment.highest + 1];
    for target in &experiment.targets {
        lines[target.order] = target.value / target.per_velocity;
    }
    lines
}

/// Harmonics of the indicators of v > 0 and v < 0.
fn directions(velocity: &[Complex]) -> (Vec<Complex>, Vec<Complex>) {
    let samples = (8 * velocity.len()).next_power_of_two();
    let mut planner = FftPlanner::new();
    let mut signal = vec![Complex::default(); samples];
    signal[0] = Complex::new(velocity[0].re, 0.0);
    for (k, line) in velocity.iter().enumerate().skip(1) {
        signal[k] = 0.5 * line;
        signal[samples - k] = 0.5 * line.conj();
    }
    planner.plan_fft_inverse(samples).process(&mut signal);
    // One transform of forward + j·backward gives the harmonics of both.
    for value in &mut signal {
        let forward = f64::from(u8::from(value.re > 0.0));
        *value = Complex::new(forward, 1.0 - forward);
    }
    planner.plan_fft_forward(samples).process(&mut signal);
    let scale = |k: usize| if k == 0 { 1.0 } else { 2.0 } / samples as f64;
    let mirrored = |k: usize| signal[(samples - k) % samples].conj();
    let forward = (0..velocity.len()).map(|k| 0.5 * (signal[k] + mirrored(k)) * scale(k));
    let minus_j = Complex::new(0.0, -1.0);
    let backward =
        (0..velocity.len()).map(|k| 0.5 * minus_j * (signal[k] - mirrored(k)) * scale(k));
    (forward.collect(), backward.collect())
}
