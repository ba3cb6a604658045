//! What counts as right of a machine whose measurement has a fault.

use servoscope_core::answers::{FaultKind, Verdict};

use super::Mismeasured;
use crate::naming::judge::{Answer, Outcome};

impl Outcome {
    /// Whether any fault of the measurement is named.
    pub fn names_a_fault(&self) -> bool {
        self.answer.as_ref().is_ok_and(Answer::names_a_fault)
    }

    /// Whether it is named that the input of a record is held.
    pub fn names_held_input(&self) -> bool {
        self.answer.as_ref().is_ok_and(|answer| answer.faults.contains(&FaultKind::HeldInput))
    }

    /// Whether the machine is taken for sound: nothing is named, and the verdict is not
    /// `unexplained`.
    pub fn is_without_suspicion(&self) -> bool {
        self.answer.is_ok()
            && self.causes().is_empty()
            && self.verdict() != Some(Verdict::Unexplained)
    }

    /// As [`Outcome::first_or_equivalent`], in the answer to the measurement without its fault;
    /// `None` if that was not diagnosed.
    pub fn first_in_sound_twin(&self) -> Option<bool> {
        let sound = self.sound.as_ref()?;
        let causes = sound.as_ref().map_or(&[][..], |answer| &answer.causes);
        Some(self.is_first_or_equivalent(causes))
    }

    /// Whether the fault of the measurement is named if it shows, no other fault is, and the answer
    /// is as good as that to the measurement without it: a clean machine is without suspicion, a
    /// hidden effect first or an equivalent of the first unless it is not so without the fault.
    pub(in crate::naming) fn is_right_despite_fault(&self) -> bool {
        let is_told = |found: &Mismeasured| (found.named || !found.shows) && !found.another_named;
        self.mismeasurement.as_ref().is_some_and(is_told)
            && if self.hidden.is_empty() {
                self.is_without_suspicion()
            } else {
                self.first_or_equivalent() || self.first_in_sound_twin() == Some(false)
            }
    }
}

impl Answer {
    /// Whether any fault of the measurement is named.
    pub fn names_a_fault(&self) -> bool {
        !self.faults.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::{FaultKind, MeasurementFault};

    use super::*;
    use crate::naming::fixtures::{mistake, outcome};
    use crate::naming::mismeasurement::{Mismeasurement, Sort};

    #[test]
    fn an_answer_is_right_if_it_names_the_fault_and_is_as_good_as_without_it() {
        let conjugated = mistake(Sort::Conjugated, Mismeasurement::Conjugated);
        let named =
            Some(Mismeasured::of(&conjugated, &[MeasurementFault::of(FaultKind::Conjugated)]));
        let clean = |causes: &[(&str, f64, &[&str])], verdict, mismeasurement| Outcome {
            mismeasurement,
            ..outcome("mismeasured-60-o0-7", &[], causes, verdict)
        };
        assert!(clean(&[], Verdict::Adequate, named.clone()).is_right());
        assert!(!clean(&[], Verdict::Unexplained, named.clone()).is_right());
        assert!(!clean(&[("spring", 0.5, &[])], Verdict::Improved, named.clone()).is_right());
        let silent = Some(Mismeasured::of(&conjugated, &[]));
        assert!(!clean(&[], Verdict::Adequate, silent.clone()).is_right());
        let hidden = silent.map(|found| Mismeasured { shows: false, ..found });
        assert!(clean(&[], Verdict::Adequate, hidden).is_right());

        let of = |causes: &[(&str, f64, &[&str])]| {
            let key = "mismeasured-60-spring-o0-7";
            outcome(key, &["spring"], causes, Verdict::Improved)
        };
        let right = of(&[("spring", 0.9, &[])]);
        for (answer, twin, expected) in
            [(&right, &right, true), (&of(&[]), &right, false), (&of(&[]), &of(&[]), true)]
        {
            let mismeasurement = named.clone();
            let sound = Some(twin.answer.clone());
            let found = Outcome { mismeasurement, sound, ..answer.clone() };
            assert_eq!(found.is_right(), expected);
        }
        assert_eq!(right.first_in_sound_twin(), None);
    }
}
