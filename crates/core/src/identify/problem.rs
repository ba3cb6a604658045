//! A measurement prepared for fitting, in normalised units.
//!
//! Time, input and response are scaled by a frequency ω_ref, an input u_ref and a velocity v_ref,
//! all taken from the data. The same machine measured in other units therefore gives the same
//! problem, and its parameters differ by exactly the change of units. Comments call these units "in
//! scale".

mod coarser;
mod levels;
mod prepared;
mod read_out;
mod scales;
mod subset;
mod unknown_input;

use crate::effects::Scope;
use crate::measurement::{Measurement, ResponseKind};
use crate::plant::Plant;

use super::observed_motion::{largest_travel, largest_velocity, widest_travel};
use super::parameters::Prior;
use super::request::IdentifyError;
use levels::{excited_band, levels, peak_input, steepest_input};
pub(super) use prepared::{Prepared, Target, per_velocity};
use prepared::{has_unknown_jump, prepare};
pub(super) use scales::Scales;
use scales::rescaled;
pub(super) use unknown_input::UnknownInput;

/// A measurement ready for fitting.
#[derive(Debug, Clone)]
pub(super) struct Problem {
    /// Its units.
    pub scales: Scales,
    /// The experiments, in the order of the measurement.
    pub experiments: Vec<Prepared>,
    /// What the data says about where parameters can lie.
    pub prior: Prior,
    /// Whether the data cannot distinguish Fc⁺ from Fc⁻.
    pub tied_friction: bool,
    /// The unit of the response in scale, in units of the upload.
    pub response_scale: f64,
    /// Whether every experiment states its position (`run`) in the order of acquisition, and these
    /// differ.
    pub runs_known: bool,
    /// Largest rate of change of the input within the band, in scale.
    pub steepest_input: f64,
    /// Largest position amplitude of any harmonic, in scale.
    pub largest_travel: f64,
    /// Half the peak-to-peak position where that is largest, in scale. Of a multisine it is several
    /// times the amplitude of any harmonic.
    pub widest_travel: f64,
}

impl Problem {
    /// Prepares a measurement.
    ///
    /// # Errors
    /// When nothing moved, or the input was zero throughout.
    pub fn new(measurement: &Measurement) -> Result<Self, IdentifyError> {
        let kind = measurement.metadata().response_kind;
        let experiments = measurement.experiments();
        let unusable = |reason: &str| IdentifyError::Unusable { reason: reason.into() };
        if !measurement.transients().is_empty() {
            return Err(unusable(
                "the record does not repeat, and a fit needs whole periods, or a motion that begins \
                 and ends at rest under the same input: record at least two periods of a periodic \
                 input, or begin before the axis moves and end after it has stopped; if it does \
                 repeat, give its period (period_s); as it is, it can be used to validate a result",
            ));
        }
        let largest_input = experiments.iter().map(peak_input).fold(0.0, f64::max);
        if largest_input <= 0.0 {
            return Err(unusable("the input is zero in every experiment; record the input too"));
        }
        let largest_velocity =
            experiments.iter().map(|e| largest_velocity(e, kind)).fold(0.0, f64::max);
        if largest_velocity <= 0.0 {
            return Err(unusable(
                "the axis did not move in any experiment; excite it above its friction",
            ));
        }
        let (low, high) = experiments
            .iter()
            .map(excited_band)
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            .unwrap_or((1.0, 1.0));
        let scales =
            Scales { omega: (low * high).sqrt(), input: largest_input, velocity: largest_velocity };
        let response_scale = match kind {
            ResponseKind::Velocity => scales.velocity,
            ResponseKind::Position => scales.velocity / scales.omega,
            ResponseKind::Acceleration => scales.velocity * scales.omega,
        };
        let [first, last] = measurement.acquisition().unwrap_or_default();
        let share = |run: Option<f64>| run.map_or(0.0, |run| (run - first) / (last - first));
        let runs_known = last > first && experiments.iter().all(|e| e.run.is_some());
        let prepared: Vec<Prepared> = experiments
            .iter()
            .map(|e| {
                let share = if runs_known { share(e.run) } else { 0.0 };
                let unknown_jump = has_unknown_jump(e, measurement.metadata());
                Prepared { unknown_jump, ..prepare(e, kind, &scales, response_scale, share) }
            })
            .collect();
        if prepared.iter().all(|e| e.targets.is_empty()) {
            return Err(unusable("only means were measured; give harmonic 1 at least"));
        }
        let prior = levels(experiments, kind, &scales, (low, high));
        // With pure cosine inputs, different levels Fc⁺ and Fc⁻ show only in the mean and in even
        // harmonics.
        let tied_friction = prepared.iter().all(|e| {
            e.excitation.is_pure_cosine() && e.targets.iter().all(|target| target.order % 2 == 1)
        });
        let per_scale = scales.omega / scales.velocity;
        let steepest = match experiments.iter().map(|e| steepest_input(e, high)).fold(0.0, f64::max)
        {
            // No line of the input is within the band that was observed.
            0.0 => largest_input * high,
            steepest => steepest,
        };
        Ok(Self {
            scales,
            experiments: prepared,
            prior,
            tied_friction,
            response_scale,
            runs_known,
            steepest_input: steepest / (scales.input * scales.omega),
            largest_travel: largest_travel(experiments, kind) * per_scale,
            widest_travel: widest_travel(experiments, kind) * per_scale,
        })
    }

