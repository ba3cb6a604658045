//! Noise of an input that is measured, as the response passes it on.
//!
//! What disturbs only the sensor of the input moves the simulated response and not the measured one.
//! An integrator makes that largest at the lowest lines, where each line has few neighbours to estimate
//! its variance from. It also is alike at neighbouring lines: an axis that rests passes nothing on, so
//! that the noise is modulated with the phases of rest. Variances and correlations therefore follow from
//! the model's response to noise of the input, whose own variance many lines tell.
//!
//! The covariance is C = J·diag(s²)·Jᵀ with J the first-order change of the response along the periodic
//! motion (`simulate::respond_to_deviations`) and s² the variance of each line of the input.

use nalgebra::DMatrix;

use super::input_spectrum::input_variances;
use crate::identify::correlated::{Correlation, Row};
use crate::identify::problem::{Prepared, Problem, Target};
use crate::measurement::{Complex, Experiment};
use crate::plant::Plant;
use crate::simulate;

/// Highest line whose correlation is computed. Effects show at low lines, and at high ones most noise is
/// of the response itself.
const HIGHEST_CORRELATED: usize = 64;
/// Smallest share of the variance of the input's deviations, as the response passes them on, that must
/// be noise of its sensor.
const LEAST_SHARE: f64 = 0.05;

/// What noise of the input adds to the targets of an experiment, in a single repeat.
pub(super) struct OfInput {
    /// Variance of re and of im each, by target.
    pub variances: Vec<f64>,
    rows: Vec<Row>,
    /// Covariance of the rows of the lowest targets.
    covariance: DMatrix<f64>,
}

impl OfInput {
    /// That of an experiment whose response deviates by `measured` from repeat to repeat where the
    /// deviations of the input would cause `explained`, both by repeat and target. `None` if the axis
    /// really follows what the input deviates by, or has no response.
    pub fn of(
        experiment: &Experiment,
        (prepared, problem): (&Prepared, &Problem),
        plant: &Plant,
        [measured, explained]: [&[Vec<Complex>]; 2],
    ) -> Option<Self> {
        let share =
            (1.0 - followed(&prepared.targets, measured, explained)).clamp(0.0, 1.0).powi(2);
        if share < LEAST_SHARE {
            return None;
        }
        let variances = input_variances(experiment, problem.scales.input)?;
        let low: Vec<&Target> =
            prepared.targets.iter().take_while(|t| t.order <= HIGHEST_CORRELATED).collect();
        let changes = changes(prepared, plant, &variances)?;
        let parts = low.iter().flat_map(|t| Row::of(t).map(move |row| (*t, row)));
        let parts: Vec<(&Target, Row)> = parts.collect();
        let jacobian = DMatrix::from_fn(parts.len(), changes.len(), |i, j| {
            let (target, row) = parts[i];
            let change = changes[j][target.order] * target.per_velocity;
            if row.imaginary { change.im } else { change.re }
        });
        let covariance = share * &jacobian * jacobian.transpose();
        let linear = |t: &Target| {
            let omega = t.order as f64 * prepared.excitation.omega_rad_s();
            let gain = plant.actuator.response(omega) * plant.mechanics_response(omega);
            let of_line = variances.get(t.order).copied().unwrap_or(0.0);
            share * (gain * t.per_velocity).norm_sqr() * of_line
        };
        let mut row = 0;
        let variance = |t: &Target| {
            if t.order > HIGHEST_CORRELATED {
                return linear(t);
            }
            let count = Row::of(t).count();
            row += count;
            (row - count..row).map(|i| covariance[(i, i)]).sum::<f64>() / count as f64
        };
        Some(Self {
            variances: prepared.targets.iter().map(variance).collect(),
            rows: parts.into_iter().map(|(_, row)| row).collect(),
            covariance,
        })
    }

