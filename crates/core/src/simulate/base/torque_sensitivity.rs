//! First-order change of the response under a small additional torque.

use std::f64::consts::TAU;

use crate::measurement::Complex;
use crate::plant::Plant;

use super::sensitivity;
use super::sensitivity::Direction;
use super::{settle, spectrum};
use crate::effects::Axis;
use crate::simulate::response::{NoResponse, check};
use crate::simulate::signal::excitation::Excitation;

/// Fewest harmonics from which v(t) and θ(t) are reconstructed.
const FEWEST_HARMONICS: usize = 16;

/// A torque g(v, θ) that acts against the motion; θ has zero mean.
pub type Torque<'a> = dyn Fn(f64, f64) -> f64 + Sync + 'a;

/// The first-order change of every velocity harmonic when one of `torques` is added to the base
/// model, including the shift of the switching times. A constant torque is added that keeps the
/// mean velocity unchanged. One row per torque.
///
/// `samples` of a period: more than twice the cycles of a torque.
///
/// # Errors
/// See [`NoResponse`].
pub fn respond_to_torques(
    plant: &Plant,
    excitation: &Excitation,
    highest: usize,
    torques: &[&Torque<'_>],
    samples: usize,
) -> Result<Vec<Vec<Complex>>, NoResponse> {
    let axis = Axis::base(*plant);
    check(&axis)?;
    let settled = settle(&axis, excitation)?;
    let velocity = spectrum::velocity(&settled, highest.max(FEWEST_HARMONICS));
    let turns: Vec<Complex> =
        (0..samples).map(|n| Complex::from_polar(1.0, TAU * n as f64 / samples as f64)).collect();
    // exp(jkωt) at every sample.
    let line = |k: usize| {
        let next = move |at: &usize| Some(if at + k < samples { at + k } else { at + k - samples });
        std::iter::successors(Some(0), next).take(samples).map(|at| turns[at])
    };
    let mut motion = vec![(velocity[0].re, 0.0); samples];
    for (k, v) in velocity.iter().enumerate().skip(1) {
        // ∫ exp(jkωt) dt = exp(jkωt)/(jkω).
        let by_rate = 1.0 / (k as f64 * excitation.omega_rad_s());
        for (at, turn) in motion.iter_mut().zip(line(k)) {
            let turned = v * turn;
            at.0 += turned.re;
            at.1 += turned.im * by_rate;
        }
    }
    let lines = highest.max(FEWEST_HARMONICS).min(samples / 2 - 1);
    let deviation = |torque: &&Torque<'_>| -> Vec<Complex> {
        let values: Vec<f64> = motion.iter().map(|(v, position)| torque(*v, *position)).collect();
        let component = |k: usize| {
            let sum: Complex = values.iter().zip(line(k)).map(|(g, turn)| turn.conj() * *g).sum();
            let weight = if k == 0 { 1.0 } else { 2.0 } / samples as f64;
            let omega = k as f64 * excitation.omega_rad_s();
            // As an input, a torque behind the actuator is divided by A(jkω).
            -sum * weight / plant.actuator.response(omega)
        };
        (0..=lines).map(component).collect()
    };
    let mut directions: Vec<Direction> = torques
        .iter()
        .map(|torque| Direction::of_input(plant, excitation, &deviation(torque)))
        .collect();
    directions.push(Direction::of_input(plant, excitation, &[Complex::ONE]));
    let mut changes = sensitivity::along(&settled, &velocity, &directions);
    let offset = changes.pop().expect("one a direction");
    for change in &mut changes {
        change.truncate(highest + 1);
        if offset[0].re == 0.0 {
            continue;
        }
        let balance = change[0].re / offset[0].re;
        change.iter_mut().zip(&offset).for_each(|(value, by_offset)| *value -= balance * by_offset);
    }
    Ok(changes)
}
