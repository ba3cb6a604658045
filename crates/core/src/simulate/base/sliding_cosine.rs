//! The response to a cosine of an axis that never rests, and its derivatives, in closed form.
//!
//! With zf = exp(−jωt_f) and zb = exp(−jωt_b) at the beginnings of the two slides, the harmonics of
//! the friction are Fₖ = (Fc⁺ + Fc⁻)/(jπk)·(zfᵏ − zbᵏ) (see `spectrum`). Only a, Fc⁺ and Fc⁻ need
//! the derivatives of the two phases. A turn of the torque shifts the response in time, and by
//! Euler's theorem on homogeneous functions, as Vₖ(|T|, Fc⁺, Fc⁻) is homogeneous of degree 1,
//! |T|·∂Vₖ/∂|T| = Vₖ − Fc⁺·∂Vₖ/∂Fc⁺ − Fc⁻·∂Vₖ/∂Fc⁻.

use std::f64::consts::{PI, TAU};

use crate::measurement::Complex;
use crate::plant::Plant;

use super::cosine;
use super::sensitivity::actuator_derivatives;
use super::two_slides::{Normalised, TwoSlides};
use crate::simulate::signal::excitation::Excitation;

/// A motion without rest under the torque Re T·exp(jωt).
pub(super) struct SlidingCosine {
    plant: Plant,
    omega: f64,
    torque: Complex,
    amplitude: f64,
    axis: Normalised,
    slides: TwoSlides,
}

impl SlidingCosine {
    /// `None` where the input is not a cosine, the axis rests, or static friction exceeds Coulomb
    /// friction.
    pub fn find(plant: &Plant, excitation: &Excitation) -> Option<Self> {
        if !excitation.is_pure_cosine() {
            return None;
        }
        let omega = excitation.omega_rad_s();
        let torque = excitation.input()[1] * plant.actuator.response(omega);
        let amplitude = torque.norm();
        let (axis, slides) = cosine::two_slides(plant, amplitude, omega)?;
        Some(Self { plant: *plant, omega, torque, amplitude, axis, slides })
    }

    /// V₀ … V_H.
    pub fn velocity(&self, highest: usize) -> Vec<Complex> {
        let friction = &self.plant.friction;
        let both = friction.fc_plus + friction.fc_minus;
        let forward = self.slides.forward.length;
        let mean = (friction.fc_plus * forward - friction.fc_minus * (TAU - forward)) / TAU;
        let [turn_f, turn_b] = self.turns();
        let [mut f, mut b] = [Complex::ONE; 2];
        (0..=highest)
            .map(|k| {
                let force = match k {
                    0 => Complex::new(-mean, 0.0),
                    1 => self.torque - times_minus_j(f - b) * (both / PI),
                    _ => -times_minus_j(f - b) * (both / (PI * k as f64)),
                };
                (f, b) = (f * turn_f, b * turn_b);
                force * self.compliance(k) * self.plant.constant
            })
            .collect()
    }

    /// Derivatives of `velocity` by a, Fc⁺, Fc⁻, Fs⁺, Fs⁻ and the parameters of the actuator, in the
    /// order of [`parameter_directions`](super::sensitivity::parameter_directions); empty where they
    /// are 0.
    pub fn sensitivities(
        &self,
        excitation: &Excitation,
        velocity: &[Complex],
    ) -> Vec<Vec<Complex>> {
        let by_mechanics = self.by_mechanics(velocity);
        let actuator = actuator_derivatives(&self.plant.actuator, excitation);
        let by_actuator: Vec<Vec<Complex>> =
            actuator.iter().map(|by| self.by_torque(by[1], velocity, &by_mechanics)).collect();
        let static_levels = [Vec::new(), Vec::new()];
        by_mechanics.into_iter().chain(static_levels).chain(by_actuator).collect()
    }

    /// By a, Fc⁺ and Fc⁻.
    fn by_mechanics(&self, velocity: &[Complex]) -> [Vec<Complex>; 3] {
        let Self { plant, axis, slides, .. } = self;
        let TwoSlides { forward, backward } = slides;
        let moves = [
            slides.solve(axis, slides.ends_by_alpha(axis)).map(|move_| -move_ / self.omega),
            slides.solve(axis, [forward.lost / axis.alpha / self.amplitude, 0.0]),
            slides.solve(axis, [0.0, -backward.lost / axis.alpha / self.amplitude]),
        ];
        let by_moves = -(plant.friction.fc_plus + plant.friction.fc_minus) / PI;
        let moves = moves.map(|moves| moves.map(|move_| by_moves * move_));
        let [turn_f, turn_b] = self.turns();
        let [mut f, mut b] = [Complex::ONE; 2];
        let mut rows = [(); 3].map(|()| Vec::with_capacity(velocity.len()));
        let share = forward.length / TAU;
        for (k, value) in velocity.iter().enumerate() {
            let compliance = self.compliance(k);
            // By Fc⁺ and Fc⁻ at fixed phases; half of the moves count for the mean.
            let (levels, weight) = match k {
                0 => ([share, share - 1.0].map(|share| Complex::new(share, 0.0)), 0.5),
                _ => ([times_minus_j(f - b) / (PI * k as f64); 2], 1.0),
            };
            let friction = moves.map(|[move_f, move_b]| (f * move_f - b * move_b) * weight);
            rows[0].push(-(friction[0] * plant.constant + value) * compliance);
            rows[1].push(-(friction[1] + levels[0]) * compliance * plant.constant);
            rows[2].push(-(friction[2] + levels[1]) * compliance * plant.constant);
            (f, b) = (f * turn_f, b * turn_b);
        }
        rows
    }

