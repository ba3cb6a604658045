//! Actuator and mechanics from the fundamentals of cosine experiments, by the describing function
//! of Coulomb friction.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

use crate::identify::linear_least_squares;
use crate::identify::problem::{Prepared, Problem};
use crate::measurement::Complex;
use crate::plant::{Actuator, Friction, Plant};

/// The fundamental of an experiment with a cosine input, in scale: ω, U₁, V₁ and the mean V₀ (if it
/// was measured).
pub(super) struct Fundamental {
    omega: f64,
    input: Complex,
    velocity: Complex,
    mean: Option<f64>,
}

/// Pairs of fundamentals of one frequency whose magnitudes differ by more than a factor of e^0.2.
pub(super) fn magnitude_pairs(fundamentals: &[Fundamental]) -> Vec<[&Fundamental; 2]> {
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
pub(super) fn moving_fundamentals(problem: &Problem) -> Vec<Fundamental> {
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
pub(super) fn actuator_from_pairs(fundamentals: &[Fundamental], order: u8) -> Option<Actuator> {
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
pub(super) fn mechanics(fundamentals: &[Fundamental], actuator: Actuator) -> Option<Plant> {
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
