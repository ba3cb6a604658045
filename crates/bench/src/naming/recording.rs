//! Records of a machine, in place of a table: multisines whose response is a velocity or a position, and
//! a trajectory in a position loop.

use std::fmt;

use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use servoscope_core::measurement::{
    Complex, Experiment, Loop, Measurement, Metadata, ResponseKind,
};
use servoscope_core::plant::Plant;

use super::dominance::Dominance;
use crate::machines::closed_loop::PositionLoop;
use crate::machines::draw::{Draw, log_uniform};
use crate::machines::records::{PeriodicMotion, RecordNoise, Sampling, multisine, sweep};
use crate::machines::simulator::{Effect, Machine, Settings, respond};

/// Lines of a multisine, and of the command in a position loop.
const LINES: usize = 200;
/// Highest harmonic of the response that is simulated.
const HARMONICS: usize = 300;
/// Half the peak-to-peak value of a multisine, as a multiple of the highest magnitude of a table.
/// Its root mean square is about a third of that.
const MULTISINE_MAGNITUDE: f64 = 1.5;
/// Ratio of the two levels.
const LEVEL_RATIO: f64 = 2.0;
/// Highest velocity of a trajectory, as a multiple of that at the lowest magnitude of a table, at
/// low frequency and without friction.
const TRAJECTORY_VELOCITY: f64 = 1.5;
/// Fundamental of a trajectory and bandwidth of its loop, as multiples of a.
const TRAJECTORY_RATES: [f64; 2] = [0.1, 2.0];
/// Samples of a record, over all its periods.
const SAMPLES: usize = 8192;
/// Periods, but for records of a single one.
const PERIODS: usize = 4;
/// Noise of every sample of the input and of the response of a multisine, as shares of their root
/// mean squares. It is then changed until the dominant effects leave what they shall.
const MULTISINE_NOISE: [f64; 2] = [0.0, 5e-3];
/// The same along a trajectory: a current is measured less well than a position.
const TRAJECTORY_NOISE: [f64; 2] = [1e-2, 1e-4];
/// Resolution of a sensor that rounds, as a multiple of the noise of a sample.
const STEP_OF_NOISE: f64 = 4.0;
/// Least and largest change of the noise where nothing is hidden.
const SOUND_NOISE_CHANGE: [f64; 2] = [0.1, 3.0];
/// Least and largest change of this noise.
const NOISE_CHANGE: [f64; 2] = [0.02, 20.0];

/// How a machine is recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Recording {
    /// 200 lines of equal size and random phases, with a response that is a velocity.
    Multisine {
        /// Number of levels, 1 or 2.
        levels: usize,
    },
    /// The multisine at one level as the command of a converter, which holds each sample until the
    /// next. The record does not say so.
    Held,
    /// The multisine at one level with a response that is a position. Nothing holds the axis, so it
    /// moves on where it is not symmetric.
    Position {
        /// Number of periods, 1 or 4, with as many samples in all.
        periods: usize,
    },
    /// The lines of a multisine with the phases of M. R. Schroeder (1970,
    /// doi:10.1109/TIT.1970.1054411), which make a sweep of it, with a response that is a velocity.
    Sweep,
    /// Four periods of a position that a sensor rounds to its resolution.
    Rounded,
    /// A trajectory in a closed position loop: the response is a position, and the input is
    /// measured with noise.
    Trajectory,
}

/// `trajectory`, `multisine at 2 levels`.
impl fmt::Display for Recording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Multisine { levels: 1 } => f.write_str("multisine at 1 level"),
            Self::Multisine { levels } => write!(f, "multisine at {levels} levels"),
            Self::Held => f.write_str("multisine, held between samples"),
            Self::Position { periods: 1 } => f.write_str("one period of a position"),
            Self::Position { periods } => write!(f, "{periods} periods of a position"),
            Self::Sweep => f.write_str("sweep"),
            Self::Rounded => f.write_str("position, rounded by its sensor"),
            Self::Trajectory => f.write_str("trajectory in a position loop"),
        }
    }
}

/// What the noise of a record shall make of its effects.
#[derive(Debug, Clone, Copy)]
pub(super) enum Wanted {
    /// The χ² per degree of freedom that the dominant effects leave.
    Left(f64),
    /// The excess χ² of the base model.
    Excess(f64),
    /// Nothing: no effect is hidden.
    Sound,
}

/// A record of a machine.
pub(super) struct Recorded {
    pub(super) measurement: Measurement,
    pub(super) dominance: Dominance,
    /// Noise of the first harmonic, response units.
    pub(super) std: f64,
    /// The same below the first harmonic, dB.
    pub(super) level_db: f64,
}

/// Every motion of a record, of the whole machine and, with the same input, of that without its
/// small effects.
type Motions = Vec<[PeriodicMotion; 2]>;

impl Recording {
    /// All of them.
    pub(super) const ALL: [Self; 8] = [
        Self::Multisine { levels: 1 },
        Self::Multisine { levels: 2 },
        Self::Trajectory,
        Self::Position { periods: PERIODS },
        Self::Position { periods: 1 },
        Self::Held,
        Self::Sweep,
        Self::Rounded,
    ];

