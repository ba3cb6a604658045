//! A measurement prepared for fitting, in normalised units.
//!
//! Time, input and response are scaled by a frequency ω_ref, an input u_ref and a velocity v_ref,
//! all taken from the data. The same machine measured in other units therefore gives the same
//! problem, and its parameters differ by exactly the change of units. Comments call these units "in
//! scale".

mod subset;

use crate::effects::Scope;
use crate::measurement::{
    Complex, EXCITED_SHARE, Experiment, Loop, Measurement, Metadata, ResponseKind,
};
use crate::plant::{Actuator, Friction, Plant};
use crate::simulate::Excitation;

use super::observed_motion::{largest_travel, largest_velocity, widest_travel};
use super::parameters::Prior;
use super::request::IdentifyError;

/// Fewest samples of a coarse grid for each cycle of the highest line that is both excited and
/// compared. Quintics interpolate that line with a relative error of 2e-3: (2π/3)⁶/46080.
const FEWEST_SAMPLES_PER_CYCLE: usize = 3;

/// The units of the problem, expressed in units of the upload.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scales {
    /// ω_ref, rad/s.
    pub omega: f64,
    /// u_ref, input units.
    pub input: f64,
    /// v_ref, velocity units.
    pub velocity: f64,
}

/// One datum: a harmonic of the response.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    /// Harmonic k.
    pub order: usize,
    /// Measured value, in scale.
    pub value: Complex,
    /// Factor from velocity to response: 1 (velocity), 1/(jkω) (position) or jkω (acceleration), in
    /// scale.
    pub per_velocity: Complex,
    /// Whether only the real part is compared (harmonic 0).
    pub real: bool,
    /// Whether this is not a datum but the constraint of the mean velocity of a position.
    pub constraint: bool,
}

/// One experiment, ready for simulation.
#[derive(Debug, Clone)]
pub(super) struct Prepared {
    /// The input, in scale.
    pub excitation: Excitation,
    /// Highest harmonic that is compared.
    pub highest: usize,
    /// The harmonics that are compared.
    pub targets: Vec<Target>,
    /// Whether it is not known exactly how far a position ends its period from where it began.
    pub unknown_jump: bool,
}

