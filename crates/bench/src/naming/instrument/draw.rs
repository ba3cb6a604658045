//! The instrument of a draw.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::{Harmonics, Instrument, NoiseSaid};
use crate::machines::draw::log_uniform;
use crate::machines::noise::RelativeNoise;
use crate::naming::case::{Case, Kind};
use crate::naming::mismeasurement::Sort;
use crate::naming::recording::Recording;

/// Number of repeats of a measurement that has repeats, except for analysers.
const REPEATS: usize = 6;
/// Largest difference of an analyser's floor from the level of its draw, dB.
const FLOOR_RANGE_DB: f64 = 10.0;

impl Instrument {
    /// The instrument of a draw. That of an analyser is random:
    ///
    /// | quantity | range |
    /// | --- | --- |
    /// | magnitudes | 1 … 3, uniform; each twice the one before |
    /// | frequencies at each | 10 … 60, uniform; log-spaced over the band of the machine |
    /// | harmonics | fundamentals alone, 0 to 3 or 0 to 7, a third each |
    /// | floor of the noise | within 10 dB of the level of the draw, uniform in dB |
    /// | share of the value | 0.1 … 1 %, log-uniform |
    /// | said of it | nothing (half), 3 … 6 repeats (a quarter), a coherence (a quarter) |
    ///
    /// Others measure at the points of the machine, harmonics 0 to 7 and with noise of the level of
    /// the draw. They state its standard deviation; every fifth has repeats instead, unless its
    /// fault is what it states. What is recorded has a random [`Recording`].
    pub(in crate::naming) fn of(case: &Case, rng: &mut ChaCha8Rng) -> Self {
        let level_db = f64::from(case.level_db);
        if case.kind != Kind::Analyser {
            let is_recorded = case.kind.is_recorded();
            let must_state_std = Sort::of(case) == Some(Sort::StdFactor);
            let has_repeats = case.index % 5 == 4 && !is_recorded && !must_state_std;
            return Self {
                points: None,
                harmonics: Harmonics::UpTo(7),
                noise: RelativeNoise::decibels(level_db),
                said: if has_repeats { NoiseSaid::Repeats(REPEATS) } else { NoiseSaid::Std },
                recording: is_recorded.then(|| recording(case, rng)),
            };
        }
        let points = [rng.random_range(1..=3), rng.random_range(10..=60)];
        let harmonics = match rng.random_range(0..3) {
            0 => Harmonics::Fundamentals,
            1 => Harmonics::UpTo(3),
            _ => Harmonics::UpTo(7),
        };
        let noise = RelativeNoise {
            floor_db: level_db + rng.random_range(-FLOOR_RANGE_DB..=FLOOR_RANGE_DB),
            share: log_uniform(0.001, 0.01, rng),
        };
        let said = match rng.random_range(0..4) {
            0 | 1 => NoiseSaid::Nothing,
            2 => NoiseSaid::Repeats(rng.random_range(3..=6)),
            _ => NoiseSaid::Coherence,
        };
        Self { points: Some(points), harmonics, noise, said, recording: None }
    }
}

