//! Summary of a run of the benchmark: rates, confusion tables, calibration and times.

mod calibration;
mod lines;
mod machines;
mod mismeasured;

use std::collections::BTreeMap;

use serde::Serialize;

use super::case::Kind;
use super::judge::Outcome;
use super::rate::Rate;
pub use calibration::ConfidenceBin;
use calibration::calibration;
pub use mismeasured::{FaultLine, FaultRates, Faults};

/// Bounds of the bins of the excess.
const EXCESS_BOUNDS: [f64; 4] = [120.0, 1_200.0, 12_000.0, 120_000.0];
/// Row of clean draws, and column of draws in which nothing is named, in a confusion table.
pub const NONE: &str = "none";

/// The target of a rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Wanted {
    /// At least this share.
    AtLeast(f64),
    /// At most this share.
    AtMost(f64),
    /// A share between these two.
    Between([f64; 2]),
    /// No target; the rate is only reported.
    Nothing,
}

impl Wanted {
    /// Whether a rate meets the target; `None` if nothing was counted or there is no target.
    pub fn met_by(&self, rate: &Rate) -> Option<bool> {
        let share = rate.share()?;
        match *self {
            Self::AtLeast(least) => Some(share >= least),
            Self::AtMost(most) => Some(share <= most),
            Self::Between([least, most]) => Some((least..=most).contains(&share)),
            Self::Nothing => None,
        }
    }
}

/// A rate with its target.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// Kind of draw.
    pub kind: Kind,
    /// Noise, dB; null for all levels together.
    pub level_db: Option<u32>,
    /// What is counted.
    pub what: &'static str,
    /// The rate.
    pub rate: Rate,
    /// Its target.
    pub wanted: Wanted,
}

/// How often a hidden effect is named first, by the size of its excess.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectRates {
    /// Kind of draw: single, analyser, or machine, of which the dominant effect counts.
    pub kind: Kind,
    /// The effect.
    pub effect: &'static str,
    /// Noise, dB.
    pub level_db: u32,
    /// Rate over all draws.
    pub all: Rate,
    /// Rates by decade of the excess, from 120 upwards.
    pub by_decade: [Rate; 3],
}

/// Confusion table at one noise level: hidden effects (rows; in a machine the dominant one) against
/// first named causes (columns).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Confusion {
    /// Noise, dB.
    pub level_db: u32,
    /// (hidden, first named) → number of draws.
    #[serde(serialize_with = "as_rows")]
    pub counts: BTreeMap<(String, String), u32>,
}

fn as_rows<S: serde::Serializer>(
    counts: &BTreeMap<(String, String), u32>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(counts.iter().map(|((hidden, named), count)| (hidden, named, count)))
}

/// Median and 95th percentile, s.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Times {
    /// Median.
    pub median: f64,
    /// 95th percentile.
    pub p95: f64,
}

/// Summary of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Rates with their targets.
    pub lines: Vec<Line>,
    /// Rates of draws of one effect by effect, noise level and excess.
    pub effects: Vec<EffectRates>,
    /// Confusion tables of all draws of one effect or none, but those with a fault of the
    /// measurement, by noise level.
    pub confusions: Vec<Confusion>,
    /// Causes of all draws but those with a fault of the measurement, by confidence.
    pub calibration: Vec<ConfidenceBin>,
    /// Faults of measurements.
    pub faults: Faults,
    /// Times to make a draw.
    pub data_seconds: Times,
    /// Times to diagnose a draw.
    pub job_seconds: Times,
}

impl Summary {
    /// Counts the outcomes of a run.
    pub fn of(outcomes: &[Outcome]) -> Self {
        let mut levels: Vec<u32> = outcomes.iter().map(|outcome| outcome.level_db).collect();
        levels.sort_unstable_by(|left, right| right.cmp(left));
        levels.dedup();
        Self {
            lines: lines::lines(outcomes, &levels),
            effects: effects(outcomes, &levels),
            confusions: levels.iter().map(|level| confusion(outcomes, *level)).collect(),
            calibration: calibration(outcomes),
            faults: mismeasured::faults(outcomes),
            data_seconds: times(outcomes.iter().map(|outcome| outcome.seconds.data)),
            job_seconds: times(outcomes.iter().map(|outcome| outcome.seconds.job)),
        }
    }
}