    fn kind(self) -> ResponseKind {
        match self {
            Self::Multisine { .. } | Self::Held | Self::Sweep => ResponseKind::Velocity,
            Self::Position { .. } | Self::Rounded | Self::Trajectory => ResponseKind::Position,
        }
    }

    fn sampling(self) -> Sampling {
        let periods = match self {
            Self::Position { periods } => periods,
            _ => PERIODS,
        };
        Sampling { samples: SAMPLES / periods, periods }
    }

    /// Records a machine whose first effects, this many, dominate, with as much noise as it takes to
    /// have what is wanted. `None` if it has no response of the input's period, cannot be fitted, or
    /// would need noise that no sensor has.
    pub(super) fn record(
        self,
        machine: &Draw,
        dominant: usize,
        wanted: Wanted,
        rng: &mut ChaCha8Rng,
    ) -> Option<Recorded> {
        let magnitude = MULTISINE_MAGNITUDE * machine.design.last()?.0;
        let random = |rng: &mut ChaCha8Rng| multisine(LINES, magnitude, rng);
        let motions = match self {
            Self::Multisine { levels } => multisines(machine, dominant, levels, random(rng))?,
            Self::Held => multisines(machine, dominant, 1, self.sampling().held(&random(rng)))?,
            Self::Sweep => multisines(machine, dominant, 1, sweep(LINES, magnitude))?,
            Self::Position { .. } | Self::Rounded => {
                positions(multisines(machine, dominant, 1, random(rng))?)
            }
            Self::Trajectory => trajectory(machine, dominant)?,
        };
        let noise = self.noise(&motions[0][0]);
        let sampling = self.sampling();
        let run = |place: usize| place as f64;
        let exact = |which: usize, noise: &RecordNoise| {
            let exact = |(place, both): (usize, &[PeriodicMotion; 2])| {
                let omega_rad_s = both[which].omega_rad_s;
                let gain = |k: usize| self.gain(&machine.plant, k as f64 * omega_rad_s);
                both[which].exact(self.kind(), LINES, noise, sampling, run(place), gain)
            };
            self.measurement(motions.iter().enumerate().map(exact).collect())
        };
        let ids: Vec<&str> = machine.effects[..dominant].iter().map(Effect::id).collect();
        let order = machine.plant.actuator.order();
        let found = Dominance::of(&exact(0, &noise)?, &exact(1, &noise)?, &ids, order).ok()?;
        // Noise changes the size of all excesses, but not where the fits end.
        let change = match wanted {
            Wanted::Left(chi2_per_dof) => {
                ((found.chi2_per_dof - 1.0) / (chi2_per_dof - 1.0)).sqrt()
            }
            Wanted::Excess(excess) => (found.base / excess).sqrt(),
            Wanted::Sound => log_uniform(SOUND_NOISE_CHANGE[0], SOUND_NOISE_CHANGE[1], rng),
        };
        if !(NOISE_CHANGE[0]..=NOISE_CHANGE[1]).contains(&change) {
            return None;
        }
        let (noise, dominance) = (noise.times(change), found.with_noise(change));
        let recorded = |(place, [whole, _]): (usize, &[PeriodicMotion; 2])| {
            let read = match self {
                Self::Held => whole.read_before_holding(sampling),
                _ => whole.clone(),
            };
            read.recorded(self.kind(), &noise, sampling, run(place), rng).ok()
        };
        let experiments = motions.iter().enumerate().map(recorded).collect::<Option<_>>()?;
        let exact = exact(0, &noise)?;
        let first = exact.experiments()[0].harmonic(1)?;
        let std = first.std?;
        let level_db = 20.0 * (first.value.norm() / std).log10();
        Some(Recorded { measurement: self.measurement(experiments)?, dominance, std, level_db })
    }

    /// Gain of the linear machine from input to response; that of a position has no mean.
    fn gain(self, plant: &Plant, omega_rad_s: f64) -> f64 {
        let response = plant.actuator.response(omega_rad_s) * plant.mechanics_response(omega_rad_s);
        match self.kind() {
            ResponseKind::Position if omega_rad_s > 0.0 => response.norm() / omega_rad_s,
            _ => response.norm(),
        }
    }

    fn noise(self, motion: &PeriodicMotion) -> RecordNoise {
        let [input, response] = match self {
            Self::Trajectory => TRAJECTORY_NOISE,
            _ => MULTISINE_NOISE,
        };
        let step = if self == Self::Rounded { STEP_OF_NOISE * response } else { 0.0 };
        RecordNoise {
            input: input * motion.input_rms(),
            response: response * motion.response_rms(),
            step: step * motion.response_rms(),
        }
    }

    fn measurement(self, experiments: Vec<Experiment>) -> Option<Measurement> {
        let feedback = Some(match self {
            Self::Trajectory => Loop::Closed,
            _ => Loop::Open,
        });
        let metadata = Metadata { response_kind: self.kind(), feedback, ..Metadata::default() };
        Measurement::new(metadata, experiments, Vec::new(), String::new()).ok()
    }
}

