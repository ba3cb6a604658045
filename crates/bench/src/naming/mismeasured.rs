//! Whether an answer names the fault of a measurement.

mod absorbed;
mod score;

use serde::Serialize;
use servoscope_core::answers::{FaultKind, LeftOutRow, MeasurementFault};

use super::mismeasurement::{Mismeasurement, Mistake, Sort};

/// Magnitudes whose relative difference is at most this are the same.
const SAME_MAGNITUDE: f64 = 1e-6;

/// Excess χ² from which a choice by likelihood between the fault and the machine's own model errs in
/// 2.3 % at most, Φ(−½√excess): see [`super::rivals::Nearest`].
const DISTINCT: f64 = 16.0;

/// The fault of a measurement, and what the answer says of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Mismeasured {
    /// Sort of fault.
    pub sort: Sort,
    /// The kind that should be named.
    pub kind: FaultKind,
    /// What is wrong, in a few words.
    pub text: String,
    /// The fault with its numbers.
    pub fault: Mismeasurement,
    /// Whether it moves a row by more than five true standard deviations, or misstates these.
    pub shows: bool,
    /// Excess χ² that the machine's own model leaves of it without noise; null where that was not
    /// asked for or does not apply, or is far more than counts.
    pub left_by_own_model: Option<f64>,
    /// Whether it is named, or a fault that comes to the same.
    pub named: bool,
    /// Whether the named level or experiment is the right one; null if the fault is not named or has
    /// no such place.
    pub in_place: Option<bool>,
    /// Whether a fault is named that is not there.
    pub another_named: bool,
    /// Bad rows, and rows that the answer leaves out.
    pub rows: RowCounts,
}

/// Numbers of rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct RowCounts {
    /// Bad rows whose residual exceeds five standard deviations.
    pub detectable: u32,
    /// Those of them that are left out.
    pub found: u32,
    /// All rows that are left out.
    pub left_out: u32,
    /// Those of them that have no error.
    pub falsely: u32,
}

impl Mismeasured {
    /// Whether the machine's own model is known not to predict what was measured as well.
    pub(super) fn is_distinct(&self) -> bool {
        self.left_by_own_model.is_some_and(|left| left >= DISTINCT)
    }

    /// Compares the named faults with the true one.
    pub(super) fn of(mistake: &Mistake, found: &[MeasurementFault]) -> Self {
        let Mistake { sort, fault, shows, .. } = mistake;
        let named = found.iter().filter(|one| stands_for(mistake, one)).count();
        let of_kind = found.iter().filter(|one| one.fault == sort.kind());
        Self {
            sort: *sort,
            kind: sort.kind(),
            text: fault.to_string(),
            fault: fault.clone(),
            shows: *shows,
            left_by_own_model: None,
            named: named > 0,
            in_place: of_kind.filter_map(|one| is_in_place(mistake, one)).reduce(|a, b| a || b),
            another_named: named < found.len(),
            rows: rows(fault, found),
        }
    }
}

/// Whether a named fault is the true one, or comes to the same: rows of the wrong experiment alone,
/// or the experiment whose only row is wrong.
fn stands_for(mistake: &Mistake, found: &MeasurementFault) -> bool {
    let is_run = matches!(found.fault, FaultKind::RunGain | FaultKind::RunPhase);
    match (&mistake.fault, mistake.fault.experiment()) {
        _ if found.fault == mistake.sort.kind() => true,
        (_, Some(experiment)) if found.fault == FaultKind::BadRows => {
            let left_out = &found.left_out;
            !left_out.is_empty() && left_out.iter().all(|row| row.experiment == experiment)
        }
        (Mismeasurement::BadRows(rows), _) if is_run => {
            let [row] = rows.as_slice() else { return false };
            let measured = &mistake.sound.experiments()[row.experiment];
            let is_alone = measured.response.len() == 1 && measured.repeats.is_empty();
            is_alone && found.experiment == Some(row.experiment)
        }
        _ => false,
    }
}

/// Whether a fault of the right kind is named at the right level or experiment; `None` if the fault
/// has no such place. Of two experiments, which has the wrong gain cannot be told.
fn is_in_place(mistake: &Mistake, found: &MeasurementFault) -> Option<bool> {
    let Mistake { fault, sound, .. } = mistake;
    let is_either = sound.experiments().len() == 2;
    let is = |experiment| is_either || found.experiment == Some(experiment);
    let run = fault.experiment().map(is);
    let same = |is: f64, named: f64| (named / is - 1.0).abs() <= SAME_MAGNITUDE;
    let level = fault.magnitude().map(|is| found.magnitude.is_some_and(|named| same(is, named)));
    run.or(level)
}

