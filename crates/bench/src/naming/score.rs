//! What counts as right: the questions that are asked of an answer.

use servoscope_core::answers::Verdict;

use super::build_case::Hidden;
use super::case::Kind;
use super::judge::{Named, Outcome};

/// Number of equivalents that count, from the first.
const MOST_EQUIVALENTS: usize = 2;

/// Confidence from which a name that is wrong counts in a machine with small effects, and from which
/// that of a dominant one counts as sure.
pub(super) const SURE: f64 = 0.8;

/// Whether a cause, or one of its first two equivalents, is one of these effects.
fn stands_for(cause: &Named, is_one: impl Fn(&str) -> bool) -> bool {
    let equivalents = cause.equivalents.iter().take(MOST_EQUIVALENTS);
    std::iter::once(&cause.effect).chain(equivalents).any(|id| is_one(id))
}

impl Outcome {
    /// Causes, strongest first; empty if the diagnosis failed.
    pub fn causes(&self) -> &[Named] {
        self.answer.as_ref().map_or(&[], |answer| &answer.causes)
    }

    /// The verdict, if there is one.
    pub fn verdict(&self) -> Option<Verdict> {
        self.answer.as_ref().ok().map(|answer| answer.verdict)
    }

    /// Whether this effect is hidden.
    pub fn is_hidden(&self, effect: &str) -> bool {
        self.hidden.iter().any(|hidden| hidden.effect == effect)
    }

    /// The hidden effects that are to be named first: all but the small ones beside dominant ones.
    pub fn dominant(&self) -> impl Iterator<Item = &Hidden> {
        self.hidden.iter().filter(|hidden| !hidden.small)
    }

    /// Whether this effect is hidden, and none of the small ones.
    pub fn is_dominant(&self, effect: &str) -> bool {
        self.dominant().any(|hidden| hidden.effect == effect)
    }

    /// Whether the first cause is a hidden effect, and none of the small ones.
    pub fn named_first(&self) -> bool {
        self.causes().first().is_some_and(|first| self.is_dominant(&first.effect))
    }

    /// Whether the first cause, or one of its first two equivalents, is a hidden effect, and none of
    /// the small ones.
    pub fn first_or_equivalent(&self) -> bool {
        self.is_first_or_equivalent(self.causes())
    }

    /// The same of other causes than those of the answer.
    pub(super) fn is_first_or_equivalent(&self, causes: &[Named]) -> bool {
        let first = causes.first();
        first.is_some_and(|first| stands_for(first, |id| self.is_dominant(id)))
    }

    /// Whether a cause is named that is not hidden and whose first two equivalents are not, either.
    pub fn names_another(&self) -> bool {
        self.names_another_at(0.0)
    }

    /// The same of a cause with at least this confidence.
    pub fn names_another_at(&self, confidence: f64) -> bool {
        let sure = |cause: &&Named| cause.confidence >= confidence;
        self.causes().iter().filter(sure).any(|cause| !stands_for(cause, |id| self.is_hidden(id)))
    }

    /// Whether every hidden effect, except for small ones, is named, alone or as one of the first
    /// two equivalents of a cause.
    pub fn dominant_or_equivalents_named(&self) -> bool {
        let named = |effect: &str| self.causes().iter().any(|c| stands_for(c, |id| id == effect));
        self.answer.is_ok() && self.dominant().all(|hidden| named(hidden.effect))
    }

    /// Whether every hidden effect, except for small ones, is named with at least this confidence.
    pub fn dominant_named_at(&self, confidence: f64) -> bool {
        let named = |effect: &str| {
            self.causes().iter().any(|c| c.effect == effect && c.confidence >= confidence)
        };
        self.answer.is_ok() && self.dominant().all(|hidden| named(hidden.effect))
    }

    /// Whether exactly the hidden effects are named.
    pub fn named_exactly(&self) -> bool {
        let causes = self.causes();
        self.answer.is_ok()
            && causes.len() == self.hidden.len()
            && self.hidden.iter().all(|hidden| causes.iter().any(|c| c.effect == hidden.effect))
    }

    /// Whether the verdict is that the causes explain the data.
    pub fn is_explained(&self) -> bool {
        self.verdict() == Some(Verdict::Explained)
    }

    /// Whether any cause has at least this confidence.
    pub fn any_at(&self, confidence: f64) -> bool {
        self.causes().iter().any(|cause| cause.confidence >= confidence)
    }