impl Prepared {
    /// The highest line of the input that is excited and compared; 0 if there is none.
    fn highest_excited(&self) -> usize {
        let lines = || self.excitation.input().iter().enumerate().skip(1);
        let largest = lines().map(|(_, u)| u.norm()).fold(0.0, f64::max);
        let is_excited =
            |(k, u): &(usize, &Complex)| *k <= self.highest && u.norm() > EXCITED_SHARE * largest;
        lines().rfind(is_excited).map_or(0, |(k, _)| k)
    }
}

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
                "the record does not repeat, and a fit needs whole periods: record at least two \
                 periods of a periodic input; if it does repeat, give its period (period_s); as it \
                 is, it can be used to validate a result",
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
        Ok(Self {
            scales,
            experiments: prepared,
            prior,
            tied_friction,
            response_scale,
            runs_known,
            largest_travel: largest_travel(experiments, kind) * per_scale,
            widest_travel: widest_travel(experiments, kind) * per_scale,
        })
    }

    /// The same problem on coarser grids, which interpolate inputs to this error, relative to
    /// their rms without the mean; `None` if no experiment has one.
    pub fn coarser(&self, error: f64) -> Option<Self> {
        let mut coarse = self.clone();
        let mut any = false;
        for experiment in &mut coarse.experiments {
            let fewest = FEWEST_SAMPLES_PER_CYCLE * experiment.highest_excited();
            if let Some(excitation) = experiment.excitation.coarser(error, fewest) {
                experiment.excitation = excitation;
                any = true;
            }
        }
        any.then_some(coarse)
    }

    /// Number of real data, constraints included.
    pub fn data(&self) -> usize {
        let components = |target: &Target| if target.real { 1 } else { 2 };
        self.experiments.iter().flat_map(|e| &e.targets).map(components).sum()
    }

    /// Number of jumps that are estimated with every model.
    pub fn unknown_jumps(&self) -> usize {
        self.experiments.iter().filter(|experiment| experiment.unknown_jump).count()
    }

    /// The scales from which effects derive the ranges of their parameters, given the plant of the
    /// base model; plant and result are in scale.
    pub fn scope(&self, plant: &Plant) -> Scope {
        Scope {
            plant: *plant,
            omega_low: self.prior.omega_low,
            omega_high: self.prior.omega_high,
            moving_level: self.prior.moving_level,
            largest_level: self.prior.largest_level,
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

/// The plant with its rates, torques and velocities multiplied by these factors.
fn rescaled(plant: &Plant, Scales { omega, input, velocity }: Scales) -> Plant {
    let friction = plant.friction;
    Plant {
        viscous_rate_rad_s: plant.viscous_rate_rad_s * omega,
        constant: plant.constant * velocity * omega / input,
        actuator: match plant.actuator {
            Actuator::Direct => Actuator::Direct,
            Actuator::FirstOrder { corner_rad_s } => {
                Actuator::FirstOrder { corner_rad_s: corner_rad_s * omega }
            }
            Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
                Actuator::SecondOrder {
                    natural_frequency_rad_s: natural_frequency_rad_s * omega,
                    damping_ratio,
                }
            }
        },
        friction: Friction {
            fc_plus: friction.fc_plus * input,
            fc_minus: friction.fc_minus * input,
            fs_plus: friction.fs_plus * input,
            fs_minus: friction.fs_minus * input,
        },
    }
}

/// Factor from velocity to response at harmonic k of the fundamental frequency `omega`.
pub(super) fn per_velocity(kind: ResponseKind, k: usize, omega: f64) -> Complex {
    let s = Complex::new(0.0, k as f64 * omega);
    match kind {
        ResponseKind::Velocity => Complex::new(1.0, 0.0),
        ResponseKind::Position => 1.0 / s,
        ResponseKind::Acceleration => s,
    }
}

/// Peak input of an experiment: its magnitude (half its peak-to-peak value) plus the size of its
/// mean.
fn peak_input(experiment: &Experiment) -> f64 {
    let mean = experiment.input.first().map_or(0.0, |u| u.re.abs());
    experiment.magnitude.max(experiment.pure_cosine().map_or(0.0, |u| u.norm())) + mean
}

/// Lowest and highest frequency (rad/s) that is both excited and observed.
fn excited_band(experiment: &Experiment) -> (f64, f64) {
    let lines = experiment.input.iter().enumerate().skip(1);
    let largest = lines.clone().map(|(_, u)| u.norm()).fold(0.0, f64::max);
    let highest = experiment.highest_harmonic().max(1);
    let mut excited = lines
        .filter(|(k, u)| *k <= highest && u.norm() > EXCITED_SHARE * largest)
        .map(|(k, _)| k as f64 * experiment.omega_rad_s);
    let first = excited.next().unwrap_or(experiment.omega_rad_s);
    (first, excited.next_back().unwrap_or(first))
}

fn prepare(
    experiment: &Experiment,
    kind: ResponseKind,
    scales: &Scales,
    response_scale: f64,
    run_share: f64,
) -> Prepared {
    let omega = experiment.omega_rad_s / scales.omega;
    let input = experiment.input.iter().map(|u| u / scales.input).collect();
    let mut targets: Vec<Target> = experiment
        .response
        .iter()
        .filter(|harmonic| harmonic.order > 0 || kind == ResponseKind::Velocity)
        .map(|harmonic| Target {
            order: harmonic.order,
            value: harmonic.value / response_scale,
            per_velocity: per_velocity(kind, harmonic.order, omega),
            real: harmonic.order == 0,
            constraint: false,
        })
        .collect();
    if kind == ResponseKind::Position && experiment.input_mean_measured {
        // The mean velocity is known, mostly 0. That constrains the friction only if the mean of
        // the input was measured; otherwise the offset that balanced the friction is unknown.
        let value = Complex::new(experiment.mean_velocity / scales.velocity, 0.0);
        let one = Complex::new(1.0, 0.0);
        targets
            .insert(0, Target { order: 0, value, per_velocity: one, real: true, constraint: true });
    }
    let highest = targets.last().map_or(0, |target| target.order);
    let excitation = Excitation::new(omega, input).at_run_share(run_share);
    Prepared { excitation, highest, targets, unknown_jump: false }
}

/// Whether a single period of a position was recorded of an axis that no loop holds.
fn has_unknown_jump(experiment: &Experiment, metadata: &Metadata) -> bool {
    experiment.from_record
        && experiment.repeats.is_empty()
        && metadata.response_kind == ResponseKind::Position
        && metadata.feedback != Some(Loop::Closed)
}

/// Frequency band and torque levels of the experiments, in scale.
fn levels(
    experiments: &[Experiment],
    kind: ResponseKind,
    scales: &Scales,
    (low, high): (f64, f64),
) -> Prior {
    let mut prior = Prior {
        omega_low: low / scales.omega,
        omega_high: high / scales.omega,
        moving_level: f64::INFINITY,
        largest_level: 0.0,
    };
    // Noise gives even a resting axis some velocity. An experiment therefore counts as moving only
    // if its mobility, velocity per torque, is at least 0.02 of the largest one (tuned). The factor
    // 1 + ω/ω_ref makes mobilities comparable over frequency: it undoes the roll-off of a
    // first-order lag with its corner in the middle of the band.
    let mobility = |e: &Experiment| {
        largest_velocity(e, kind) / scales.velocity * (1.0 + e.omega_rad_s / scales.omega)
            / (peak_input(e) / scales.input).max(f64::MIN_POSITIVE)
    };
    let largest_mobility = experiments.iter().map(mobility).fold(0.0, f64::max);
    for experiment in experiments {
        let level = peak_input(experiment) / scales.input;
        prior.largest_level = prior.largest_level.max(level);
        if mobility(experiment) > 0.02 * largest_mobility {
            prior.moving_level = prior.moving_level.min(level);
        }
    }
    prior.moving_level = prior.moving_level.min(prior.largest_level);
    prior
}

#[cfg(test)]
mod tests {
    use crate::measurement::Metadata;

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
