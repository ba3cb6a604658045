//! The rates of machines that have small effects beside dominant ones.

use super::Wanted;
use super::lines::Lines;
use crate::naming::case::Kind;
use crate::naming::judge::Outcome;
use crate::naming::score::SURE;

/// What is counted of a machine, with the targets of tables and of records at all levels together.
struct Question {
    what: &'static str,
    wanted: [Wanted; 2],
    counted: fn(&Outcome) -> bool,
}

const NOTHING: [Wanted; 2] = [Wanted::Nothing; 2];

/// Of one dominant effect.
const OF_ONE: [Question; 5] = [
    Question {
        what: "first or an equivalent",
        wanted: [Wanted::AtLeast(0.95), Wanted::AtLeast(0.92)],
        counted: Outcome::first_or_equivalent,
    },
    Question { what: "named first", wanted: NOTHING, counted: Outcome::named_first },
    Question {
        what: "a name at 0.8 or more that is not in it",
        wanted: [Wanted::AtMost(0.03), Wanted::AtMost(0.05)],
        counted: has_a_false_name,
    },
    Question {
        what: "the dominant effect at 0.8 or more",
        wanted: [Wanted::AtLeast(0.80), Wanted::AtLeast(0.70)],
        counted: is_sure,
    },
    Question { what: "explained", wanted: NOTHING, counted: Outcome::is_explained },
];

/// Of two dominant effects.
const OF_TWO: [Question; 6] = [
    Question {
        what: "both named",
        wanted: [Wanted::AtLeast(0.80), Wanted::AtLeast(0.70)],
        counted: names_all,
    },
    Question {
        what: "both named or among equivalents",
        wanted: NOTHING,
        counted: Outcome::dominant_or_equivalents_named,
    },
    Question { what: "one of them first", wanted: NOTHING, counted: Outcome::named_first },
    Question {
        what: "a name at 0.8 or more that is not in it",
        wanted: NOTHING,
        counted: has_a_false_name,
    },
    Question { what: "both dominant effects at 0.8 or more", wanted: NOTHING, counted: is_sure },
    Question { what: "explained", wanted: NOTHING, counted: Outcome::is_explained },
];

impl Lines<'_> {
    /// Machines with small effects, by level and all together; those that are recorded have one
    /// level.
    pub(super) fn machines(&mut self, levels: &[u32]) {
        for kind in Kind::ALL {
            let questions = match kind.dominant() {
                0 => continue,
                1 => &OF_ONE[..],
                _ => &OF_TWO,
            };
            for Question { what, wanted, counted } in questions {
                for level in levels.iter().filter(|_| !kind.is_recorded()) {
                    self.count((kind, Some(*level)), what, Wanted::Nothing, counted);
                }
                let wanted = wanted[usize::from(kind.is_recorded())];
                self.count((kind, None), what, wanted, counted);
            }
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
