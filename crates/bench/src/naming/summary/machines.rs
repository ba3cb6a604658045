//! The rates of machines that have small effects beside dominant ones.

use super::Wanted;
use super::lines::Lines;
use crate::naming::case::Kind;
use crate::naming::judge::Outcome;
use crate::naming::score::SURE;

/// What is counted of a machine.
type Question = fn(&Outcome) -> bool;

/// Of one dominant effect: what is counted, and the target at all levels together.
const OF_ONE: [(&str, Wanted, Question); 5] = [
    ("first or an equivalent", Wanted::AtLeast(0.95), Outcome::first_or_equivalent),
    ("named first", Wanted::Nothing, Outcome::named_first),
    ("a name at 0.8 or more that is not in it", Wanted::AtMost(0.03), has_a_false_name),
    ("the dominant effect at 0.8 or more", Wanted::AtLeast(0.80), is_sure),
    ("explained", Wanted::Nothing, Outcome::is_explained),
];

/// Of two dominant effects.
const OF_TWO: [(&str, Wanted, Question); 6] = [
    ("both named", Wanted::AtLeast(0.80), names_all),
    ("both named or among equivalents", Wanted::Nothing, Outcome::dominant_or_equivalents_named),
    ("one of them first", Wanted::Nothing, Outcome::named_first),
    ("a name at 0.8 or more that is not in it", Wanted::Nothing, has_a_false_name),
    ("both dominant effects at 0.8 or more", Wanted::Nothing, is_sure),
    ("explained", Wanted::Nothing, Outcome::is_explained),
];

impl Lines<'_> {
    /// Machines with small effects, by level and all together.
    pub(super) fn machines(&mut self, levels: &[u32]) {
        self.asked(Kind::Machine, &OF_ONE, levels);
        self.asked(Kind::MachinePair, &OF_TWO, levels);
    }

    fn asked(
        &mut self,
        kind: Kind,
        questions: &[(&'static str, Wanted, Question)],
        levels: &[u32],
    ) {
        for (what, wanted, question) in questions {
            for level in levels {
                self.count((kind, Some(*level)), what, Wanted::Nothing, question);
            }
            self.count((kind, None), what, *wanted, question);
        }
    }
}

fn has_a_false_name(outcome: &Outcome) -> bool {
    outcome.names_another_at(SURE)
}

fn is_sure(outcome: &Outcome) -> bool {
    outcome.dominant_named_at(SURE)
}

fn names_all(outcome: &Outcome) -> bool {
    outcome.dominant_named_at(0.0)
}