fn effects(outcomes: &[Outcome], levels: &[u32]) -> Vec<EffectRates> {
    let mut rates: Vec<EffectRates> = Vec::new();
    for level_db in levels {
        let of_one = |o: &&Outcome| {
            let of_one = matches!(o.kind, Kind::Single | Kind::Analyser | Kind::AnalyserRecord)
                || o.kind.dominant() == 1;
            of_one && o.level_db == *level_db
        };
        for outcome in outcomes.iter().filter(of_one) {
            let Some(hidden) = outcome.dominant().next() else { continue };
            let row = (outcome.kind, hidden.effect, *level_db);
            let same = |r: &EffectRates| (r.kind, r.effect, r.level_db) == row;
            let place = rates.iter().position(same).unwrap_or_else(|| {
                let (all, by_decade) = Default::default();
                let (kind, effect, level_db) = row;
                rates.push(EffectRates { kind, effect, level_db, all, by_decade });
                rates.len() - 1
            });
            let right = outcome.named_first();
            rates[place].all.add(right);
            // An excess may exceed its target by 10 %, so the last bin has no upper bound.
            let decade =
                EXCESS_BOUNDS[1..3].iter().filter(|bound| outcome.excess >= **bound).count();
            rates[place].by_decade[decade].add(right);
        }
    }
    rates
}

fn confusion(outcomes: &[Outcome], level_db: u32) -> Confusion {
    let mut counts = BTreeMap::new();
    let of_one = |o: &&Outcome| {
        o.level_db == level_db && o.dominant().count() < 2 && o.kind != Kind::Mismeasured
    };
    for outcome in outcomes.iter().filter(of_one) {
        let hidden = outcome.dominant().next().map_or(NONE, |hidden| hidden.effect);
        let named = outcome.causes().first().map_or(NONE, |first| &first.effect);
        *counts.entry((hidden.to_owned(), named.to_owned())).or_insert(0) += 1;
    }
    Confusion { level_db, counts }
}