/// Any recording. A held input is a fault itself, so that one with another fault is not held; another
/// gain or phase of one experiment needs several; and of responses only velocities are said to clip.
fn recording(case: &Case, rng: &mut ChaCha8Rng) -> Recording {
    let fits = |recording: &Recording| match Sort::of(case) {
        None => true,
        Some(Sort::RunGain | Sort::RunPhase) => {
            matches!(recording, Recording::Multisine { levels: 2.. })
        }
        Some(Sort::ClippedResponse) => {
            matches!(recording, Recording::Multisine { .. } | Recording::Sweep)
        }
        Some(_) => *recording != Recording::Held,
    };
    let all: Vec<Recording> = Recording::ALL.into_iter().filter(fits).collect();
    all[rng.random_range(0..all.len())]
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::naming::Plan;

    fn instrument(key: &str) -> Instrument {
        let case: Case = key.parse().unwrap();
        Instrument::of(&case, &mut case.rng(1))
    }

    fn analysers() -> Vec<Instrument> {
        (0..400).map(|index| instrument(&format!("analyser-70-o0-{index}"))).collect()
    }

    #[test]
    fn a_record_with_a_fault_is_of_any_kind_but_held() {
        let of = |kind: &str| {
            let recording = |index: u32| instrument(&format!("{kind}-60-o0-{index}")).recording;
            let all: HashSet<String> =
                (0..100).map(|index| recording(index).unwrap().to_string()).collect();
            (all.len(), all.contains(&Recording::Held.to_string()))
        };
        assert_eq!(of("mismeasured-record"), (Recording::ALL.len() - 1, false));
        assert_eq!(of("analyser-record"), (Recording::ALL.len(), true));
    }

    #[test]
    fn a_record_with_another_gain_or_phase_of_one_experiment_has_two() {
        for index in 0..100 {
            let case: Case = format!("mismeasured-record-60-o0-{index}").parse().unwrap();
            let recording = Instrument::of(&case, &mut case.rng(1)).recording.unwrap();
            let is_of_two = recording == Recording::Multisine { levels: 2 };
            let is_of_one = matches!(Sort::of(&case), Some(Sort::RunGain | Sort::RunPhase));
            assert!(!is_of_one || is_of_two, "{recording}");
        }
    }

    #[test]
    fn analysers_differ_in_all_that_can_be_drawn_of_them() {
        let all = analysers();
        let share = |what: fn(&Instrument) -> bool| {
            all.iter().filter(|one| what(one)).count() as f64 / all.len() as f64
        };
        // The standard deviation of a share of 400 is at most 2.5 %; 4 times that.
        for (found, expected) in [
            (share(|one| one.harmonics == Harmonics::Fundamentals), 1.0 / 3.0),
            (share(|one| one.harmonics == Harmonics::UpTo(3)), 1.0 / 3.0),
            (share(|one| one.said == NoiseSaid::Nothing), 0.5),
            (share(|one| one.said == NoiseSaid::Coherence), 0.25),
            (share(|one| matches!(one.said, NoiseSaid::Repeats(3..=6))), 0.25),
            (share(|one| one.noise.floor_db < 70.0), 0.5),
            (share(|one| one.noise.share < 0.001 * 10.0_f64.sqrt()), 0.5),
        ] {
            assert!((found - expected).abs() < 0.1, "{found} for {expected}");
        }
        for Instrument { points, noise, .. } in all {
            let [magnitudes, frequencies] = points.unwrap();
            assert!((1..=3).contains(&magnitudes) && (10..=60).contains(&frequencies));
            assert!((60.0..=80.0).contains(&noise.floor_db), "{noise:?}");
            assert!((0.001..=0.01 + 1e-12).contains(&noise.share), "{noise:?}");
        }
    }

    #[test]
    fn other_draws_have_the_noise_of_their_level_and_every_fifth_has_repeats() {
        let cases = Plan::default().cases();
        let all: Vec<Instrument> =
            cases.iter().map(|case| Instrument::of(case, &mut case.rng(1))).collect();
        for (case, one) in cases.iter().zip(&all) {
            assert_eq!(one.noise, RelativeNoise::decibels(f64::from(case.level_db)));
            assert_eq!((one.points, one.harmonics), (None, Harmonics::UpTo(7)));
        }
        let repeats = all.iter().filter(|one| one.said == NoiseSaid::Repeats(6)).count();
        assert_eq!(repeats, cases.len() / 5);
    }

    #[test]
    fn a_wrong_statement_of_the_noise_needs_one() {
        // Index 54 would have repeats, and its fault is a factor of the standard deviation.
        let said = |key: &str| instrument(key).said;
        assert_eq!(said("mismeasured-60-o0-54"), NoiseSaid::Std);
        assert_eq!(said("mismeasured-60-o0-59"), NoiseSaid::Repeats(6));
    }
}
