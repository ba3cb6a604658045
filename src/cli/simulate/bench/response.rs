//! The exact response of one experiment, with the constant input that holds a position.

use servoscope_core::measurement::{Complex, ResponseKind};
use servoscope_core::plant::{Friction, Plant};
use servoscope_core::simulate::{Excitation, respond};

use super::{Bench, BenchError};

/// Corrections of the input that holds a position.
const CORRECTIONS: usize = 40;

/// Mean velocity of a position that is held, as a share of the fundamental: what the simulation
/// of effects is accurate to.
const HELD: f64 = 1e-6;

impl Bench {
    /// Constant input, input units. An axis whose position is periodic does not
    /// drift: something holds its mean velocity at 0, and what that takes is
    /// the difference of the friction in the two directions.
    fn input_offset(&self) -> Result<f64, BenchError> {
        if self.response != ResponseKind::Position {
            return Ok(0.0);
        }
        let Friction { fc_plus, fc_minus, fs_plus, fs_minus } = self.plant.friction;
        let (plus, minus) = (fs_plus - fc_plus, fs_minus - fc_minus);
        // Rounding of the two differences.
        if (plus - minus).abs() > 1e-12 * fs_plus.max(fs_minus) {
            return Err(BenchError::Drifts { plus, minus });
        }
        Ok(0.5 * (fc_plus - fc_minus))
    }

    /// The constant input of one experiment and its Y₀ …, response units.
    pub(super) fn respond(
        &self,
        run_share: f64,
        magnitude: f64,
        omega_rad_s: f64,
    ) -> Result<(f64, Vec<Complex>), BenchError> {
        let (offset, mut harmonics) = if self.effects.is_empty() {
            let offset = self.input_offset()?;
            let axis = Plant { friction: shifted(self.plant.friction, offset), ..self.plant };
            let excitation = Excitation::cosine(omega_rad_s, magnitude);
            let harmonics = respond(&axis, &[], &excitation, self.harmonics)
                .map_err(|source| BenchError::NoResponse { magnitude, omega_rad_s, source })?;
            (offset, harmonics)
        } else {
            self.with_effects(run_share, magnitude, omega_rad_s)?
        };
        for (order, value) in harmonics.iter_mut().enumerate().skip(1) {
            let derivative = Complex::new(0.0, order as f64 * omega_rad_s);
            match self.response {
                ResponseKind::Velocity => {}
                ResponseKind::Position => *value /= derivative,
                ResponseKind::Acceleration => *value *= derivative,
            }
        }
        Ok((offset, harmonics))
    }

    /// The same of an axis with effects, as a velocity; where a position is measured, the
    /// constant input that holds it is found by the secant method.
    fn with_effects(
        &self,
        run_share: f64,
        magnitude: f64,
        omega_rad_s: f64,
    ) -> Result<(f64, Vec<Complex>), BenchError> {
        let velocity = |offset: f64| {
            let excitation = Excitation::new(omega_rad_s, input(offset, magnitude));
            respond(&self.plant, &self.effects, &excitation.at_run_share(run_share), self.harmonics)
                .map_err(|source| BenchError::NoResponse { magnitude, omega_rad_s, source })
        };
        let mut offset = 0.0;
        let mut harmonics = velocity(offset)?;
        if self.response != ResponseKind::Position {
            return Ok((offset, harmonics));
        }
        let Friction { fc_plus, fc_minus, .. } = self.plant.friction;
        let mut next = 0.5 * (fc_plus - fc_minus);
        if next == 0.0 {
            next = 1e-3 * magnitude;
        }
        for _ in 0..CORRECTIONS {
            if harmonics[0].norm() <= HELD * harmonics[1].norm() {
                return Ok((offset, harmonics));
            }
            let moved = velocity(next)?;
            let slope = (moved[0].re - harmonics[0].re) / (next - offset);
            (offset, harmonics) = (next, moved);
            next = offset - harmonics[0].re / slope;
            if !next.is_finite() {
                break;
            }
        }
        Err(BenchError::NotHeld { magnitude, omega_rad_s })
    }
}

/// A cosine beside a constant, as U₀, U₁.
pub(super) fn input(offset: f64, magnitude: f64) -> Vec<Complex> {
    vec![Complex::new(offset, 0.0), Complex::new(magnitude, 0.0)]
}