    /// Whether the answer is right. A single effect must be named first, with the verdict
    /// `explained`. In a clean draw nothing may be named. Both effects of a pair must be named, and
    /// nothing else. For an outsider the verdict must not be `explained`, and no confidence may
    /// reach 0.9. In an analyser's table or record, the effect must be first or an equivalent of the first and
    /// no other may be named; without one nothing may be named, and the verdict must not be
    /// `unexplained`. Of a machine with small effects, the dominant one must be first or an
    /// equivalent of the first, or both dominant ones must be named, and no name may be wrong at a
    /// confidence of 0.8 or more. If the measurement has a fault, that must be named and no other,
    /// and the answer must be as good as without it.
    pub fn is_right(&self) -> bool {
        self.answer.is_ok()
            && match self.kind {
                Kind::Single => self.named_first() && self.is_explained(),
                Kind::Clean => self.causes().is_empty(),
                Kind::Pair => self.named_exactly(),
                Kind::Outsider => !self.is_explained() && !self.any_at(0.9),
                Kind::Analyser | Kind::AnalyserRecord if self.hidden.is_empty() => {
                    self.is_without_suspicion()
                }
                Kind::Analyser | Kind::AnalyserRecord => {
                    self.first_or_equivalent() && !self.names_another()
                }
                Kind::Machine | Kind::MachineRecord => {
                    self.first_or_equivalent() && !self.names_another_at(SURE)
                }
                Kind::MachinePair | Kind::MachinePairRecord => {
                    self.dominant_named_at(0.0) && !self.names_another_at(SURE)
                }
                Kind::Mismeasured | Kind::MismeasuredRecord => self.is_right_despite_fault(),
            }
    }
}

#[cfg(test)]
mod tests {
    use super::super::case::Case;
    use super::super::fixtures::{machine, made, outcome};
    use super::super::judge::Seconds;
    use super::*;

    #[test]
    fn a_single_effect_counts_where_it_is_first_and_explains() {
        let named = |causes: &[(&str, f64, &[&str])], verdict| {
            outcome("single-60-spring-o0-0", &["spring"], causes, verdict)
        };
        let right = named(&[("spring", 0.99, &[])], Verdict::Explained);
        assert!(right.named_first() && right.is_right() && right.named_exactly());
        let improved = named(&[("spring", 0.99, &[])], Verdict::Improved);
        assert!(improved.named_first() && !improved.is_right());
        let second = named(&[("cogging", 0.6, &[]), ("spring", 0.5, &[])], Verdict::Explained);
        assert!(!second.named_first() && !second.first_or_equivalent() && !second.is_right());
        let equivalent = named(&[("cogging", 0.6, &["stribeck", "spring"])], Verdict::Explained);
        assert!(!equivalent.named_first() && equivalent.first_or_equivalent());
        let third = ["stribeck", "backlash", "spring"];
        assert!(!named(&[("cogging", 0.6, &third)], Verdict::Explained).first_or_equivalent());
        let silent = named(&[], Verdict::Unexplained);
        assert!(!silent.first_or_equivalent() && !silent.is_right());
    }

    #[test]
    fn a_pair_counts_where_both_and_nothing_else_are_named() {
        let named = |causes: &[(&str, f64, &[&str])]| {
            outcome("pair-60-o0-0", &["spring", "stribeck"], causes, Verdict::Explained)
        };
        assert!(named(&[("stribeck", 0.9, &[]), ("spring", 0.9, &[])]).is_right());
        assert!(!named(&[("stribeck", 0.9, &[])]).is_right());
        assert!(!named(&[("stribeck", 0.9, &[]), ("cogging", 0.9, &[])]).is_right());
        let three = [("stribeck", 0.9, &[][..]), ("spring", 0.9, &[]), ("cogging", 0.9, &[])];
        assert!(!named(&three).is_right());
    }

    #[test]
    fn nothing_may_be_named_of_a_clean_draw_and_nothing_certain_of_an_outsider() {
        let clean = |causes: &[(&str, f64, &[&str])], verdict| {
            outcome("clean-60-o0-0", &[], causes, verdict).is_right()
        };
        assert!(clean(&[], Verdict::Adequate) && clean(&[], Verdict::Unexplained));
        assert!(!clean(&[("spring", 0.1, &[])], Verdict::Improved));
        let outsider = |causes: &[(&str, f64, &[&str])], verdict| {
            outcome("outsider-60-o0-0", &["cubic_drag"], causes, verdict).is_right()
        };
        assert!(outsider(&[], Verdict::Unexplained));
        assert!(outsider(&[("quadratic_drag", 0.7, &[])], Verdict::Improved));
        assert!(!outsider(&[("quadratic_drag", 0.95, &[])], Verdict::Improved));
        assert!(!outsider(&[("quadratic_drag", 0.7, &[])], Verdict::Explained));
    }