    /// Along a change of the torque, from those by a, Fc⁺ and Fc⁻.
    fn by_torque(
        &self,
        change: Complex,
        velocity: &[Complex],
        [_, by_plus, by_minus]: &[Vec<Complex>; 3],
    ) -> Vec<Complex> {
        let friction = &self.plant.friction;
        let change = change / self.torque;
        let by_friction = by_plus.iter().zip(by_minus);
        let terms = velocity.iter().zip(by_friction).enumerate();
        terms
            .map(|(k, (value, (plus, minus)))| {
                let by_levels = plus * friction.fc_plus + minus * friction.fc_minus;
                value * Complex::new(change.re, k as f64 * change.im) - by_levels * change.re
            })
            .collect()
    }

    /// zf and zb.
    fn turns(&self) -> [Complex; 2] {
        let direction = self.torque / self.amplitude;
        let TwoSlides { forward, backward } = &self.slides;
        [forward, backward].map(|slide| Complex::new(slide.cos, -slide.sin) * direction)
    }

    /// 1/(jkω + a).
    fn compliance(&self, k: usize) -> Complex {
        let (a, omega) = (self.plant.viscous_rate_rad_s, k as f64 * self.omega);
        Complex::new(a, -omega) / (a * a + omega * omega)
    }
}

fn times_minus_j(value: Complex) -> Complex {
    Complex::new(value.im, -value.re)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;
    use crate::effects::Axis;
    use crate::plant::{Actuator, Friction};
    use crate::simulate::base::sensitivity::{Differentiable, parameter_directions};
    use crate::simulate::base::{settle, spectrum};

    /// Axes of every order, at frequencies from far below to far above their pole.
    fn drawn() -> Vec<(Plant, Excitation)> {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let mut axis = |order: usize| {
            let mut within = |low: f64, high: f64| low * (high / low).powf(rng.random());
            let corner = within(10.0, 1000.0);
            let actuator = match order {
                0 => Actuator::Direct,
                1 => Actuator::FirstOrder { corner_rad_s: corner },
                _ => Actuator::SecondOrder {
                    natural_frequency_rad_s: corner,
                    damping_ratio: within(0.1, 1.0),
                },
            };
            let plant = Plant {
                viscous_rate_rad_s: within(0.5, 50.0),
                constant: within(0.01, 100.0),
                actuator,
                friction: Friction::coulomb(within(0.01, 0.6), within(0.01, 0.6)),
            };
            (plant, Excitation::cosine(within(1.0, 300.0), within(0.5, 5.0)))
        };
        (0..300).map(|i| axis(i % 3)).collect()
    }

    fn largest(values: &[Complex]) -> f64 {
        values.iter().map(|value| value.norm()).fold(0.0, f64::max)
    }

    // Both are closed forms; they differ by rounding, which close to rest Newton's method magnifies.
    #[test]
    fn response_and_derivatives_are_those_of_the_general_method() {
        let mut compared = 0;
        for (plant, excitation) in drawn() {
            let Some(sliding) = SlidingCosine::find(&plant, &excitation) else { continue };
            compared += 1;
            let settled = settle(&Axis::base(plant), &excitation).unwrap();
            let expected = spectrum::velocity(&settled, 9);
            let found = sliding.velocity(9);
            let near = |found: &[Complex], expected: &[Complex], scale: f64, what: &str| {
                for (found, expected) in found.iter().zip(expected) {
                    let off = (found - expected).norm() / scale;
                    assert!(off < 1e-9, "{what}: {off} {plant:?} {excitation:?}");
                }
            };
            near(&found, &expected, largest(&expected), "response");
            let directions = parameter_directions(&plant, &excitation);
            let rows = Differentiable::new(settled, 9).along(&directions);
            let closed = sliding.sensitivities(&excitation, &found);
            for (i, row) in rows.iter().enumerate() {
                let scale = largest(row).max(f64::MIN_POSITIVE);
                match closed.get(i).filter(|closed| !closed.is_empty()) {
                    Some(closed) => near(closed, row, scale, &format!("row {i}")),
                    None => assert_eq!(largest(row), 0.0, "row {i}"),
                }
            }
        }
        assert!(compared > 150, "{compared}");
    }

    #[test]
    fn an_axis_that_rests_or_whose_static_friction_is_higher_has_no_closed_form() {
        let plant = Plant {
            viscous_rate_rad_s: 10.0,
            constant: 10.0,
            actuator: Actuator::Direct,
            friction: Friction::coulomb(0.5, 0.4),
        };
        let found = |plant: &Plant, magnitude: f64| {
            SlidingCosine::find(plant, &Excitation::cosine(30.0, magnitude)).is_some()
        };
        assert!(found(&plant, 2.0));
        assert!(!found(&plant, 0.6), "rests between its slides");
        assert!(!found(&plant, 0.3), "never moves");
        let higher = Friction { fs_plus: 0.6, ..plant.friction };
        assert!(!found(&Plant { friction: higher, ..plant }, 2.0));
    }
}