/// Friction as it acts beside a constant input: the same motion, without it.
fn shifted(friction: Friction, offset: f64) -> Friction {
    Friction {
        fc_plus: friction.fc_plus - offset,
        fc_minus: friction.fc_minus + offset,
        fs_plus: friction.fs_plus - offset,
        fs_minus: friction.fs_minus + offset,
    }
}

#[cfg(test)]
mod tests {
    use servoscope_bench::machines::simulator::{self, Effect, Machine, Settings};
    use servoscope_core::effects::{ActiveEffect, find};

    use super::super::tests::bench;
    use super::*;

    fn effect(id: &str, values: &[f64]) -> ActiveEffect {
        ActiveEffect::new(find(id).unwrap(), values.to_vec()).unwrap()
    }

    #[test]
    fn a_position_is_held_in_place_by_a_constant_input() {
        let bench = Bench { response: ResponseKind::Position, ..bench() };
        let measurement = bench.measure().unwrap().0;
        for experiment in measurement.experiments() {
            assert!((experiment.input[0].re - 0.05).abs() < 1e-15);
            assert!(experiment.input_mean_measured && experiment.harmonic(0).is_none());
            // The same axis under the same input, mean included.
            let velocity = respond(&bench.plant, &[], &Excitation::from(experiment), 1).unwrap();
            assert!(velocity[0].norm() < 1e-9, "{}", velocity[0]);
            let position = velocity[1] / Complex::new(0.0, experiment.omega_rad_s);
            // The interpolation of a general input.
            let miss = (position - experiment.harmonic(1).unwrap().value).norm();
            assert!(miss < 1e-6 * position.norm(), "{miss}");
        }
        let friction = Friction { fs_plus: 0.7, ..Friction::coulomb(0.5, 0.4) };
        let drifting = Bench { plant: Plant { friction, ..bench.plant }, ..bench };
        assert!(matches!(drifting.measure(), Err(BenchError::Drifts { .. })));
    }

    #[test]
    fn a_position_is_held_in_place_with_effects_too() {
        let effects = vec![effect("gain_asymmetry", &[0.1])];
        let bench = Bench { response: ResponseKind::Position, effects, ..bench() };
        let (measurement, left_out) = bench.measure().unwrap();
        assert!(left_out.is_empty());
        let machine = Machine {
            plant: bench.plant,
            effects: &[Effect::new("gain_asymmetry", [("gamma", 0.1)])],
        };
        for experiment in measurement.experiments() {
            let (omega, settings) = (experiment.omega_rad_s, Settings::default());
            let velocity =
                simulator::respond(&machine, 0.0, omega, &experiment.input, 1, &settings).unwrap();
            // The accuracy of the simulation, and of the correction.
            assert!(velocity[0].norm() <= 1e-5 * velocity[1].norm(), "{}", velocity[0]);
            let position = velocity[1] / Complex::new(0.0, omega);
            let miss = (position - experiment.harmonic(1).unwrap().value).norm();
            assert!(miss < 1e-5 * position.norm(), "{miss}");
        }
    }

    // A load on a hardly damped joint rattles in its gap without end; below breakaway it rests.
    #[test]
    fn a_point_without_a_response_of_its_period_is_left_out_and_named() {
        let joint = effect("backlash", &[0.5, 200.0, 0.1, 0.01]);
        let bench = Bench {
            effects: vec![joint],
            magnitudes: vec![0.2, 1.0],
            frequencies_rad_s: vec![20.0],
            ..bench()
        };
        let (measurement, left_out) = bench.measure().unwrap();
        assert_eq!((measurement.experiments().len(), left_out.len()), (1, 1));
        assert_eq!(measurement.experiments()[0].run, Some(0.0));
        assert!(left_out[0].to_string().contains("magnitude 1 at 20 rad/s"));
    }

    #[test]
    fn an_acceleration_is_the_derivative_of_the_velocity() {
        let velocity = bench().measure().unwrap().0;
        let measured =
            Bench { response: ResponseKind::Acceleration, ..bench() }.measure().unwrap().0;
        for (v, a) in velocity.experiments().iter().zip(measured.experiments()) {
            let expected = v.harmonic(3).unwrap().value * Complex::new(0.0, 3.0 * v.omega_rad_s);
            assert_eq!(a.harmonic(3).unwrap().value, expected);
            assert!(a.harmonic(0).is_none());
        }
    }
}