    /// The correlation of the lowest targets, given the whole variance of each in a single repeat.
    pub fn correlation(&self, prepared: &Prepared, whole: &[f64]) -> Correlation {
        let by_row = prepared.targets.iter().zip(whole);
        let by_row = by_row.flat_map(|(t, whole)| Row::of(t).map(move |_| *whole));
        // What the input passes on cannot be more than the whole.
        let std: Vec<f64> = by_row
            .zip(self.covariance.diagonal().iter())
            .map(|(whole, own)| whole.max(*own).sqrt().max(f64::MIN_POSITIVE))
            .collect();
        let size = self.rows.len();
        let matrix = DMatrix::from_fn(size, size, |i, j| match i == j {
            true => 1.0,
            false => self.covariance[(i, j)] / (std[i] * std[j]),
        });
        Correlation { rows: self.rows.clone(), matrix }
    }
}

/// The share of the input's deviations that the response follows, by weighted least squares over all
/// data: 1 if they are real, 0 if they are noise of the sensor.
fn followed(targets: &[Target], measured: &[Vec<Complex>], explained: &[Vec<Complex>]) -> f64 {
    let (mut along, mut square) = (0.0, 0.0);
    // The mean velocity of a position is none, whatever the input does.
    for (t, _) in targets.iter().enumerate().filter(|(_, target)| !target.constraint) {
        let pairs = || measured.iter().zip(explained).map(|(m, e)| (m[t], e[t]));
        let size: f64 = pairs().map(|(m, e)| m.norm_sqr() + e.norm_sqr()).sum();
        if size > 0.0 {
            along += pairs().map(|(m, e)| (m * e.conj()).re).sum::<f64>() / size;
            square += pairs().map(|(_, e)| e.norm_sqr()).sum::<f64>() / size;
        }
    }
    if square > 0.0 { along / square } else { 1.0 }
}

