//! A test bench that is not there: the exact response, measured with noise.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use servoscope_bench::machines::draw::{NoiseStatement, noise_std, observe};
use servoscope_core::effects::ActiveEffect;
use servoscope_core::measurement::{
    Complex, Experiment, InvalidMeasurement, Measurement, Metadata, Quantity, ResponseKind,
};
use servoscope_core::plant::{Friction, Plant};
use servoscope_core::simulate::{Excitation, NoResponse, respond};

/// Corrections of the input that holds a position.
const CORRECTIONS: usize = 40;

/// Mean velocity of a position that is held, as a share of the fundamental: what the simulation
/// of effects is accurate to.
const HELD: f64 = 1e-6;

/// How noisy a measurement is: the standard deviation of re and im of every
/// harmonic, of re alone of harmonic 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Noise {
    /// Not at all.
    None,
    /// In response units.
    Std(f64),
    /// N for median|Y₁|·10^(−N/20), the median over all experiments.
    Decibels(f64),
}

/// An axis and how it is measured.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Bench {
    pub plant: Plant,
    /// What the axis has beyond it.
    pub effects: Vec<ActiveEffect>,
    /// Input units.
    pub magnitudes: Vec<f64>,
    /// Each measured at every magnitude.
    pub frequencies_rad_s: Vec<f64>,
    /// Highest harmonic.
    pub harmonics: usize,
    pub response: ResponseKind,
    pub input_unit: String,
    pub response_unit: String,
    pub noise: Noise,
    /// Repeats to write in place of the deviation; each scatters √M more.
    pub repeats: Option<usize>,
    pub seed: u64,
}

/// Why a bench gives no measurement.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(super) enum BenchError {
    #[error("magnitude {magnitude} at {omega_rad_s} rad/s: {source}")]
    NoResponse { magnitude: f64, omega_rad_s: f64, source: NoResponse },
    #[error(
        "magnitude {magnitude} at {omega_rad_s} rad/s: the mean position drifts, and no \
             constant input can hold it"
    )]
    NotHeld { magnitude: f64, omega_rad_s: f64 },
    #[error("no experiment has a response of its own period, the first of them: {first}")]
    Nothing { first: Box<BenchError> },
    #[error(
        "half of the experiments or more do not move, so --noise-db is relative to 0; raise \
         --magnitudes above the friction, {level}, or give --noise-std"
    )]
    Still { level: f64 },
    #[error(
        "a position is periodic only if the mean velocity is 0, which needs the same excess of \
         --fs over --fc in both directions, not {plus} and {minus}"
    )]
    Drifts { plus: f64, minus: f64 },
    #[error(transparent)]
    Invalid(#[from] InvalidMeasurement),
}

impl BenchError {
    /// Whether this experiment alone is without a response.
    fn concerns_one_point(&self) -> bool {
        matches!(
            self,
            BenchError::NotHeld { .. }
                | BenchError::NoResponse { source: NoResponse::NotPeriodic { .. }, .. }
                | BenchError::NoResponse { source: NoResponse::Endless, .. }
        )
    }
}

/// One experiment, simulated.
struct Point {
    magnitude: f64,
    omega_rad_s: f64,
    run: usize,
    /// Constant input, input units.
    offset: f64,
    /// Y₀ …, response units.
    response: Vec<Complex>,
}