    /// Number of real data, constraints included.
    pub fn data(&self) -> usize {
        let components = |target: &Target| if target.real { 1 } else { 2 };
        self.experiments.iter().flat_map(|e| &e.targets).map(components).sum()
    }

    /// The scales from which effects derive the ranges of their parameters, given the plant of the
    /// base model; plant and result are in scale.
    pub fn scope(&self, plant: &Plant) -> Scope {
        Scope {
            plant: *plant,
            omega_low: self.prior.omega_low,
            omega_high: self.prior.omega_high,
            has_spectra: self.experiments.iter().any(|e| !e.excitation.is_pure_cosine()),
            moving_level: self.prior.moving_level,
            largest_level: self.prior.largest_level,
            steepest_input: self.steepest_input,
            largest_velocity: 1.0,
            largest_travel: self.largest_travel,
        }
    }

    /// Converts a plant from problem units to units of the upload.
    pub fn in_units(&self, plant: &Plant) -> Plant {
        rescaled(plant, self.scales)
    }

    /// Converts a plant from units of the upload to problem units.
    pub fn in_scale(&self, plant: &Plant) -> Plant {
        let Scales { omega, input, velocity } = self.scales;
        let inverse = Scales { omega: 1.0 / omega, input: 1.0 / input, velocity: 1.0 / velocity };
        rescaled(plant, inverse)
    }
}

#[cfg(test)]
mod tests {
    use crate::measurement::{Complex, Experiment, Metadata};

    use super::super::fixtures::{ACTUATORS, axis, joined, multisine, stepped_sine};
    use super::*;

    fn refused(measurement: &Measurement) -> String {
        Problem::new(measurement).expect_err("nothing to fit").to_string()
    }

    #[test]
    fn other_units_give_the_same_problem_in_scale() {
        let measurement = stepped_sine(&axis(ACTUATORS[2]), 3);
        let mut experiments = measurement.experiments().to_vec();
        for e in &mut experiments {
            e.magnitude *= 8.0;
            e.input.iter_mut().for_each(|u| *u *= 8.0);
            e.omega_rad_s *= 4.0;
            e.response.iter_mut().for_each(|h| h.value *= 2.0);
        }
        let here = Problem::new(&measurement).unwrap();
        let there = Problem::new(&joined(experiments)).unwrap();
        // The factors are powers of two, so the values agree bit for bit.
        for (a, b) in here.experiments.iter().zip(&there.experiments) {
            assert_eq!(a.excitation.omega_rad_s(), b.excitation.omega_rad_s());
            assert_eq!(a.excitation.input(), b.excitation.input());
            assert!(a.targets.iter().zip(&b.targets).all(|(a, b)| a.value == b.value));
        }
        assert_eq!((here.prior.moving_level, here.data()), (there.prior.moving_level, 16 * 7));
        let ratio = there.in_units(&axis(ACTUATORS[0])).constant
            / here.in_units(&axis(ACTUATORS[0])).constant;
        assert_eq!(ratio, 2.0 * 4.0 / 8.0);
    }

