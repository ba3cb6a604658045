//! Records for the tests of this module, made by the independent simulator.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::machines::closed_loop::PositionLoop;
use crate::machines::records::{PeriodicMotion, RecordNoise, Sampling, multisine};
use crate::machines::simulator::{Effect, Machine, Settings, respond};
use crate::measurement::{
    Complex, Experiment, Harmonic, Intersample, Loop, Measurement, Metadata, Record, ResponseKind,
};
use crate::plant::{Actuator, Friction, Plant};

const SAMPLING: Sampling = Sampling { samples: 512, periods: 4 };

/// An axis with an actuator of order 1.
pub(super) fn plant() -> Plant {
    Plant {
        viscous_rate_rad_s: 8.0,
        constant: 20.0,
        actuator: Actuator::FirstOrder { corner_rad_s: 90.0 },
        friction: Friction::coulomb(0.2, 0.25),
    }
}

/// A record of the velocity under a multisine of 60 lines up to 120 rad/s, with noise of 0.5 % of its
/// root mean square. Its input runs in this way between the samples that are read, or else as the
/// smoothest course through them.
pub(super) fn multisine_record(
    plant: Plant,
    effects: &[Effect],
    course: Option<Intersample>,
    seed: u64,
) -> Measurement {
    multisine_record_of(ResponseKind::Velocity, plant, effects, course, seed)
}

/// The same of another response.
pub(super) fn multisine_record_of(
    kind: ResponseKind,
    plant: Plant,
    effects: &[Effect],
    course: Option<Intersample>,
    seed: u64,
) -> Measurement {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let experiment =
        recorded(kind, Machine { plant, effects }, course, multisine(60, 2.0, rng), rng);
    let metadata = Metadata { response_kind: kind, ..Metadata::default() };
    Measurement::new(metadata, vec![experiment], Vec::new(), String::new()).unwrap()
}

/// A record of the velocity under this multisine at two levels.
pub(super) fn two_levels(effects: &[Effect], seed: u64) -> Measurement {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let input = multisine(60, 2.0, rng);
    let machine = Machine { plant: plant(), effects };
    let mut at = |level: f64| {
        let input = input.iter().map(|line| level * line).collect();
        recorded(ResponseKind::Velocity, machine, None, input, rng)
    };
    let experiments = vec![at(1.0), at(0.5)];
    Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap()
}

/// A record of the position along a trajectory in a position loop, with noise of 1 % of the input's and
/// 0.01 % of the position's root mean square.
pub(super) fn in_a_position_loop(seed: u64) -> Measurement {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let position_loop = PositionLoop {
        omega_rad_s: 0.8,
        velocity: 2.0,
        bandwidth_rad_s: 16.0,
        lines: 60,
        harmonics: 120,
    };
    let machine = Machine { plant: plant(), effects: &[] };
    let velocity = position_loop.motion(&machine, 0.0, &Settings::default()).unwrap().unwrap();
    let motion = velocity.converted_to_position();
    let noise = RecordNoise {
        input: 1e-2 * motion.input_rms(),
        response: 1e-4 * motion.response_rms(),
        step: 0.0,
    };
    let kind = ResponseKind::Position;
    let experiment = motion.recorded(kind, &noise, SAMPLING, 0.0, rng).unwrap();
    let feedback = Some(Loop::Closed);
    let metadata = Metadata { response_kind: kind, feedback, ..Metadata::default() };
    Measurement::new(metadata, vec![experiment], Vec::new(), String::new()).unwrap()
}

/// A measurement whose responses are multiplied by a factor, given the experiment's index and the
/// angular frequency of the line (rad/s).
pub(super) fn multiplied(
    sound: &Measurement,
    factor: impl Fn(usize, f64) -> Complex,
) -> Measurement {
    let mut experiments = sound.experiments().to_vec();
    for (index, experiment) in experiments.iter_mut().enumerate() {
        let of =
            |harmonic: &Harmonic| factor(index, harmonic.order as f64 * experiment.omega_rad_s);
        let factors: Vec<Complex> = experiment.response.iter().map(of).collect();
        let means = experiment.response.iter_mut().zip(&factors);
        means.for_each(|(harmonic, factor)| harmonic.value *= factor);
        for repeat in &mut experiment.repeats {
            let values = repeat.response.iter_mut().zip(&factors);
            values.for_each(|(value, factor)| *value *= factor);
        }
    }
    let (metadata, hash) = (sound.metadata().clone(), sound.sha256().to_owned());
    Measurement::new(metadata, experiments, Vec::new(), hash).unwrap()
}

/// The record of the velocity under a multisine, its samples changed.
pub(super) fn spoilt_record(
    effects: &[Effect],
    spoil: impl FnOnce(&mut Record),
    seed: u64,
) -> Measurement {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let machine = Machine { plant: plant(), effects };
    let (kind, input) = (ResponseKind::Velocity, multisine(60, 2.0, rng));
    let (motion, noise) = moved(kind, machine, None, input);
    let mut record = motion.record(&noise, SAMPLING, 0.0, rng);
    spoil(&mut record);
    let experiment = PeriodicMotion::read(&record, kind, motion.omega_rad_s).unwrap();
    Measurement::new(Metadata::default(), vec![experiment], Vec::new(), String::new()).unwrap()
}

fn recorded(
    kind: ResponseKind,
    machine: Machine<'_>,
    course: Option<Intersample>,
    input: Vec<Complex>,
    rng: &mut ChaCha8Rng,
) -> Experiment {
    let (motion, noise) = moved(kind, machine, course, input);
    motion.recorded(kind, &noise, SAMPLING, 0.0, rng).unwrap()
}

/// How a machine moves, and the noise of its record.
fn moved(
    kind: ResponseKind,
    machine: Machine<'_>,
    course: Option<Intersample>,
    input: Vec<Complex>,
) -> (PeriodicMotion, RecordNoise) {
    let (omega_rad_s, samples) = (2.0, SAMPLING.samples as f64);
    let factor = |k: usize| course.map_or(1.0.into(), |course| course.factor(k, samples));
    let driven: Vec<_> = input.iter().enumerate().map(|(k, line)| factor(k) * line).collect();
    let response = respond(&machine, 0.0, omega_rad_s, &driven, 120, &Settings::default()).unwrap();
    let velocity = PeriodicMotion { omega_rad_s, input, response, mean_velocity: 0.0 };
    let motion = match kind {
        ResponseKind::Position => velocity.converted_to_position(),
        _ => velocity,
    };
    let noise = RecordNoise { input: 0.0, response: 5e-3 * motion.response_rms(), step: 0.0 };
    (motion, noise)
}