/// The same multisine at one or two levels.
fn multisines(
    machine: &Draw,
    dominant: usize,
    levels: usize,
    input: Vec<Complex>,
) -> Option<Motions> {
    let (_, band_rad_s) = *machine.design.last()?;
    let omega_rad_s = band_rad_s / LINES as f64;
    let level = |level: usize| {
        let factor = LEVEL_RATIO.powi(-(level as i32));
        let input: Vec<_> = input.iter().map(|line| factor * line).collect();
        let share = level as f64 / (levels - 1).max(1) as f64;
        let of = |effects: &[Effect]| {
            let machine = Machine { plant: machine.plant, effects };
            let settings = Settings::default();
            let response =
                respond(&machine, share, omega_rad_s, &input, HARMONICS, &settings).ok()?;
            Some(PeriodicMotion { omega_rad_s, input: input.clone(), response, mean_velocity: 0.0 })
        };
        Some([of(&machine.effects)?, of(&machine.effects[..dominant])?])
    };
    (0..levels).map(level).collect()
}

/// The trajectory as the whole machine follows it, and what its command does without the small
/// effects.
fn trajectory(machine: &Draw, dominant: usize) -> Option<Motions> {
    let plant = machine.plant;
    let a = plant.viscous_rate_rad_s;
    let [omega, bandwidth] = TRAJECTORY_RATES;
    let lowest = machine.design.first()?.0;
    let position_loop = PositionLoop {
        omega_rad_s: omega * a,
        velocity: TRAJECTORY_VELOCITY * lowest * plant.constant / a,
        bandwidth_rad_s: bandwidth * a,
        lines: LINES,
        harmonics: HARMONICS,
    };
    let settings = Settings::default();
    let whole = Machine { plant, effects: &machine.effects };
    let motion = position_loop.motion(&whole, 0.0, &settings).ok()??;
    let without_small = Machine { plant, effects: &machine.effects[..dominant] };
    let PeriodicMotion { omega_rad_s, input, .. } = motion.clone();
    let response = respond(&without_small, 0.0, omega_rad_s, &input, HARMONICS, &settings).ok()?;
    let other = PeriodicMotion { omega_rad_s, input, response, mean_velocity: 0.0 };
    Some(positions(vec![[motion, other]]))
}

fn positions(motions: Motions) -> Motions {
    motions.into_iter().map(|both| both.map(PeriodicMotion::converted_to_position)).collect()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::machines::draw::draw;

    fn machine() -> Draw {
        let machine = draw(0, 3);
        let e = 0.05 * machine.plant.viscous_rate_rad_s / machine.plant.constant;
        let e = e / machine.design[0].0;
        let effects = vec![
            Effect::new("gain_asymmetry", [("gamma", 0.1)]),
            Effect::new("sensor_compression", [("e", e)]),
        ];
        Draw { effects, ..machine }
    }

    #[test]
    fn two_levels_are_the_same_multisine_and_the_input_does_not_depend_on_small_effects() {
        let machine = machine();
        let input = multisine(LINES, 1.0, &mut ChaCha8Rng::seed_from_u64(1));
        let motions = multisines(&machine, 1, 2, input).unwrap();
        let [[whole, dominant], [lower, _]] = &motions[..] else { panic!("two levels") };
        assert_eq!((whole.input.len(), &whole.input), (LINES + 1, &dominant.input));
        assert_ne!(whole.response, dominant.response);
        for (high, low) in whole.input.iter().zip(&lower.input) {
            assert_eq!(*low, high / LEVEL_RATIO);
        }
    }

    #[test]
    fn every_recording_is_drawn_and_says_what_it_is() {
        let expected = [
            "multisine at 1 level",
            "multisine at 2 levels",
            "trajectory in a position loop",
            "4 periods of a position",
            "one period of a position",
            "multisine, held between samples",
            "sweep",
            "position, rounded by its sensor",
        ];
        assert_eq!(Recording::ALL.map(|recording| recording.to_string()), expected);
    }

    #[test]
    #[ignore = "slow: fits of 200 lines"]
    fn a_record_has_the_noise_with_which_the_dominant_effect_leaves_what_it_shall() {
        for recording in Recording::ALL {
            let rng = &mut ChaCha8Rng::seed_from_u64(1);
            let recorded = recording.record(&machine(), 1, Wanted::Left(5.0), rng).unwrap();
            // Rounding of a few operations.
            assert!((recorded.dominance.chi2_per_dof - 5.0).abs() < 1e-9, "{recording}");
            let experiments = recorded.measurement.experiments();
            let levels = if let Recording::Multisine { levels } = recording { levels } else { 1 };
            assert_eq!(experiments.len(), levels);
            let periods = recording.sampling().periods;
            let repeats = if periods == 1 { 0 } else { periods };
            assert!(experiments.iter().all(|e| e.repeats.len() == repeats));
            assert_eq!(recorded.measurement.metadata().response_kind, recording.kind());
        }
    }
}