    #[test]
    fn a_position_is_held_to_its_mean_velocity_where_the_mean_of_the_input_was_measured() {
        let mut experiments = multisine(&axis(ACTUATORS[0])).experiments().to_vec();
        let mut constrained = |input_mean_measured: bool, mean_velocity: f64| {
            let e = &mut experiments[0];
            (e.input_mean_measured, e.mean_velocity) = (input_mean_measured, mean_velocity);
            let metadata =
                Metadata { response_kind: ResponseKind::Position, ..Metadata::default() };
            let position =
                Measurement::new(metadata, experiments.clone(), Vec::new(), String::new()).unwrap();
            let problem = Problem::new(&position).unwrap();
            let mut targets = problem.experiments[0].targets.iter();
            let found = targets.find(|target| target.constraint);
            found.map(|target| target.value.re * problem.scales.velocity)
        };
        assert_eq!(constrained(false, 0.5), None);
        assert_eq!(constrained(true, 0.0), Some(0.0));
        // Rounding of a division and a multiplication.
        assert!((constrained(true, 0.5).unwrap() - 0.5).abs() < 1e-15);
    }

    #[test]
    fn only_even_harmonics_or_a_general_input_tell_the_levels_apart() {
        let plant = axis(ACTUATORS[0]);
        let tied = |keep: &dyn Fn(usize) -> bool| {
            let mut experiments = stepped_sine(&plant, 3).experiments().to_vec();
            experiments.iter_mut().for_each(|e| e.response.retain(|h| keep(h.order)));
            Problem::new(&joined(experiments)).unwrap().tied_friction
        };
        assert!(tied(&|k| k % 2 == 1));
        assert!(!tied(&|k| k < 2) && !tied(&|k| k > 0));
        assert!(!Problem::new(&multisine(&plant)).unwrap().tied_friction);
    }

    #[test]
    fn a_multisine_has_a_spectrum_and_a_stepped_sine_has_none() {
        let axis = axis(ACTUATORS[0]);
        let has_spectra =
            |measurement: &Measurement| Problem::new(measurement).unwrap().scope(&axis).has_spectra;
        assert!(has_spectra(&multisine(&axis)));
        assert!(!has_spectra(&stepped_sine(&axis, 3)));
    }

    // 4096 samples of at most 40 cycles miss an extreme by a few thousandths at most.
    #[test]
    fn a_multisine_is_as_steep_as_its_course() {
        let measurement = multisine(&axis(ACTUATORS[0]));
        let experiment = &measurement.experiments()[0];
        let rate = |i: usize| -> f64 {
            let of = |(k, u): (usize, &Complex)| {
                let phase = std::f64::consts::TAU * (i * k) as f64 / 4096.0;
                let turn = Complex::from_polar(k as f64 * experiment.omega_rad_s, phase);
                -(u * turn).im
            };
            experiment.input.iter().enumerate().map(of).sum()
        };
        let steepest = (0..4096).map(|i| rate(i).abs()).fold(0.0, f64::max);
        let problem = Problem::new(&measurement).unwrap();
        let found = problem.steepest_input * problem.scales.input * problem.scales.omega;
        assert!((found / steepest - 1.0).abs() < 0.01, "{found} {steepest}");
    }

    #[test]
    fn an_input_of_which_no_line_was_observed_has_a_rate() {
        let mut experiments = stepped_sine(&axis(ACTUATORS[0]), 1).experiments().to_vec();
        for e in &mut experiments {
            e.input = vec![Complex::ZERO, Complex::ZERO, Complex::ZERO, Complex::ONE];
        }
        assert!(Problem::new(&joined(experiments)).unwrap().steepest_input > 0.0);
    }

    #[test]
    fn data_that_determines_nothing_is_refused_with_its_reason() {
        let measurement = stepped_sine(&axis(ACTUATORS[0]), 1);
        let changed = |change: &dyn Fn(&mut Experiment)| {
            let mut experiments = measurement.experiments().to_vec();
            experiments.iter_mut().for_each(change);
            joined(experiments)
        };
        let still = changed(&|e| e.response.iter_mut().for_each(|h| h.value *= 0.0));
        assert!(refused(&still).contains("did not move"));
        let silent = changed(&|e| {
            e.magnitude = 0.0;
            e.input.iter_mut().for_each(|u| *u *= 0.0);
        });
        assert!(refused(&silent).contains("input is zero"));
    }
}
