//! Mechanics from the measured motion and its input, whatever their course.

use nalgebra::{DMatrix, DVector};
use rustfft::FftPlanner;

use crate::identify::linear_least_squares;
use crate::identify::problem::{Prepared, Problem};
use crate::measurement::Complex;
use crate::plant::{Actuator, Friction, Plant};

/// Least squares for 1/K, a/K, Fc⁺ and Fc⁻ from the measured motion (inverse dynamics).
pub(super) fn inverse_dynamics(problem: &Problem, order: u8) -> Option<Plant> {
    let mut columns: Vec<[Complex; 5]> = Vec::new();
    for experiment in &problem.experiments {
        let omega = experiment.excitation.omega_rad_s();
        let velocity = velocity_lines(experiment);
        let (forward, backward) = directions(&velocity);
        for target in experiment.targets.iter().filter(|t| t.order > 0) {
            let k = target.order;
            let line = experiment.excitation.input().get(k).copied().unwrap_or_default();
            columns.push([
                Complex::new(0.0, k as f64 * omega) * velocity[k],
                velocity[k],
                forward[k],
                -backward[k],
                line,
            ]);
        }
        columns.push([
            Complex::default(),
            Complex::new(velocity[0].re, 0.0),
            Complex::new(forward[0].re, 0.0),
            Complex::new(-backward[0].re, 0.0),
            Complex::new(experiment.excitation.input()[0].re, 0.0),
        ]);
    }
    let mut rows = DMatrix::zeros(2 * columns.len(), 4);
    let mut right = DVector::zeros(2 * columns.len());
    for (r, row) in columns.iter().enumerate() {
        for c in 0..4 {
            rows[(2 * r, c)] = row[c].re;
            rows[(2 * r + 1, c)] = row[c].im;
        }
        right[2 * r] = row[4].re;
        right[2 * r + 1] = row[4].im;
    }
    let solution = linear_least_squares::solve(rows, &right)?;
    if solution[0] <= 0.0 {
        return None;
    }
    let high = problem.prior.omega_high;
    let actuator = match order {
        0 => Actuator::Direct,
        1 => Actuator::FirstOrder { corner_rad_s: 3.0 * high },
        _ => Actuator::SecondOrder { natural_frequency_rad_s: 3.0 * high, damping_ratio: 0.7 },
    };
    // A rate that the regression finds negative is a small one.
    let viscous_rate_rad_s = (solution[1] / solution[0]).max(problem.prior.omega_low / 10.0);
    Some(Plant {
        viscous_rate_rad_s,
        constant: 1.0 / solution[0],
        actuator,
        friction: Friction::coulomb(solution[2].max(0.0), solution[3].max(0.0)),
    })
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
