//! Rates of measurements with a fault, and of faults named in sound ones.

use serde::Serialize;
use servoscope_core::answers::Verdict;

use super::Wanted;
use crate::naming::judge::{Answer, Outcome};
use crate::naming::mismeasured::{Mismeasured, RowCounts};
use crate::naming::mismeasurement::Sort;
use crate::naming::rate::Rate;
use crate::naming::recording::Recording;

/// How often a fault of one sort is named, and what is said of the machine behind it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaultRates {
    /// Sort of fault.
    pub sort: Sort,
    /// Draws in which it, or one that comes to the same, is named.
    pub named: Rate,
    /// Draws in which another is named.
    pub another: Rate,
    /// Clean draws with the verdict `adequate`.
    pub adequate: Rate,
    /// Clean draws in which an effect is named.
    pub accused: Rate,
    /// Draws with an effect that is first or an equivalent of the first.
    pub first: Rate,
    /// The same of the answers to the measurements without the fault.
    pub first_in_sound_twin: Rate,
}

/// A rate over all sorts of fault, with its target.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FaultLine {
    /// What is counted.
    pub what: &'static str,
    /// The rate.
    pub rate: Rate,
    /// Its target.
    pub wanted: Wanted,
}

/// The faults of measurements.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Faults {
    /// By sort of fault; sorts that were not drawn are left out.
    pub sorts: Vec<FaultRates>,
    /// Over all sorts, as far as there is anything to count.
    pub lines: Vec<FaultLine>,
}

/// A draw and its fault.
type Drawn<'a> = (&'a Outcome, &'a Mismeasured);

/// Counts the faults of all draws.
pub(super) fn faults(outcomes: &[Outcome]) -> Faults {
    let with_fault = outcomes.iter().filter_map(|o| Some((o, o.mismeasurement.as_ref()?)));
    let drawn: Vec<Drawn<'_>> = with_fault.collect();
    let of_sort = |sort: Sort| {
        let drawn: Vec<Drawn<'_>> =
            drawn.iter().copied().filter(|(_, fault)| fault.sort == sort).collect();
        (!drawn.is_empty()).then(|| rates(sort, &drawn))
    };
    let all = lines(outcomes, &drawn);
    Faults {
        sorts: Sort::ALL.into_iter().filter_map(of_sort).collect(),
        lines: all.into_iter().filter(|line| line.rate.of > 0).collect(),
    }
}

