//! Draws faults at random.

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use servoscope_core::measurement::{Experiment, Measurement};

use super::{BadRow, Mismeasurement, Sort};
use crate::machines::draw::log_uniform;
use crate::machines::noise::NoiseLaw;

/// Smallest and largest factor of a wrong standard deviation.
const STD_FACTOR: [f64; 2] = [0.3, 3.0];
/// Factors between these are too near to 1 to count as wrong.
const NEARLY_RIGHT: [f64; 2] = [0.8, 1.25];
/// Smallest and largest error of the gain of a level, and of that of an experiment.
const LEVEL_GAIN: [f64; 2] = [0.02, 0.5];
const RUN_GAIN: [f64; 2] = [0.02, 0.2];
/// Smallest and largest error of a phase, degrees.
const PHASE_DEGREES: [f64; 2] = [2.0, 10.0];
/// Smallest and largest phase of a skew at the highest frequency that an input has, degrees.
const SKEW_DEGREES: [f64; 2] = [2.0, 20.0];
/// Lines of an input that are smaller than this share of the largest are noise.
const EXCITED_SHARE: f64 = 0.02;

impl Mismeasurement {
    /// Draws a fault of this sort in a measurement whose noise has this law; `exact` is the measurement
    /// without noise, with which bad rows are compared. Sizes are log-uniform
    /// and have either sign:
    ///
    /// | quantity | range |
    /// | --- | --- |
    /// | bad rows | 1 or 5 in 100, at least one |
    /// | error of a bad row | 5 … 50 % of its value |
    /// | stated over true standard deviation | 0.3 … 0.8 and 1.25 … 3 |
    /// | error of the gain of a level, of an experiment | 2 … 50 %, 2 … 20 % |
    /// | error of the phase of a level or an experiment | 2 … 10° |
    /// | … of an experiment that is a record, at the highest line of its input | 2 … 20° |
    /// | skew (always ahead), at the highest fundamental | 2 … 20° |
    pub fn draw(
        sort: Sort,
        [sound, exact]: [&Measurement; 2],
        law: &NoiseLaw,
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let mut bad_rows = |share| BadRow::draw(share, [sound, exact], law, rng);
        match sort {
            Sort::OneBadRowInAHundred => Self::BadRows(bad_rows(0.01)),
            Sort::FiveBadRowsInAHundred => Self::BadRows(bad_rows(0.05)),
            Sort::StdFactor => Self::StdFactor { factor: std_factor(rng) },
            Sort::LevelGain => Self::LevelGain {
                magnitude: magnitude(sound, rng),
                factor: 1.0 + signed(LEVEL_GAIN, rng),
            },
            Sort::LevelPhase => Self::LevelPhase {
                magnitude: magnitude(sound, rng),
                degrees: signed(PHASE_DEGREES, rng),
            },
            Sort::RunGain => Self::RunGain {
                experiment: rng.random_range(0..sound.experiments().len()),
                factor: 1.0 + signed(RUN_GAIN, rng),
            },
            Sort::RunPhase => {
                let experiment = rng.random_range(0..sound.experiments().len());
                let measured = &sound.experiments()[experiment];
                let degrees = match measured.from_record {
                    true => signed(SKEW_DEGREES, rng) / highest_excited(measured) as f64,
                    false => signed(PHASE_DEGREES, rng),
                };
                Self::RunPhase { experiment, degrees }
            }
            Sort::Conjugated => Self::Conjugated,
            Sort::SineReference => Self::SineReference,
            Sort::ReversedSign => Self::ReversedSign,
            Sort::PositionCalledVelocity => Self::PositionCalledVelocity,
            Sort::RmsCalledPeak => Self::RmsCalledPeak,
            Sort::PeakToPeakCalledPeak => Self::PeakToPeakCalledPeak,
            // Tables have no samples; those of records are drawn elsewhere.
            Sort::BadSamples | Sort::ClippedInput | Sort::ClippedResponse => {
                Self::BadSamples(Vec::new())
            }
            Sort::ChannelSkew => {
                let frequencies = sound.experiments().iter().map(fastest_rad_s);
                let degrees = log_uniform(SKEW_DEGREES[0], SKEW_DEGREES[1], rng);
                Self::ChannelSkew {
                    seconds: degrees.to_radians() / frequencies.fold(0.0, f64::max),
                }
            }
        }
    }
}

/// The highest frequency that an input has: of its lines that are no noise, rad/s.
fn fastest_rad_s(experiment: &Experiment) -> f64 {
    highest_excited(experiment) as f64 * experiment.omega_rad_s
}

/// The highest line of an input that is no noise.
fn highest_excited(experiment: &Experiment) -> usize {
    let largest = experiment.input.iter().skip(1).map(|line| line.norm()).fold(0.0, f64::max);
    let excited = experiment.input.iter().rposition(|line| line.norm() > EXCITED_SHARE * largest);
    excited.unwrap_or(1).max(1)
}

/// A log-uniform size with either sign.
fn signed([least, most]: [f64; 2], rng: &mut ChaCha8Rng) -> f64 {
    let size = log_uniform(least, most, rng);
    if rng.random() { size } else { -size }
}

