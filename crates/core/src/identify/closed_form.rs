//! Closed-form starting points, computed from the data without any search.
//!
//! For pure cosines: the describing function of Coulomb friction has gain 4F̄/π and the phase of
//! the velocity. For the fundamental this gives A(jω)·U = V/P(jω) + (4/π)·F̄·V/|V| (Chen, Huang,
//! Yen 2002, IEEE Trans. Control Systems Technology 10(5)). It is linear in 1/K, a/K and F̄ if A is
//! known, and two magnitudes at one frequency give F̄/A(jω) itself. Its accuracy is that of the
//! describing function: good for a start, never for a comparison of models.
//!
//! For general inputs: the measured harmonics give the motion, hence when the axis moves in which
//! direction, hence the harmonics S⁺ and S⁻ of the indicators of v > 0 and v < 0. Then Uₖ = (jkω +
//! a)·Vₖ/K + Fc⁺·Sₖ⁺ − Fc⁻·Sₖ⁻ is linear in 1/K, a/K, Fc⁺ and Fc⁻.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use rustfft::FftPlanner;

use crate::measurement::Complex;
use crate::plant::{Actuator, Friction, Plant};

use super::linear_least_squares;
use super::problem::{Prepared, Problem};

/// The fundamental of an experiment with a cosine input, in scale: ω, U₁, V₁ and the mean V₀ (if it
/// was measured).
struct Fundamental {
    omega: f64,
    input: Complex,
    velocity: Complex,
    mean: Option<f64>,
}

/// A starting plant, in scale; `None` if the data does not allow one.
pub(super) fn start(problem: &Problem, order: u8) -> Option<Plant> {
    let cosines = problem.experiments.iter().all(|e| e.excitation.is_pure_cosine());
    if !cosines {
        return inverse_dynamics(problem, order);
    }
    let fundamentals = moving_fundamentals(problem);
    let actuator = match order {
        0 => Actuator::Direct,
        _ => actuator_from_pairs(&fundamentals, order)?,
    };
    mechanics(&fundamentals, actuator)
}

/// Whether pure cosines move the axis at two magnitudes of one frequency.
pub(super) fn has_two_magnitudes(problem: &Problem) -> bool {
    let cosines = problem.experiments.iter().all(|e| e.excitation.is_pure_cosine());
    cosines && !magnitude_pairs(&moving_fundamentals(problem)).is_empty()
}

/// Pairs of fundamentals of one frequency whose magnitudes differ by more than a factor of e^0.2.
fn magnitude_pairs(fundamentals: &[Fundamental]) -> Vec<[&Fundamental; 2]> {
    let mut pairs = Vec::new();
    for (i, low) in fundamentals.iter().enumerate() {
        for high in &fundamentals[i + 1..] {
            let same = (low.omega / high.omega).ln().abs() < 1e-6;
            let apart = (low.input.norm() / high.input.norm()).ln().abs() > 0.2;
            if same && apart {
                pairs.push([low, high]);
            }
        }
    }
    pairs
}

/// The fundamentals of the experiments in which the axis clearly moves.
fn moving_fundamentals(problem: &Problem) -> Vec<Fundamental> {
    let of = |e: &Prepared| {
        let datum = |order: usize| e.targets.iter().find(|t| t.order == order && !t.constraint);
        let first = datum(1)?;
        Some(Fundamental {
            omega: e.excitation.omega_rad_s(),
            input: e.excitation.input()[1],
            velocity: first.value / first.per_velocity,
            mean: datum(0).map(|t| t.value.re),
        })
    };
    let all: Vec<Fundamental> = problem.experiments.iter().filter_map(of).collect();
    let gain = |f: &Fundamental| f.velocity.norm() / f.input.norm();
    // Keep gains above 0.3 of the largest one near that frequency (tuned). A cosine barely above
    // breakaway moves the axis for a small part of its period. Its gain is far below that of a
    // large one, and the describing function does not hold.
    let strongest = |omega: f64| {
        let near = all.iter().filter(|f| (f.omega / omega).ln().abs() < 0.2);
        near.map(gain).fold(0.0, f64::max)
    };
    let moving: Vec<bool> = all.iter().map(|f| gain(f) > 0.3 * strongest(f.omega)).collect();
    all.into_iter().zip(moving).filter(|(_, moves)| *moves).map(|(f, _)| f).collect()
}

/// Fits the actuator to D(ω) = F̄/A(jω), computed from pairs of magnitudes at one frequency.
fn actuator_from_pairs(fundamentals: &[Fundamental], order: u8) -> Option<Actuator> {
    let pairs = magnitude_pairs(fundamentals).into_iter();
    let inverse: Vec<(f64, Complex)> = pairs
        .map(|[low, high]| {
            let difference = low.input / low.velocity - high.input / high.velocity;
            let levels = 4.0 / PI * (1.0 / low.velocity.norm() - 1.0 / high.velocity.norm());
            (low.omega, difference / levels)
        })
        .collect();
    // Re D = F̄ − (F̄/ωₙ²)·ω² (order 2) or F̄ (order 1); Im D = (2ζF̄/ωₙ)·ω or (F̄/p)·ω.
    let columns = if order == 2 { 3 } else { 2 };
    if inverse.len() < 2 {
        return None;
    }
    let mut rows = DMatrix::zeros(2 * inverse.len(), columns);
    let mut right = DVector::zeros(2 * inverse.len());
    for (r, (omega, d)) in inverse.iter().enumerate() {
        let weight = 1.0 / d.norm();
        rows[(2 * r, 0)] = weight;
        rows[(2 * r + 1, 1)] = weight * omega;
        if order == 2 {
            rows[(2 * r, 2)] = -weight * omega * omega;
        }
        right[2 * r] = weight * d.re;
        right[2 * r + 1] = weight * d.im;
    }
    let solution = linear_least_squares::solve(rows, &right)?;
    let (level, slope) = (solution[0], solution[1]);
    if order == 1 {
        let corner_rad_s = level / slope;
        return (corner_rad_s > 0.0).then_some(Actuator::FirstOrder { corner_rad_s });
    }
    let square = level / solution[2];
    let natural_frequency_rad_s = (square > 0.0).then(|| square.sqrt())?;
    // The damping ratio is the least certain of the three: a value near or below zero means that it
    // is small.
    let damping_ratio = (0.5 * slope / level * natural_frequency_rad_s).clamp(0.02, 3.0);
    Some(Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio })
}