fn rows(fault: &Mismeasurement, found: &[MeasurementFault]) -> RowCounts {
    let left_out: Vec<&LeftOutRow> = found.iter().flat_map(|one| &one.left_out).collect();
    let bad = fault.bad_rows();
    let detectable = || bad.iter().filter(|row| row.is_detectable());
    let is_left_out = |row: &&super::BadRow| left_out.iter().any(|one| row.is(one));
    let is_wrong = |row: &LeftOutRow| {
        bad.iter().any(|one| one.is(row)) || fault.experiment() == Some(row.experiment)
    };
    RowCounts {
        detectable: detectable().count() as u32,
        found: detectable().filter(is_left_out).count() as u32,
        left_out: left_out.len() as u32,
        falsely: left_out.iter().filter(|row| !is_wrong(row)).count() as u32,
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{left_out, mistake};
    use servoscope_core::measurement::{Experiment, Measurement};

    use super::*;
    use crate::naming::mismeasurement::BadRow;

    fn bad(experiment: usize, harmonic: usize, sigmas: f64) -> BadRow {
        BadRow { experiment, harmonic, repeat: None, factor: 1.2, sigmas }
    }

    fn bad_rows(rows: &[BadRow]) -> Mistake {
        mistake(Sort::OneBadRowInAHundred, Mismeasurement::BadRows(rows.into()))
    }

    fn run_gain() -> Mistake {
        mistake(Sort::RunGain, Mismeasurement::RunGain { experiment: 0, factor: 1.1 })
    }

    #[test]
    fn a_fault_is_named_by_its_kind_and_another_is_not() {
        let conjugated = mistake(Sort::Conjugated, Mismeasurement::Conjugated);
        for (named, right, another) in [
            (vec![], false, false),
            (vec![MeasurementFault::of(FaultKind::Conjugated)], true, false),
            (vec![MeasurementFault::of(FaultKind::ReversedSign)], false, true),
            (
                vec![
                    MeasurementFault::of(FaultKind::Conjugated),
                    MeasurementFault::of(FaultKind::StdFactor),
                ],
                true,
                true,
            ),
        ] {
            let found = Mismeasured::of(&conjugated, &named);
            assert_eq!((found.named, found.another_named), (right, another), "{named:?}");
            assert_eq!((found.kind, found.in_place), (FaultKind::Conjugated, None));
        }
    }

    #[test]
    fn rows_of_the_wrong_experiment_alone_stand_for_its_gain_or_phase() {
        let phase = Mismeasurement::RunPhase { experiment: 0, degrees: 3.0 };
        for wrong in [run_gain(), mistake(Sort::RunPhase, phase)] {
            let of = |rows: &[(usize, usize)]| Mismeasured::of(&wrong, &[left_out(rows)]);
            let right = of(&[(0, 1), (0, 3)]);
            assert!(right.named && !right.another_named && right.in_place.is_none());
            assert_eq!(right.rows, RowCounts { left_out: 2, ..RowCounts::default() });
            let mixed = of(&[(0, 1), (1, 3)]);
            assert!(!mixed.named && mixed.another_named);
            assert_eq!(mixed.rows.falsely, 1);
            assert!(!of(&[]).named);
        }
        let level = Mismeasurement::LevelGain { magnitude: 1.0, factor: 1.1 };
        let level = mistake(Sort::LevelGain, level);
        assert!(!Mismeasured::of(&level, &[left_out(&[(0, 1)])]).named);
    }

    #[test]
    fn an_experiment_stands_for_a_bad_row_if_it_has_no_other() {
        let run =
            MeasurementFault { experiment: Some(0), ..MeasurementFault::of(FaultKind::RunGain) };
        let of_eight = bad_rows(&[bad(0, 1, 9.0)]);
        assert!(!Mismeasured::of(&of_eight, std::slice::from_ref(&run)).named);
        let mut alone = of_eight;
        let mut only = alone.sound.experiments()[0].clone();
        only.response.retain(|row| row.order == 1);
        let metadata = alone.sound.metadata().clone();
        alone.sound = Measurement::new(metadata, vec![only], vec![], "".into()).unwrap();
        assert!(Mismeasured::of(&alone, std::slice::from_ref(&run)).named);
        let elsewhere = MeasurementFault { experiment: Some(1), ..run };
        assert!(!Mismeasured::of(&alone, &[elsewhere]).named);
    }

    #[test]
    fn the_place_of_a_level_or_experiment_is_compared() {
        let at = |experiment| MeasurementFault {
            experiment: Some(experiment),
            ..MeasurementFault::of(FaultKind::RunGain)
        };
        assert_eq!(Mismeasured::of(&run_gain(), &[at(0)]).in_place, Some(true));
        assert_eq!(Mismeasured::of(&run_gain(), &[at(1)]).in_place, Some(false));
        assert_eq!(Mismeasured::of(&run_gain(), &[at(1), at(0)]).in_place, Some(true));
        let mut of_two = run_gain();
        let one = of_two.sound.experiments()[0].clone();
        let other = Experiment { omega_rad_s: 2.0 * one.omega_rad_s, ..one.clone() };
        let metadata = of_two.sound.metadata().clone();
        of_two.sound = Measurement::new(metadata, vec![one, other], vec![], "".into()).unwrap();
        assert_eq!(Mismeasured::of(&of_two, &[at(1)]).in_place, Some(true));
        let phase = Mismeasurement::LevelPhase { magnitude: 3.0, degrees: 4.0 };
        let level = mistake(Sort::LevelPhase, phase);
        for (magnitude, right) in [(Some(3.0 + 1e-9), true), (Some(6.0), false), (None, false)] {
            let named =
                MeasurementFault { magnitude, ..MeasurementFault::of(FaultKind::LevelPhase) };
            assert_eq!(Mismeasured::of(&level, &[named]).in_place, Some(right));
        }
    }

    #[test]
    fn bad_rows_are_found_where_they_are_detectable_and_left_out() {
        let wrong = bad_rows(&[bad(0, 1, 9.0), bad(0, 3, 6.0), bad(1, 2, 4.0)]);
        let found = Mismeasured::of(&wrong, &[left_out(&[(0, 1), (1, 2), (1, 5)])]);
        let expected = RowCounts { detectable: 2, found: 1, left_out: 3, falsely: 1 };
        assert_eq!((found.rows, found.named), (expected, true));
    }
}