fn std_factor(rng: &mut ChaCha8Rng) -> f64 {
    let [low, high] = NEARLY_RIGHT;
    loop {
        let factor = log_uniform(STD_FACTOR[0], STD_FACTOR[1], rng);
        if !(low..=high).contains(&factor) {
            return factor;
        }
    }
}

/// One of the magnitudes of a measurement, all equally likely.
fn magnitude(measurement: &Measurement, rng: &mut ChaCha8Rng) -> f64 {
    let mut all: Vec<f64> = measurement.experiments().iter().map(|one| one.magnitude).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all.choose(rng).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::super::fixtures::{LAW, table};
    use super::*;

    /// Two hundred faults of a sort in the table, whose highest frequency is 27 rad/s.
    fn drawn(sort: Sort) -> Vec<Mismeasurement> {
        let rng = &mut ChaCha8Rng::seed_from_u64(5);
        let sound = table(0);
        (0..200).map(|_| Mismeasurement::draw(sort, [&sound; 2], &LAW, rng)).collect()
    }

    /// Checks that sizes lie between these two, come near to both and have both signs.
    fn spread(sizes: impl Iterator<Item = f64>, [least, most]: [f64; 2]) {
        let sizes: Vec<f64> = sizes.collect();
        assert!(sizes.iter().any(|size| *size > 0.0) && sizes.iter().any(|size| *size < 0.0));
        let sizes: Vec<f64> = sizes.iter().map(|size| size.abs()).collect();
        let ends = [sizes.iter().copied().fold(f64::INFINITY, f64::min), largest(&sizes)];
        // Rounding of one plus a size.
        assert!(ends[0] > least - 1e-9 && ends[1] < most + 1e-9, "{ends:?}");
        // Of two hundred log-uniform sizes, some fall into each tenth of the range.
        let tenth = (most / least).powf(0.1);
        assert!(ends[0] < least * tenth && ends[1] > most / tenth, "{ends:?}");
    }

    fn largest(sizes: &[f64]) -> f64 {
        sizes.iter().copied().fold(0.0, f64::max)
    }

    #[test]
    fn stated_deviations_are_wrong_by_at_least_a_fifth_and_at_most_threefold() {
        let factors = drawn(Sort::StdFactor).into_iter().map(|fault| match fault {
            Mismeasurement::StdFactor { factor } => factor,
            other => panic!("{other:?}"),
        });
        let factors: Vec<f64> = factors.collect();
        assert!(factors.iter().all(|f| (0.3..0.8).contains(f) || (1.25..3.0 + 1e-9).contains(f)));
        let low = factors.iter().filter(|factor| **factor < 0.8).count();
        // ln(0.8/0.3) of ln(0.8/0.3) + ln(3/1.25) is 53 %: 106 of 200, standard deviation 7.
        assert!((78..=134).contains(&low), "{low}");
    }

    #[test]
    fn gains_and_phases_of_levels_and_experiments_lie_in_their_ranges() {
        let of = |sort: Sort| {
            drawn(sort).into_iter().map(|fault| match fault {
                Mismeasurement::LevelGain { factor, .. }
                | Mismeasurement::RunGain { factor, .. } => factor - 1.0,
                Mismeasurement::LevelPhase { degrees, .. }
                | Mismeasurement::RunPhase { degrees, .. } => degrees,
                other => panic!("{other:?}"),
            })
        };
        spread(of(Sort::LevelGain), [0.02, 0.5]);
        spread(of(Sort::RunGain), [0.02, 0.2]);
        spread(of(Sort::LevelPhase), [2.0, 10.0]);
        spread(of(Sort::RunPhase), [2.0, 10.0]);
    }

    #[test]
    fn every_level_and_every_experiment_can_be_the_wrong_one() {
        for sort in [Sort::LevelGain, Sort::LevelPhase] {
            let found: Vec<f64> =
                drawn(sort).iter().filter_map(Mismeasurement::magnitude).collect();
            assert_eq!(found.len(), 200);
            // A third of 200 is 67, standard deviation 6.7.
            for magnitude in [1.0, 2.0, 4.0] {
                assert!(found.iter().filter(|one| **one == magnitude).count() > 40, "{found:?}");
            }
        }
        for sort in [Sort::RunGain, Sort::RunPhase] {
            let found = drawn(sort);
            let found: Vec<usize> = found.iter().filter_map(Mismeasurement::experiment).collect();
            assert!((0..12).all(|one| found.contains(&one)), "{found:?}");
        }
    }

    #[test]
    fn a_skew_is_2_to_20_degrees_at_the_highest_fundamental() {
        for fault in drawn(Sort::ChannelSkew) {
            let Mismeasurement::ChannelSkew { seconds } = fault else { panic!("{fault:?}") };
            let degrees = (seconds * 27.0).to_degrees();
            assert!((2.0 - 1e-9..20.0 + 1e-9).contains(&degrees), "{degrees}");
        }
    }

    #[test]
    fn one_or_five_rows_in_a_hundred_are_bad() {
        // The table has 12 experiments of 4 harmonics.
        for (sort, count) in [(Sort::OneBadRowInAHundred, 1), (Sort::FiveBadRowsInAHundred, 2)] {
            assert!(drawn(sort).iter().all(|fault| fault.bad_rows().len() == count));
        }
    }
}