/// Least squares for 1/K, a/K and F̄ with a known actuator, from the describing function.
fn mechanics(fundamentals: &[Fundamental], actuator: Actuator) -> Option<Plant> {
    if fundamentals.len() < 2 {
        return None;
    }
    let mut rows = DMatrix::zeros(2 * fundamentals.len(), 3);
    let mut right = DVector::zeros(2 * fundamentals.len());
    for (r, f) in fundamentals.iter().enumerate() {
        let weight = 1.0 / f.input.norm();
        let torque = actuator.response(f.omega) * f.input;
        let columns = [
            Complex::new(0.0, f.omega) * f.velocity,
            f.velocity,
            4.0 / PI * f.velocity / f.velocity.norm(),
        ];
        for (c, column) in columns.iter().enumerate() {
            rows[(2 * r, c)] = weight * column.re;
            rows[(2 * r + 1, c)] = weight * column.im;
        }
        right[2 * r] = weight * torque.re;
        right[2 * r + 1] = weight * torque.im;
    }
    let solution = linear_least_squares::solve(rows, &right)?;
    let (inverse_constant, ratio, level) = (solution[0], solution[1], solution[2].max(0.0));
    if inverse_constant <= 0.0 || ratio <= 0.0 {
        return None;
    }
    // δ = (Fc⁺ − Fc⁻)/2 follows from the balance of the means: a·V₀/K = −(δ + F̄·share), where
    // share, the share of time spent moving forward less that moving backward, is (2/π)·V₀/|V₁|.
    let asymmetries: Vec<f64> = fundamentals
        .iter()
        .filter_map(|f| f.mean.map(|mean| -mean * (ratio + 2.0 / PI * level / f.velocity.norm())))
        .collect();
    let asymmetry = match asymmetries.len() {
        0 => 0.0,
        n => asymmetries.iter().sum::<f64>() / n as f64,
    };
    Some(Plant {
        viscous_rate_rad_s: ratio / inverse_constant,
        constant: 1.0 / inverse_constant,
        actuator,
        friction: Friction::coulomb((level + asymmetry).max(0.0), (level - asymmetry).max(0.0)),
    })
}

/// Least squares for 1/K, a/K, Fc⁺ and Fc⁻ from the measured motion (inverse dynamics).
fn inverse_dynamics(problem: &Problem, order: u8) -> Option<Plant> {
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

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, multisine, stepped_sine};
    use super::*;

    fn assert_near(found: &Plant, wanted: &Plant, tolerance: f64) {
        let pairs = [
            (found.viscous_rate_rad_s, wanted.viscous_rate_rad_s),
            (found.constant, wanted.constant),
            (found.friction.fc_plus, wanted.friction.fc_plus),
            (found.friction.fc_minus, wanted.friction.fc_minus),
        ];
        for (found, wanted) in pairs {
            assert!((found / wanted).ln().abs() < tolerance, "{found} {wanted}");
        }
    }

    // Describing functions err by 5 to 20 % in the fundamental at 4 friction levels. The pole is a
    // small difference of larger terms and errs by up to twice that.
    #[test]
    fn cosines_of_two_magnitudes_give_a_start_of_describing_function_accuracy() {
        for actuator in ACTUATORS {
            let plant = axis(actuator);
            let problem = Problem::new(&stepped_sine(&plant, 3)).unwrap();
            let found = problem.in_units(&start(&problem, actuator.order()).unwrap());
            assert_near(&found, &plant, 0.4);
            assert_eq!(found.actuator.order(), actuator.order());
        }
    }

    // The motion is computed from the 30 measured lines; higher ones are missing.
    #[test]
    fn a_multisine_gives_a_start_from_the_measured_motion() {
        let plant = axis(Actuator::Direct);
        let problem = Problem::new(&multisine(&plant)).unwrap();
        let found = problem.in_units(&start(&problem, 0).unwrap());
        assert_near(&found, &plant, 0.1);
    }

    #[test]
    fn one_magnitude_gives_no_start_for_an_unknown_actuator() {
        let plant = axis(ACTUATORS[1]);
        let all = stepped_sine(&plant, 3);
        let one = super::super::fixtures::joined(all.experiments()[..8].to_vec());
        let problem = Problem::new(&one).unwrap();
        assert!(start(&problem, 0).is_some());
        assert!(start(&problem, 1).is_none() && start(&problem, 2).is_none());
    }
}