    #[test]
    fn an_answer_that_failed_counts_for_nothing() {
        let case: Case = "clean-60-o0-0".parse().unwrap();
        let failed = Err("no response".to_owned());
        let outcome = Outcome::new(&case, &made(&case, &[]), failed, Seconds::default());
        assert!(!outcome.is_right() && !outcome.named_exactly());
    }

    #[test]
    fn of_an_analysers_table_nothing_but_the_hidden_effect_may_be_named() {
        let clean = |causes: &[(&str, f64, &[&str])], verdict| {
            outcome("analyser-70-o0-0", &[], causes, verdict).is_right()
        };
        assert!(clean(&[], Verdict::Adequate) && !clean(&[], Verdict::Unexplained));
        assert!(!clean(&[("spring", 0.1, &[])], Verdict::Improved));
        let of_spring = |causes: &[(&str, f64, &[&str])]| {
            outcome("analyser-70-spring-o0-0", &["spring"], causes, Verdict::Improved)
        };
        let second = [("spring", 0.9, &[][..]), ("cogging", 0.5, &[])];
        for (causes, right, another) in [
            (&[("spring", 0.5, &[][..])][..], true, false),
            (&[("hardening_spring", 0.5, &["spring"][..])], true, false),
            (&[("cogging", 0.5, &[][..])], false, true),
            (&second, false, true),
            (&[], false, false),
        ] {
            let found = of_spring(causes);
            assert_eq!((found.is_right(), found.names_another()), (right, another), "{causes:?}");
        }
    }

    #[test]
    fn of_a_machine_the_dominant_effect_counts_and_a_small_one_is_no_false_name() {
        let of_spring = |causes: &[(&str, f64, &[&str])]| {
            let hidden = ["spring", "stribeck", "cubic_drag", "cogging"];
            machine("machine-60-spring-o0-0", 1, &hidden, causes)
        };
        let small_first = [("stribeck", 0.9, &[][..]), ("spring", 0.85, &[])];
        for (causes, first, false_name, sure, right) in [
            (&[("spring", 0.9, &[][..]), ("stribeck", 0.9, &[])][..], true, false, true, true),
            (&[("hardening_spring", 0.7, &["spring"][..])], true, false, false, true),
            (&small_first, false, false, true, false),
            (&[("spring", 0.5, &[][..]), ("backlash", 0.79, &[])], true, false, false, true),
            (&[("spring", 0.5, &[][..]), ("backlash", 0.8, &[])], true, true, false, false),
            (
                &[("spring", 0.5, &[][..]), ("slew_limit", 0.8, &["cogging"])],
                true,
                false,
                false,
                true,
            ),
            (&[], false, false, false, false),
        ] {
            let found = of_spring(causes);
            assert_eq!(
                (found.first_or_equivalent(), found.names_another_at(SURE)),
                (first, false_name),
                "{causes:?}"
            );
            assert_eq!((found.dominant_named_at(SURE), found.is_right()), (sure, right));
        }
    }

    #[test]
    fn of_a_machine_with_two_dominant_effects_both_have_to_be_named() {
        let of_two = |causes: &[(&str, f64, &[&str])]| {
            let hidden = ["spring", "stribeck", "cubic_drag", "cogging"];
            machine("machine-2-60-o0-0", 2, &hidden, causes)
        };
        let both = of_two(&[("spring", 0.9, &[]), ("stribeck", 0.7, &[])]);
        assert!(both.is_right() && both.dominant_named_at(0.7) && !both.dominant_named_at(SURE));
        let one = of_two(&[("spring", 0.9, &[]), ("cogging", 0.7, &[])]);
        assert!(!one.is_right() && one.named_first() && !one.dominant_or_equivalents_named());
        let standing_for = of_two(&[("spring", 0.9, &[]), ("presliding", 0.5, &["stribeck"])]);
        assert!(!standing_for.is_right() && standing_for.dominant_or_equivalents_named());
    }
}
