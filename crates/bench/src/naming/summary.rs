//! Summary of a run of the benchmark: rates, confusion tables, calibration and times.

mod calibration;
mod confusion;
mod effects;
#[cfg(test)]
mod fixtures;
mod lines;
mod machines;
mod mismeasured;
mod times;

use serde::Serialize;

use super::case::Kind;
use super::judge::Outcome;
use super::rate::Rate;
pub use calibration::ConfidenceBin;
use calibration::calibration;
use confusion::confusion;
pub use confusion::{Confusion, NONE};
pub use effects::EffectRates;
use effects::effects;
pub use mismeasured::{FaultLine, FaultRates, Faults};
pub use times::Times;
use times::times;

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

#[cfg(test)]
mod tests {
    use servoscope_core::answers::Verdict;

    use super::super::fixtures::outcome;
    use super::fixtures::{machines, outcomes};
    use super::*;
    use crate::naming::rivals::Nearest;

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
    fn a_fault_of_the_measurement_leaves_the_tables_of_other_kinds_as_they_are() {
        let mut drawn = outcomes();
        let before = Summary::of(&drawn);
        let causes = [("cogging", 0.85, &[][..])];
        for key in ["mismeasured-60-spring-o0-0", "mismeasured-60-spring-o1-1"] {
            drawn.push(outcome(key, &["spring"], &causes, Verdict::Improved));
        }
        assert_eq!(Summary::of(&drawn), before);
    }
}