fn rates(sort: Sort, drawn: &[Drawn<'_>]) -> FaultRates {
    let outcomes = || drawn.iter().map(|(outcome, _)| *outcome);
    let clean = || outcomes().filter(|outcome| outcome.hidden.is_empty());
    let hidden = || outcomes().filter(|outcome| !outcome.hidden.is_empty());
    FaultRates {
        sort,
        named: Rate::count(drawn.iter().map(|(_, fault)| fault.named)),
        another: Rate::count(drawn.iter().map(|(_, fault)| fault.another_named)),
        adequate: Rate::count(clean().map(|o| o.verdict() == Some(Verdict::Adequate))),
        accused: Rate::count(clean().map(|o| !o.causes().is_empty())),
        first: Rate::count(hidden().map(Outcome::first_or_equivalent)),
        first_in_sound_twin: Rate::count(hidden().filter_map(Outcome::first_in_sound_twin)),
    }
}

fn lines(outcomes: &[Outcome], drawn: &[Drawn<'_>]) -> Vec<FaultLine> {
    let faults = || drawn.iter().map(|(_, fault)| *fault);
    let suspected = |wanted_sort: Option<Sort>| {
        let is_of = move |fault: &Mismeasured| wanted_sort.is_none_or(|sort| sort == fault.sort);
        let clean = drawn.iter().filter(|(outcome, _)| outcome.hidden.is_empty());
        Rate::count(clean.filter(|drawn| is_of(drawn.1)).map(|(o, _)| !o.is_without_suspicion()))
    };
    let behind =
        drawn.iter().filter(|(o, _)| !o.hidden.is_empty() && o.first_in_sound_twin() == Some(true));
    let twins = drawn.iter().filter_map(|(o, _)| o.sound.as_ref()?.as_ref().ok());
    let others = outcomes.iter().filter(|o| !o.kind.is_mismeasured() && o.answer.is_ok());
    let is_held = |o: &&Outcome| o.instrument.recording == Some(Recording::Held);
    let (held, sound): (Vec<&Outcome>, Vec<&Outcome>) = others.partition(is_held);
    let rows = |count: fn(&RowCounts) -> u32, of: fn(&RowCounts) -> u32| Rate {
        hits: faults().map(|fault| count(&fault.rows)).sum(),
        of: faults().map(|fault| of(&fault.rows)).sum(),
    };
    let line = |what, wanted, rate| FaultLine { what, rate, wanted };
    let nothing = Wanted::Nothing;
    vec![
        line("fault named", nothing, Rate::count(faults().map(|fault| fault.named))),
        line(
            "fault named that shows in some row",
            nothing,
            Rate::count(faults().filter(|fault| fault.shows).map(|fault| fault.named)),
        ),
        line(
            "… that the machine's own model cannot predict as well",
            nothing,
            Rate::count(faults().filter(|fault| fault.is_distinct()).map(|fault| fault.named)),
        ),
        line(
            "… at the right level or experiment",
            nothing,
            Rate::count(faults().filter_map(|fault| fault.in_place)),
        ),
        line(
            "another fault named",
            nothing,
            Rate::count(faults().map(|fault| fault.another_named)),
        ),
        line("detectable bad rows left out", nothing, rows(|r| r.found, |r| r.detectable)),
        line("rows left out that are not bad", nothing, rows(|r| r.falsely, |r| r.left_out)),
        line("clean: a cause, unexplained or no answer", nothing, suspected(None)),
        line("clean, std_factor: the same", Wanted::AtMost(0.02), suspected(Some(Sort::StdFactor))),
        line(
            "effect first or an equivalent, if so without the fault",
            Wanted::AtLeast(0.95),
            Rate::count(behind.map(|(outcome, _)| outcome.first_or_equivalent())),
        ),
        line(
            "without the fault: a fault named",
            Wanted::AtMost(0.01),
            Rate::count(twins.map(Answer::names_a_fault)),
        ),
        line(
            "sound draws of other kinds: a fault named",
            Wanted::AtMost(0.01),
            Rate::count(sound.iter().map(|o| o.names_a_fault())),
        ),
        line(
            "recorded with a held input: that it is held",
            nothing,
            Rate::count(held.iter().map(|o| o.names_held_input())),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{FaultKind, MeasurementFault};

    use super::*;
    use crate::naming::fixtures::{left_out, mistake, outcome};
    use crate::naming::mismeasurement::{BadRow, Mismeasurement};

    fn with(
        outcome: Outcome,
        sort: Sort,
        fault: Mismeasurement,
        named: &[MeasurementFault],
    ) -> Outcome {
        let mismeasurement = Some(Mismeasured::of(&mistake(sort, fault), named));
        let sound = Some(outcome.answer.clone());
        Outcome { mismeasurement, sound, ..outcome }
    }

    /// A clean draw with a factor of the standard deviation and this verdict.
    fn clean(verdict: Verdict, named: &[MeasurementFault]) -> Outcome {
        let outcome = outcome("mismeasured-60-o0-2", &[], &[], verdict);
        with(outcome, Sort::StdFactor, Mismeasurement::StdFactor { factor: 2.0 }, named)
    }

    /// A draw with a spring and bad rows, with the causes named with and without them.
    fn sprung(causes: &[(&str, f64, &[&str])], sound: &[(&str, f64, &[&str])]) -> Outcome {
        let rows = [(0, 1), (0, 3), (1, 1)].map(|(experiment, harmonic)| BadRow {
            experiment,
            harmonic,
            repeat: None,
            factor: 1.1,
            sigmas: 8.0,
        });
        let of =
            |causes| outcome("mismeasured-60-spring-o0-0", &["spring"], causes, Verdict::Explained);
        let (sort, fault) = (Sort::OneBadRowInAHundred, Mismeasurement::BadRows(rows.into()));
        let found = with(of(causes), sort, fault, &[left_out(&[(0, 1), (0, 3), (7, 7)])]);
        Outcome { sound: Some(of(sound).answer), ..found }
    }

    fn line(faults: &Faults, what: &str) -> (u32, u32, Option<bool>) {
        let found = faults.lines.iter().find(|line| line.what == what);
        let FaultLine { rate, wanted, .. } = found.unwrap_or_else(|| panic!("{what}"));
        (rate.hits, rate.of, wanted.met_by(rate))
    }

    #[test]
    fn each_sort_of_fault_has_a_row_with_what_is_clean_and_what_hides_an_effect() {
        let spring = [("spring", 0.9, &[][..])];
        let faults = faults(&[
            sprung(&spring, &spring),
            sprung(&[], &spring),
            clean(Verdict::Adequate, &[MeasurementFault::of(FaultKind::StdFactor)]),
            clean(Verdict::Unexplained, &[MeasurementFault::of(FaultKind::RunGain)]),
        ]);
        let rate = |hits, of| Rate { hits, of };
        let [rows, std] = &faults.sorts[..] else { panic!("{:?}", faults.sorts) };
        let expected = FaultRates {
            sort: Sort::OneBadRowInAHundred,
            named: rate(2, 2),
            another: rate(0, 2),
            adequate: rate(0, 0),
            accused: rate(0, 0),
            first: rate(1, 2),
            first_in_sound_twin: rate(2, 2),
        };
        assert_eq!(rows, &expected);
        assert_eq!((std.sort, std.named, std.another), (Sort::StdFactor, rate(1, 2), rate(1, 2)));
        assert_eq!((std.adequate, std.accused, std.first), (rate(1, 2), rate(0, 2), rate(0, 0)));
    }

    #[test]
    fn totals_count_rows_suspicions_and_effects_behind_the_fault_against_their_targets() {
        let spring = [("spring", 0.9, &[][..])];
        let mut found = vec![
            sprung(&spring, &spring),
            sprung(&[], &spring),
            sprung(&spring, &[]),
            clean(Verdict::Adequate, &[MeasurementFault::of(FaultKind::StdFactor)]),
            clean(Verdict::Unexplained, &[]),
        ];
        if let Some(fault) = &mut found[4].mismeasurement {
            fault.shows = false;
        }
        let faults = faults(&found);
        assert_eq!(line(&faults, "fault named"), (4, 5, None));
        assert_eq!(line(&faults, "fault named that shows in some row"), (4, 4, None));
        assert_eq!(line(&faults, "detectable bad rows left out"), (6, 9, None));
        assert_eq!(line(&faults, "rows left out that are not bad"), (3, 9, None));
        assert_eq!(line(&faults, "clean: a cause, unexplained or no answer"), (1, 2, None));
        assert_eq!(line(&faults, "clean, std_factor: the same"), (1, 2, Some(false)));
        let behind = "effect first or an equivalent, if so without the fault";
        assert_eq!(line(&faults, behind), (1, 2, Some(false)));
        assert_eq!(line(&faults, "without the fault: a fault named"), (0, 5, Some(true)));
        let nothing = |line: &FaultLine| line.what.starts_with("sound draws");
        assert!(!faults.lines.iter().any(nothing), "no sound draws");
    }

    #[test]
    fn a_fault_named_in_a_sound_draw_of_another_kind_is_false() {
        let sound = outcome("clean-60-o0-0", &[], &[], Verdict::Adequate);
        let mut accused = sound.clone();
        if let Ok(answer) = &mut accused.answer {
            answer.faults.push(FaultKind::LevelGain);
        }
        let faults = faults(&[sound, accused, clean(Verdict::Adequate, &[])]);
        let what = "sound draws of other kinds: a fault named";
        assert_eq!(line(&faults, what), (1, 2, Some(false)));
    }

    #[test]
    fn that_an_input_is_held_is_true_of_a_record_whose_input_is() {
        let mut missed = outcome("analyser-record-60-o0-0", &[], &[], Verdict::Adequate);
        missed.instrument.recording = Some(Recording::Held);
        let mut named = missed.clone();
        if let Ok(answer) = &mut named.answer {
            answer.faults.push(FaultKind::HeldInput);
        }
        let faults = faults(&[missed, named]);
        assert_eq!(line(&faults, "recorded with a held input: that it is held"), (1, 2, None));
        assert!(faults.lines.iter().all(|line| !line.what.starts_with("sound draws")));
    }
}