fn times(seconds: impl Iterator<Item = f64>) -> Times {
    let mut sorted: Vec<f64> = seconds.collect();
    sorted.sort_by(f64::total_cmp);
    // The smallest value that is at least as large as `percent` percent of the values.
    let percentile = |percent: usize| {
        let rank = (percent * sorted.len()).div_ceil(100).max(1);
        sorted.get(rank - 1).copied().unwrap_or_default()
    };
    Times { median: percentile(50), p95: percentile(95) }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::Verdict;

    use super::super::fixtures::{machine, outcome};
    use super::*;
    use crate::naming::rivals::Nearest;

    fn outcomes() -> Vec<Outcome> {
        let explained = Verdict::Explained;
        vec![
            outcome("single-60-spring-o0-0", &["spring"], &[("spring", 0.995, &[])], explained),
            outcome("single-60-spring-o0-1", &["spring"], &[("cogging", 0.85, &[])], explained),
            outcome("single-40-spring-o0-0", &["spring"], &[], Verdict::Unexplained),
            outcome("clean-60-o0-0", &[], &[], Verdict::Adequate),
            outcome("clean-60-o1-1", &[], &[("stribeck", 0.85, &[])], Verdict::Improved),
            outcome(
                "pair-60-o0-0",
                &["spring", "stribeck"],
                &[("spring", 1.0, &[]), ("stribeck", 0.85, &[])],
                explained,
            ),
            outcome("outsider-60-o0-0", &["cubic_drag"], &[("spring", 0.95, &[])], explained),
            outcome("analyser-70-o0-0", &[], &[], Verdict::Unexplained),
            outcome("analyser-70-o1-1", &[], &[], Verdict::Adequate),
            outcome(
                "analyser-70-spring-o0-0",
                &["spring"],
                &[("hardening_spring", 0.4, &["spring"])],
                explained,
            ),
            outcome("analyser-70-spring-o1-1", &["spring"], &[("cogging", 0.4, &[])], explained),
            outcome("analyser-70-spring-o2-2", &["spring"], &[], Verdict::Unexplained),
        ]
    }

    /// Machines with small effects.
    fn machines() -> Vec<Outcome> {
        let hidden = ["spring", "stribeck", "cubic_drag", "cogging"];
        let of_one = |key: &str, causes| machine(key, 1, &hidden, causes);
        vec![
            of_one("machine-60-spring-o0-0", &[("spring", 0.9, &[]), ("stribeck", 0.6, &[])]),
            of_one("machine-50-spring-o0-0", &[("backlash", 0.85, &[]), ("spring", 0.4, &[])]),
            machine(
                "machine-2-60-o0-0",
                2,
                &hidden,
                &[("stribeck", 0.9, &[]), ("spring", 0.3, &[])],
            ),
        ]
    }

    fn line(summary: &Summary, kind: Kind, level_db: Option<u32>, what: &str) -> Line {
        let same = |l: &&Line| (l.kind, l.level_db, l.what) == (kind, level_db, what);
        summary.lines.iter().find(same).unwrap_or_else(|| panic!("{kind:?} {what}")).clone()
    }

    #[test]
    fn rates_are_counted_by_kind_and_level_against_what_is_asked() {
        let summary = Summary::of(&outcomes());
        for (kind, level, what, hits, of, met) in [
            (Kind::Single, Some(60), "named first", 1, 2, Some(false)),
            (Kind::Single, Some(60), "explained", 2, 2, Some(true)),
            (Kind::Single, Some(40), "explained", 0, 1, Some(false)),
            (Kind::Clean, None, "something named", 1, 2, Some(false)),
            (Kind::Clean, Some(60), "something named", 1, 2, None),
            (Kind::Pair, Some(60), "both and nothing else", 1, 1, Some(true)),
            (Kind::Outsider, None, "explained by a wrong name", 1, 1, Some(false)),
            (Kind::Outsider, None, "a cause at 0.9 or more", 1, 1, Some(false)),
            (Kind::Analyser, None, "clean: a name, unexplained or no answer", 1, 2, Some(false)),
            (Kind::Analyser, None, "first or an equivalent", 1, 3, Some(false)),
            (Kind::Analyser, None, "a name that is neither", 1, 3, Some(false)),
        ] {
            let line = line(&summary, kind, level, what);
            assert_eq!(
                (line.rate, line.wanted.met_by(&line.rate)),
                (Rate { hits, of }, met),
                "{kind:?} {what}"
            );
        }
        assert!(summary.lines.iter().all(|l| (l.kind, l.level_db) != (Kind::Pair, Some(40))));
    }

    #[test]
    fn first_names_are_counted_by_how_near_a_rival_comes() {
        let near = |excess: f64, named: &str| {
            let causes = [(named, 0.9, &[][..])];
            let key = "single-60-spring-o0-0";
            let outcome = outcome(key, &["spring"], &causes, Verdict::Explained);
            let nearest = Some(Nearest { effect: "hardening_spring".into(), excess });
            Outcome { nearest, ..outcome }
        };
        let outcomes = [near(-1e-9, "cogging"), near(3.9, "spring"), near(70.0, "spring")];
        let summary = Summary::of(&outcomes);
        let counted = |what: &str| line(&summary, Kind::Single, None, what).rate;
        assert_eq!(counted("named first, a rival's excess below 4"), Rate { hits: 1, of: 2 });
        assert_eq!(counted("named first, every rival's 64 or more"), Rate { hits: 1, of: 1 });
        let between = |l: &Line| l.what.ends_with("4 to 16");
        assert!(!summary.lines.iter().any(between), "nothing to count");
    }

    #[test]
    fn confidence_is_compared_with_the_share_that_is_right() {
        let calibration = Summary::of(&outcomes()).calibration;
        let counted: Vec<Rate> = calibration.iter().map(|bin| bin.right).collect();
        let rate = |hits, of| Rate { hits, of };
        // From 0.8 to 0.9: a wrong cogging, a wrong stribeck in a clean draw and a right stribeck.
        assert_eq!(counted, [rate(0, 2), rate(0, 0), rate(1, 3), rate(0, 1), rate(2, 2)]);
        assert!((calibration[2].mean.unwrap() - 0.85).abs() < 1e-12);
        let met: Vec<_> = calibration.iter().map(|bin| bin.wanted.met_by(&bin.right)).collect();
        assert_eq!(met, [None, None, Some(false), None, None]);
    }

    #[test]
    fn machines_are_counted_by_their_dominant_effects() {
        let summary = Summary::of(&machines());
        for (kind, level, what, hits, of, met) in [
            (Kind::Machine, None, "first or an equivalent", 1, 2, Some(false)),
            (Kind::Machine, Some(60), "first or an equivalent", 1, 1, None),
            (Kind::Machine, None, "a name at 0.8 or more that is not in it", 1, 2, Some(false)),
            (Kind::Machine, None, "the dominant effect at 0.8 or more", 1, 2, Some(false)),
            (Kind::MachinePair, None, "both named", 1, 1, Some(true)),
            (Kind::MachinePair, None, "both dominant effects at 0.8 or more", 0, 1, None),
        ] {
            let line = line(&summary, kind, level, what);
            assert_eq!(
                (line.rate, line.wanted.met_by(&line.rate)),
                (Rate { hits, of }, met),
                "{kind:?} {what}"
            );
        }
        let row = &summary.effects[0];
        assert_eq!(
            (row.kind, row.effect, row.all),
            (Kind::Machine, "spring", Rate { hits: 1, of: 1 })
        );
        let counted: u32 = summary.confusions.iter().flat_map(|c| c.counts.values()).sum();
        assert_eq!(counted, 2, "two dominant effects have no single row");
    }

    #[test]
    fn confusions_have_a_row_and_a_column_for_nothing() {
        let summary = Summary::of(&outcomes());
        let [_, loud, quiet] = &summary.confusions[..] else { panic!("three levels") };
        assert_eq!((loud.level_db, quiet.level_db), (60, 40));
        let count = |of: &Confusion, hidden: &str, named: &str| {
            of.counts.get(&(hidden.to_owned(), named.to_owned())).copied().unwrap_or_default()
        };
        assert_eq!(count(loud, "spring", "cogging"), 1);
        assert_eq!(count(loud, "none", "stribeck"), 1);
        assert_eq!(count(quiet, "spring", "none"), 1);
        assert_eq!(loud.counts.values().sum::<u32>(), 5, "pairs have no single row");
    }

    #[test]
    fn a_fault_of_the_measurement_leaves_the_tables_of_other_kinds_as_they_are() {
        let mut drawn = outcomes();
        let before = Summary::of(&drawn);
        let causes = [("cogging", 0.85, &[][..])];
        for key in ["mismeasured-60-spring-o0-0", "mismeasured-60-spring-o1-1"] {
            drawn.push(outcome(key, &["spring"], &causes, Verdict::Improved));
        }
        assert_eq!(Summary::of(&drawn), before);
    }

    #[test]
    fn rates_of_an_effect_fall_into_decades_of_excess() {
        let mut drawn = outcomes();
        drawn[0].excess = 50_000.0;
        drawn[1].excess = 120.0;
        let effects = Summary::of(&drawn).effects;
        let [analysers, springs, ..] = &effects[..] else { panic!("two rows") };
        let row = |rates: &EffectRates| (rates.kind, rates.effect, rates.level_db);
        assert_eq!(row(springs), (Kind::Single, "spring", 60));
        assert_eq!(row(analysers), (Kind::Analyser, "spring", 70));
        assert_eq!(analysers.all, Rate { hits: 0, of: 3 });
        let hits = springs.by_decade.map(|rate| (rate.hits, rate.of));
        assert_eq!(hits, [(0, 1), (0, 0), (1, 1)]);
    }

    #[test]
    fn percentiles_are_values_that_occurred() {
        let hundred = (1..=100).map(f64::from);
        assert_eq!(times(hundred), Times { median: 50.0, p95: 95.0 });
        assert_eq!(times([3.0].into_iter()), Times { median: 3.0, p95: 3.0 });
        assert_eq!(times(std::iter::empty()), Times::default());
    }
}
