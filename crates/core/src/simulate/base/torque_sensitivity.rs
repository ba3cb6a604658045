//! First-order change of the response under a small additional torque.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use rustfft::{Fft, FftPlanner};

use crate::measurement::Complex;
use crate::plant::Plant;

use super::sensitivity::{Differentiable, Direction};
use super::settle;
use crate::effects::Axis;
use crate::simulate::response::{NoResponse, check};
use crate::simulate::signal::excitation::Excitation;

/// Fewest harmonics from which v(t) and θ(t) are reconstructed.
const FEWEST_HARMONICS: usize = 16;

/// A torque g(v, θ) that acts against the motion; θ has zero mean.
pub type Torque<'a> = dyn Fn(f64, f64) -> f64 + Sync + 'a;

/// The motion of the base model, to which small torques are added.
pub struct TorqueResponses<'a> {
    plant: Plant,
    excitation: &'a Excitation,
    /// With harmonics 0 … `highest`, or `FEWEST_HARMONICS`.
    motion: Differentiable<'a>,
    highest: usize,
    /// The change of the harmonics by a constant input of 1.
    by_offset: Vec<Complex>,
    /// The motion sampled, by the number of samples.
    sampled: Mutex<BTreeMap<usize, Arc<SampledMotion>>>,
}

/// A motion at equidistant times of a period.
struct SampledMotion {
    forward: Arc<dyn Fft<f64>>,
    /// v and θ.
    values: Vec<(f64, f64)>,
}

impl<'a> TorqueResponses<'a> {
    /// For velocity harmonics 0 … `highest`.
    ///
    /// # Errors
    /// See [`NoResponse`].
    pub fn new(
        plant: &Plant,
        excitation: &'a Excitation,
        highest: usize,
    ) -> Result<Self, NoResponse> {
        let axis = Axis::base(*plant);
        check(&axis)?;
        let motion = Differentiable::new(settle(&axis, excitation)?, highest.max(FEWEST_HARMONICS));
        let constant = Direction::of_input(plant, excitation, &[Complex::ONE]);
        let by_offset = motion.along(&[constant]).pop().unwrap_or_default();
        let sampled = Mutex::default();
        Ok(Self { plant: *plant, excitation, motion, highest, by_offset, sampled })
    }

    /// The first-order change of every velocity harmonic when one of `torques` is added to the base
    /// model, including the shift of the switching times. A constant torque is added that keeps the
    /// mean velocity unchanged. One row per torque.
    ///
    /// The motion is sampled at `samples` times of a period or more: more than twice the cycles of
    /// a torque.
    pub fn to(&self, torques: &[&Torque<'_>], samples: usize) -> Vec<Vec<Complex>> {
        let sampled = self.sampled(samples.next_power_of_two());
        let direction = |torque: &&Torque<'_>| {
            let deviation = self.deviation(&sampled, *torque);
            Direction::of_input(&self.plant, self.excitation, &deviation)
        };
        let directions: Vec<Direction> = torques.iter().map(direction).collect();
        let mut changes = self.motion.along(&directions);
        for change in &mut changes {
            change.truncate(self.highest + 1);
            if self.by_offset[0].re == 0.0 {
                continue;
            }
            let balance = change[0].re / self.by_offset[0].re;
            let both = change.iter_mut().zip(&self.by_offset);
            both.for_each(|(value, by_offset)| *value -= balance * by_offset);
        }
        changes
    }

    /// The lines of the input that act as a torque does.
    fn deviation(&self, sampled: &SampledMotion, torque: &Torque<'_>) -> Vec<Complex> {
        let value = |(v, position): &(f64, f64)| Complex::new(torque(*v, *position), 0.0);
        let mut values: Vec<Complex> = sampled.values.iter().map(value).collect();
        sampled.forward.process(&mut values);
        let samples = values.len();
        values.truncate(self.motion.velocity.len().min(samples / 2));
        for (k, value) in values.iter_mut().enumerate() {
            let weight = if k == 0 { 1.0 } else { 2.0 } / samples as f64;
            let omega = k as f64 * self.excitation.omega_rad_s();
            // As an input, a torque behind the actuator is divided by A(jkω).
            *value *= -weight / self.plant.actuator.response(omega);
        }
        values
    }

    fn sampled(&self, samples: usize) -> Arc<SampledMotion> {
        let mut sampled = self.sampled.lock().unwrap_or_else(PoisonError::into_inner);
        let of = || Arc::new(self.sample(samples));
        Arc::clone(sampled.entry(samples).or_insert_with(of))
    }

    fn sample(&self, samples: usize) -> SampledMotion {
        let j = Complex::new(0.0, 1.0);
        let mut lines = vec![Complex::ZERO; samples];
        lines[0] = Complex::new(self.motion.velocity[0].re, 0.0);
        for (k, v) in self.motion.velocity.iter().enumerate().take(samples / 2).skip(1) {
            // ∫ exp(jkωt) dt = exp(jkωt)/(jkω).
            let position = v / Complex::new(0.0, k as f64 * self.excitation.omega_rad_s());
            // One transform makes two real signals.
            lines[k] = 0.5 * (v + j * position);
            lines[samples - k] = 0.5 * (v.conj() + j * position.conj());
        }
        let mut planner = FftPlanner::new();
        planner.plan_fft_inverse(samples).process(&mut lines);
        let values = lines.into_iter().map(|both| (both.re, both.im)).collect();
        SampledMotion { forward: planner.plan_fft_forward(samples), values }
    }
}