/// The changes of the velocity when each part of each line of the input changes by a standard deviation.
/// Lines up to twice the highest whose correlation counts are enough: those far away from a line hardly
/// reach it.
fn changes(prepared: &Prepared, plant: &Plant, variances: &[f64]) -> Option<Vec<Vec<Complex>>> {
    let lines = variances.len().min(2 * HIGHEST_CORRELATED + 1);
    let of_line = |k: usize| {
        let parts: &[Complex] = if k == 0 { &[Complex::ONE] } else { &[Complex::ONE, Complex::I] };
        parts.iter().map(move |part| {
            let mut change = vec![Complex::ZERO; lines];
            change[k] = part * variances[k].sqrt();
            change
        })
    };
    let rows: Vec<Vec<Complex>> = (0..lines).flat_map(of_line).collect();
    let rows: Vec<&[Complex]> = rows.iter().map(Vec::as_slice).collect();
    let highest = prepared.highest.min(HIGHEST_CORRELATED);
    simulate::respond_to_deviations(plant, &[], &prepared.excitation, highest, &rows).ok()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::identify::noise::scatter::explained_by_input;
    use crate::machines::closed_loop::PositionLoop;
    use crate::machines::records::{PeriodicMotion, RecordNoise, Sampling};
    use crate::machines::simulator::{Machine, Settings, respond};
    use crate::measurement::{Measurement, Metadata, Repeat, ResponseKind};
    use crate::plant::{Actuator, Friction};

    const LINES: usize = 60;
    const NOISE: f64 = 2e-3;
    const REPEATS: usize = 400;

    fn plant() -> Plant {
        Plant {
            viscous_rate_rad_s: 8.0,
            constant: 8.0,
            actuator: Actuator::Direct,
            friction: Friction::coulomb(0.8, 0.8),
        }
    }

    /// A trajectory with phases of rest. White noise is added to its input in every repeat, and an
    /// independent simulator follows it.
    fn recorded() -> Measurement {
        let rng = &mut ChaCha8Rng::seed_from_u64(4);
        let machine = Machine { plant: plant(), effects: &[] };
        let position_loop = PositionLoop {
            omega_rad_s: 0.8,
            velocity: 2.0,
            bandwidth_rad_s: 16.0,
            lines: LINES,
            harmonics: LINES,
        };
        let settings = Settings::default();
        let velocity = position_loop.motion(&machine, 0.0, &settings).unwrap().unwrap();
        let mut normal = || Distribution::<f64>::sample(&StandardNormal, rng);
        let mut deviation = || -> Vec<Complex> {
            let lines = (0..=LINES).map(|k| match k {
                0 => Complex::new(0.5_f64.sqrt() * NOISE * normal(), 0.0),
                _ => NOISE * Complex::new(normal(), normal()),
            });
            lines.collect()
        };
        let deviations: Vec<Vec<Complex>> = (0..REPEATS).map(|_| deviation()).collect();
        let repeat = |input: Vec<Complex>| {
            let moved: Vec<Complex> =
                velocity.input.iter().zip(&input).map(|(u, d)| u + d).collect();
            let (omega, highest) = (velocity.omega_rad_s, LINES);
            let moved = respond(&machine, 0.0, omega, &moved, highest, &settings).unwrap();
            let of = |(k, (after, before)): (usize, (&Complex, &Complex))| {
                (after - before) / Complex::new(0.0, k as f64 * omega)
            };
            let change = moved.iter().zip(&velocity.response).enumerate().skip(1).map(of);
            Repeat { input, response: change.collect() }
        };
        let repeats = deviations.into_iter().map(repeat).collect();
        let kind = ResponseKind::Position;
        let noise = RecordNoise { input: 0.0, response: 1e-9, step: 0.0 };
        let sampling = Sampling { samples: 512, periods: 2 };
        let motion: PeriodicMotion = velocity.clone().converted_to_position();
        let mut experiment = motion.exact(kind, LINES, &noise, sampling, 0.0, |_| 0.0);
        experiment.repeats = repeats;
        let metadata = Metadata { response_kind: kind, ..Metadata::default() };
        Measurement::new(metadata, vec![experiment], Vec::new(), String::new()).unwrap()
    }

    /// What noise of the input makes of the targets, given what of the deviations is measured.
    fn of_input(measurement: &Measurement, follows: bool) -> (Problem, Option<OfInput>) {
        let problem = Problem::new(measurement).unwrap();
        let (experiment, prepared) = (&measurement.experiments()[0], &problem.experiments[0]);
        let plant = problem.in_scale(&plant());
        let explained = explained_by_input(experiment, prepared, &problem, Some(&plant));
        let share = if follows { 1.0 } else { 0.0 };
        let of = |repeat: &Repeat| {
            let constraint = [Complex::ZERO];
            let values = repeat.response.iter().map(|value| share * value / problem.response_scale);
            constraint.into_iter().chain(values).collect()
        };
        let measured: Vec<Vec<Complex>> = experiment.repeats.iter().map(of).collect();
        let of_input =
            OfInput::of(experiment, (prepared, &problem), &plant, [&measured, &explained]);
        (problem, of_input)
    }

    // Of 400 repeats a variance has a standard error of 5 to 7 %, and a correlation one of 5 %. Four of
    // them; products of the noise's two parts add less than that.
    #[test]
    fn noise_of_the_input_has_the_variances_and_correlations_of_an_independent_simulator() {
        let measurement = recorded();
        let (problem, of_input) = of_input(&measurement, false);
        let of_input = of_input.unwrap();
        let repeats = &measurement.experiments()[0].repeats;
        let part = |repeat: &Repeat, i: usize| {
            let value = repeat.response[i / 2] / problem.response_scale;
            if i.is_multiple_of(2) { value.re } else { value.im }
        };
        let mean = |i: usize, j: usize| {
            repeats.iter().map(|r| part(r, i) * part(r, j)).sum::<f64>() / REPEATS as f64
        };
        let correlation = of_input.correlation(&problem.experiments[0], &of_input.variances).matrix;
        assert!(correlation.clone().symmetric_eigen().eigenvalues.max() > 1.5);
        for i in 0..20 {
            // The first target is the constraint, which has one row.
            let own = 0.5 * (mean(i - i % 2, i - i % 2) + mean(i - i % 2 + 1, i - i % 2 + 1));
            let ratio = of_input.variances[1 + i / 2] / own;
            assert!((ratio - 1.0).abs() < 0.25, "{i}: {ratio}");
            for j in 0..i {
                let found = mean(i, j) / (mean(i, i) * mean(j, j)).sqrt();
                let expected = correlation[(i + 1, j + 1)];
                assert!((found - expected).abs() < 0.2, "{i} {j}: {found} {expected}");
            }
        }
    }

    #[test]
    fn deviations_that_the_axis_follows_are_no_noise_of_the_sensor() {
        assert!(of_input(&recorded(), true).1.is_none());
    }
}