impl Bench {
    /// Simulates every experiment and adds the noise. Beside the measurement, why an
    /// experiment without a periodic response is not in it.
    pub(super) fn measure(&self) -> Result<(Measurement, Vec<BenchError>), BenchError> {
        let design: Vec<(f64, f64)> = self
            .magnitudes
            .iter()
            .flat_map(|m| self.frequencies_rad_s.iter().map(move |omega| (*m, *omega)))
            .collect();
        let last_run = design.len().saturating_sub(1).max(1) as f64;
        let simulated: Vec<Result<Point, BenchError>> = design
            .par_iter()
            .enumerate()
            .map(|(run, &(magnitude, omega_rad_s))| {
                let share = run as f64 / last_run;
                let (offset, response) = self.respond(share, magnitude, omega_rad_s)?;
                Ok(Point { magnitude, omega_rad_s, run, offset, response })
            })
            .collect();
        let (mut points, mut left_out) = (Vec::new(), Vec::new());
        for point in simulated {
            match point {
                Ok(point) => points.push(point),
                Err(error) if error.concerns_one_point() => left_out.push(error),
                Err(error) => return Err(error),
            }
        }
        if points.is_empty() && !left_out.is_empty() {
            return Err(BenchError::Nothing { first: Box::new(left_out.swap_remove(0)) });
        }
        let responses: Vec<Vec<Complex>> =
            points.iter().map(|point| point.response.clone()).collect();
        let std = match self.noise {
            Noise::None => None,
            Noise::Std(std) => Some(std),
            Noise::Decibels(decibels) => {
                let Friction { fs_plus, fs_minus, .. } = self.plant.friction;
                let still = BenchError::Still { level: fs_plus.max(fs_minus) };
                Some(noise_std(&responses, decibels).ok_or(still)?)
            }
        };
        let statement = self.repeats.map_or(NoiseStatement::Std, NoiseStatement::Repeats);
        let rng = &mut ChaCha8Rng::seed_from_u64(self.seed);
        let experiments = points
            .iter()
            .map(|point| {
                let (mut response, mut repeats) = observe(&point.response, std, statement, rng);
                if self.response != ResponseKind::Velocity {
                    // The mean of a position or an acceleration says nothing.
                    response.remove(0);
                    for repeat in &mut repeats {
                        repeat.response.remove(0);
                    }
                }
                Experiment {
                    magnitude: point.magnitude,
                    omega_rad_s: point.omega_rad_s,
                    input: input(point.offset, point.magnitude),
                    input_mean_measured: point.offset != 0.0,
                    mean_velocity: 0.0,
                    rounding_std: 0.0,
                    open_samples: None,
                    response,
                    run: Some(point.run as f64),
                    repeats,
                    from_record: false,
                }
            })
            .collect();
        // No bytes were read, so there is nothing to take a digest of.
        let measurement =
            Measurement::new(self.metadata(), experiments, Vec::new(), String::new())?;
        Ok((measurement, left_out))
    }

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
    fn respond(
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

    fn metadata(&self) -> Metadata {
        let quantity = |name: &str, unit: &str| match unit {
            "" => Quantity::default(),
            unit => Quantity { name: name.to_owned(), unit: unit.to_owned() },
        };
        let response = match self.response {
            ResponseKind::Velocity => "velocity",
            ResponseKind::Position => "position",
            ResponseKind::Acceleration => "acceleration",
        };
        Metadata {
            name: Some("simulated axis".into()),
            input: quantity("command", &self.input_unit),
            response: quantity(response, &self.response_unit),
            response_kind: self.response,
            ..Metadata::default()
        }
    }
}

/// A cosine beside a constant, as U₀, U₁.
fn input(offset: f64, magnitude: f64) -> Vec<Complex> {
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
    use servoscope_core::effects::find;
    use servoscope_core::plant::Actuator;

    use super::*;

    fn effect(id: &str, values: &[f64]) -> ActiveEffect {
        ActiveEffect::new(find(id).unwrap(), values.to_vec()).unwrap()
    }

    fn bench() -> Bench {
        Bench {
            plant: Plant {
                viscous_rate_rad_s: 10.0,
                constant: 10.0,
                actuator: Actuator::Direct,
                friction: Friction::coulomb(0.5, 0.4),
            },
            effects: Vec::new(),
            magnitudes: vec![1.0, 2.0, 4.0],
            frequencies_rad_s: vec![1.0, 3.0, 10.0, 30.0, 100.0],
            harmonics: 7,
            response: ResponseKind::Velocity,
            input_unit: String::new(),
            response_unit: String::new(),
            noise: Noise::None,
            repeats: None,
            seed: 1,
        }
    }

    fn noise(noisy: &Bench) -> Vec<f64> {
        let exact =
            Bench { noise: Noise::None, repeats: None, ..noisy.clone() }.measure().unwrap().0;
        let noisy = noisy.measure().unwrap().0;
        let pairs = noisy.experiments().iter().zip(exact.experiments());
        pairs
            .flat_map(|(noisy, exact)| noisy.response.iter().zip(&exact.response))
            .flat_map(|(noisy, exact)| {
                let difference = noisy.value - exact.value;
                let im = (noisy.order > 0).then_some(difference.im);
                [Some(difference.re), im].into_iter().flatten()
            })
            .collect()
    }

    #[test]
    fn noise_is_as_stated_and_told_by_deviations_or_by_repeats() {
        for repeats in [None, Some(6)] {
            let bench = Bench { noise: Noise::Std(0.01), repeats, ..bench() };
            let values = noise(&bench);
            let rms = (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt();
            // The rms of n normals is known to 1/√(2n); four of that.
            let margin = 4.0 / (2.0 * values.len() as f64).sqrt();
            assert!((rms / 0.01 - 1.0).abs() < margin, "{rms} with {repeats:?} repeats");
            for experiment in bench.measure().unwrap().0.experiments() {
                assert_eq!(experiment.repeats.len(), repeats.unwrap_or(0));
                assert_eq!(experiment.std_given(), repeats.is_none());
            }
        }
    }

    #[test]
    fn decibels_are_below_the_median_fundamental_of_the_response_as_measured() {
        for response in [ResponseKind::Velocity, ResponseKind::Position] {
            let bench = Bench { response, ..bench() };
            let exact = bench.measure().unwrap().0;
            let mut sizes: Vec<f64> =
                exact.experiments().iter().map(|e| e.harmonic(1).unwrap().value.norm()).collect();
            sizes.sort_by(f64::total_cmp);
            let noisy = Bench { noise: Noise::Decibels(40.0), ..bench }.measure().unwrap().0;
            let std = noisy.experiments()[0].response[0].std.unwrap();
            assert!((std / (0.01 * sizes[7]) - 1.0).abs() < 1e-12, "{std}");
        }
    }

    #[test]
    fn decibels_below_nothing_are_refused() {
        let still = Bench { magnitudes: vec![0.1, 0.2], noise: Noise::Decibels(60.0), ..bench() };
        assert_eq!(still.measure().unwrap_err(), BenchError::Still { level: 0.5 });
        assert!(Bench { noise: Noise::None, ..still }.measure().is_ok());
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

    #[test]
    fn the_same_seed_gives_the_same_measurement_and_another_one_does_not() {
        let bench = Bench { noise: Noise::Decibels(60.0), ..bench() };
        assert_eq!(bench.measure(), bench.measure());
        assert_ne!(bench.measure(), Bench { seed: 2, ..bench.clone() }.measure());
    }
}
