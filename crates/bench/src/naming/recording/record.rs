//! Records with as much noise as makes of a draw what is wanted.

use rand_chacha::ChaCha8Rng;
use servoscope_core::measurement::{
    Complex, Experiment, Loop, Measurement, Metadata, Record, ResponseKind,
};
use servoscope_core::plant::Plant;

use super::Recording;
use super::motions::{HARMONICS, LINES, multisines, positions, trajectory};
use crate::machines::draw::{Draw, log_uniform};
use crate::machines::records::{PeriodicMotion, RecordNoise, multisine, sweep};
use crate::machines::simulator::Effect;
use crate::naming::dominance::Dominance;

/// Highest harmonic of the response where its samples are changed: what a channel cuts off is all that
/// its filter passes, and most records have 1023 lines below half the sampling rate.
const HARMONICS_OF_SAMPLES: usize = 1023;
/// Half the peak-to-peak value of a multisine, as a multiple of the highest magnitude of a table.
/// Its root mean square is about a third of that.
const MULTISINE_MAGNITUDE: f64 = 1.5;
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

/// What the noise of a record shall make of its effects.
#[derive(Debug, Clone, Copy)]
pub(in crate::naming) enum Wanted {
    /// The χ² per degree of freedom that the dominant effects leave.
    Left(f64),
    /// The excess χ² of the base model.
    Excess(f64),
    /// Nothing: no effect is hidden.
    Sound,
}

/// A record of a machine.
pub(in crate::naming) struct Recorded {
    /// The samples of each experiment.
    pub(in crate::naming) records: Vec<Record>,
    pub(in crate::naming) measurement: Measurement,
    pub(in crate::naming) dominance: Dominance,
    /// Noise of the first harmonic, response units.
    pub(in crate::naming) std: f64,
    /// The same below the first harmonic, dB.
    pub(in crate::naming) level_db: f64,
}

impl Recording {
    /// Records a machine whose first effects, this many, dominate, with as much noise as it takes to
    /// have what is wanted. `None` if it has no response of the input's period, cannot be fitted, or
    /// would need noise that no sensor has. Where `samples_change`, the response has all its harmonics.
    pub(in crate::naming) fn record(
        self,
        machine: &Draw,
        dominant: usize,
        wanted: Wanted,
        samples_change: bool,
        rng: &mut ChaCha8Rng,
    ) -> Option<Recorded> {
        let magnitude = MULTISINE_MAGNITUDE * machine.design.last()?.0;
        let random = |rng: &mut ChaCha8Rng| multisine(LINES, magnitude, rng);
        let harmonics = if samples_change { HARMONICS_OF_SAMPLES } else { HARMONICS };
        let sines = |levels: usize, input: Vec<Complex>| {
            multisines(machine, dominant, levels, input, harmonics)
        };
        let motions = match self {
            Self::Multisine { levels } => sines(levels, random(rng))?,
            Self::Held => sines(1, self.sampling().held(&random(rng)))?,
            Self::Sweep => sines(1, sweep(LINES, magnitude))?,
            Self::Position { .. } | Self::Rounded => positions(sines(1, random(rng))?),
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
            read.record(&noise, sampling, run(place), rng)
        };
        let records: Vec<Record> = motions.iter().enumerate().map(recorded).collect();
        let fundamentals = motions.iter().map(|[whole, _]| whole.omega_rad_s);
        let measurement = self.read(&records, fundamentals)?;
        let exact = exact(0, &noise)?;
        let first = exact.experiments()[0].harmonic(1)?;
        let std = first.std?;
        let level_db = 20.0 * (first.value.norm() / std).log10();
        Some(Recorded { records, measurement, dominance, std, level_db })
    }

    /// The measurement that records of periodic motions with these fundamentals (rad/s) make; `None` if
    /// one of them cannot be read.
    pub(in crate::naming) fn read(
        self,
        records: &[Record],
        fundamentals: impl Iterator<Item = f64>,
    ) -> Option<Measurement> {
        let each = records.iter().zip(fundamentals);
        let read = each.map(|(record, omega_rad_s)| {
            PeriodicMotion::read(record, self.kind(), omega_rad_s).ok()
        });
        self.measurement(read.collect::<Option<_>>()?)
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

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;
    use crate::naming::recording::fixtures::machine;

    #[test]
    #[ignore = "slow: fits of 200 lines"]
    fn a_record_has_the_noise_with_which_the_dominant_effect_leaves_what_it_shall() {
        for recording in Recording::ALL {
            let rng = &mut ChaCha8Rng::seed_from_u64(1);
            let recorded = recording.record(&machine(), 1, Wanted::Left(5.0), false, rng).unwrap();
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
