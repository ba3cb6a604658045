//! Records for the tests of this module, made by the independent simulator.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::machines::records::{PeriodicMotion, RecordNoise, Sampling, multisine};
use crate::machines::simulator::{Effect, Machine, Settings, respond};
use crate::measurement::{Intersample, Measurement, Metadata, ResponseKind};
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
    let (omega_rad_s, input) = (2.0, multisine(60, 2.0, rng));
    let samples = SAMPLING.samples as f64;
    let factor = |k: usize| course.map_or(1.0.into(), |course| course.factor(k, samples));
    let driven: Vec<_> = input.iter().enumerate().map(|(k, line)| factor(k) * line).collect();
    let (machine, settings) = (Machine { plant, effects }, Settings::default());
    let response = respond(&machine, 0.0, omega_rad_s, &driven, 120, &settings).unwrap();
    let motion = PeriodicMotion { omega_rad_s, input, response, mean_velocity: 0.0 };
    let noise = RecordNoise { input: 0.0, response: 5e-3 * motion.response_rms(), step: 0.0 };
    let experiment = motion.recorded(kind, &noise, SAMPLING, 0.0, rng).unwrap();
    Measurement::new(Metadata::default(), vec![experiment], Vec::new(), String::new()).unwrap()
}
