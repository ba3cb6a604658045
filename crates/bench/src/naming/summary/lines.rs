//! The rates of each kind of draw and noise level, with their targets.

use servoscope_core::answers::Verdict;

use super::{Line, Wanted};
use crate::naming::case::Kind;
use crate::naming::fresh::Fresh;
use crate::naming::instrument::{Harmonics, Instrument, NoiseSaid};
use crate::naming::judge::{Answer, Estimated, Outcome};
use crate::naming::rate::Rate;
use crate::naming::separation::Separation;

/// Bins of the excess χ² that the nearest rival leaves without noise. A choice by likelihood (see
/// [`super::super::rivals::Nearest`]) is wrong with a probability of 16 % at the first bound, 2.3 %
/// at the second and 0.003 % at the last.
const RIVAL_EXCESS_BINS: [(&str, [f64; 2]); 4] = [
    ("named first, a rival's excess below 4", [f64::NEG_INFINITY, 4.0]),
    ("named first, the nearest rival's 4 to 16", [4.0, 16.0]),
    ("named first, the nearest rival's 16 to 64", [16.0, 64.0]),
    ("named first, every rival's 64 or more", [64.0, f64::INFINITY]),
];

/// Whether a table is of a part, and what is counted of the part where it is clean and where it
/// hides an effect.
type AnalyserPart = (fn(&Instrument) -> bool, &'static str, &'static str);

/// Parts of the tables of analysers.
const ANALYSER_PARTS: [AnalyserPart; 4] = [
    (
        |instrument| instrument.said == NoiseSaid::Nothing,
        "clean, nothing said of the noise: the same",
        "first or an equivalent, nothing said",
    ),
    (
        |instrument| matches!(instrument.said, NoiseSaid::Repeats(_)),
        "clean, with repeats: the same",
        "first or an equivalent, with repeats",
    ),
    (
        |instrument| instrument.said == NoiseSaid::Coherence,
        "clean, with coherence: the same",
        "first or an equivalent, with coherence",
    ),
    (
        |instrument| instrument.harmonics == Harmonics::Fundamentals,
        "clean, fundamentals alone: the same",
        "first or an equivalent, fundamentals alone",
    ),
];

/// The target for a noise level, from the shares required at 60 dB, 50 dB and 40 dB.
fn by_level(level_db: u32, shares: &[f64]) -> Wanted {
    let place = [60, 50, 40].into_iter().position(|db| db == level_db);
    let share = place.and_then(|place| shares.get(place));
    share.map_or(Wanted::Nothing, |share| Wanted::AtLeast(*share))
}

/// All rates for which there are draws.
pub(super) fn lines(outcomes: &[Outcome], levels: &[u32]) -> Vec<Line> {
    let mut lines = Lines { outcomes, lines: Vec::new() };
    lines.singles(levels);
    lines.clean(levels);
    lines.pairs(levels);
    lines.outsiders();
    for kind in [Kind::Analyser, Kind::AnalyserRecord] {
        lines.analysers(kind);
    }
    lines.machines(levels);
    lines.rivals();
    for kind in [Kind::Single, Kind::Pair, Kind::Analyser] {
        for &level in levels {
            lines.intervals(kind, level);
        }
    }
    lines.lines
}

pub(super) struct Lines<'a> {
    outcomes: &'a [Outcome],
    lines: Vec<Line>,
}

impl<'a> Lines<'a> {
    /// The draws of a kind, at one noise level or at all.
    fn at(&self, kind: Kind, level_db: Option<u32>) -> impl Iterator<Item = &'a Outcome> + use<'a> {
        let of = move |o: &&Outcome| o.kind == kind && level_db.is_none_or(|db| o.level_db == db);
        self.outcomes.iter().filter(of)
    }

    /// Adds a rate, if there is anything to count.
    fn add(
        &mut self,
        (kind, level_db): (Kind, Option<u32>),
        what: &'static str,
        wanted: Wanted,
        counted: impl Iterator<Item = bool>,
    ) {
        let rate = Rate::count(counted);
        if rate.of > 0 {
            self.lines.push(Line { kind, level_db, what, rate, wanted });
        }
    }

    /// Adds the rate of `right` over all draws of a kind, at one noise level or at all.
    pub(super) fn count(
        &mut self,
        (kind, level_db): (Kind, Option<u32>),
        what: &'static str,
        wanted: Wanted,
        right: impl Fn(&Outcome) -> bool,
    ) {
        self.add((kind, level_db), what, wanted, self.at(kind, level_db).map(right));
    }

    fn singles(&mut self, levels: &[u32]) {
        for &level in levels {
            let at = (Kind::Single, Some(level));
            let asked = |shares: [f64; 3]| by_level(level, &shares);
            self.count(at, "named first", asked([0.95, 0.90, 0.80]), Outcome::named_first);
            let or_equivalent = Outcome::first_or_equivalent;
            self.count(at, "first or an equivalent", asked([0.99, 0.97, 0.92]), or_equivalent);
            self.count(at, "explained", asked([0.95, 0.93, 0.90]), Outcome::is_explained);
            self.count(at, "nothing else named", Wanted::Nothing, Outcome::named_exactly);
        }
    }

    fn clean(&mut self, levels: &[u32]) {
        for &level in levels {
            let at = (Kind::Clean, Some(level));
            self.count(at, "something named", Wanted::Nothing, names_something);
        }
        let all = (Kind::Clean, None);
        self.count(all, "something named", Wanted::AtMost(0.02), names_something);
        let doubted = |o: &Outcome| o.verdict() != Some(Verdict::Adequate);
        self.count(all, "not adequate", Wanted::Nothing, doubted);
    }

    fn pairs(&mut self, levels: &[u32]) {
        for &level in levels {
            let at = (Kind::Pair, Some(level));
            let wanted = by_level(level, &[0.85, 0.75]);
            self.count(at, "both and nothing else", wanted, Outcome::named_exactly);
            self.count(at, "one of them first", Wanted::Nothing, Outcome::named_first);
            self.count(at, "explained", Wanted::Nothing, Outcome::is_explained);
        }
    }

    fn outsiders(&mut self) {
        let all = (Kind::Outsider, None);
        let wrongly_explained = |o: &Outcome| o.is_explained() && names_something(o);
        self.count(all, "explained by a wrong name", Wanted::AtMost(0.05), wrongly_explained);
        self.count(all, "a cause at 0.9 or more", Wanted::AtMost(0.10), |o| o.any_at(0.9));
        self.count(all, "something named", Wanted::Nothing, names_something);
    }

    /// Tables of analysers or records, all together; tables also by what they contain.
    fn analysers(&mut self, kind: Kind) {
        let at = (kind, None);
        let parts = if kind.is_recorded() { &[][..] } else { &ANALYSER_PARTS };
        let [first, another_name] = if kind.is_recorded() { [0.95, 0.03] } else { [0.97, 0.02] };
        let all = self.at(kind, None);
        let (clean, hidden): (Vec<&Outcome>, Vec<&Outcome>) =
            all.partition(|o| o.hidden.is_empty());
        let nothing = Wanted::Nothing;
        let what = "clean: a name, unexplained or no answer";
        let missed = |o: &&Outcome| !o.is_right();
        self.add(at, what, Wanted::AtMost(0.02), clean.iter().map(missed));
        for (part, what, _) in parts {
            self.add(at, what, nothing, clean.iter().filter(|o| part(&o.instrument)).map(missed));
        }
        let right = |o: &&Outcome| o.first_or_equivalent();
        let named_first = hidden.iter().map(|o| o.named_first());
        self.add(at, "first or an equivalent", Wanted::AtLeast(first), hidden.iter().map(right));
        self.add(at, "named first", nothing, named_first);
        for (part, _, what) in parts {
            self.add(at, what, nothing, hidden.iter().filter(|o| part(&o.instrument)).map(right));
        }
        let another = hidden.iter().map(|o| o.names_another());
        self.add(at, "a name that is neither", Wanted::AtMost(another_name), another);
        let explained = hidden.iter().map(|o| o.is_explained());
        self.add(at, "explained", nothing, explained);
    }

    /// Rates by the excess of the nearest rival, and rates of the doubts that one more experiment
    /// resolves.
    fn rivals(&mut self) {
        for kind in [Kind::Single, Kind::Analyser] {
            for (what, [from, to]) in RIVAL_EXCESS_BINS {
                let near = move |o: &&Outcome| {
                    o.nearest.as_ref().is_some_and(|n| (from..to).contains(&n.excess))
                };
                let named_first = self.at(kind, None).filter(near).map(Outcome::named_first);
                self.add((kind, None), what, Wanted::Nothing, named_first);
            }
        }
        let all = (Kind::Single, None);
        let mut separated = |what, by: fn(&Separation) -> bool| {
            let tried = self.at(Kind::Single, None).filter_map(|o| o.separation.as_ref());
            self.add(all, what, Wanted::Nothing, tried.map(by));
        };
        separated("no doubt left by the next experiment", |s| s.asked_for.ended);
        separated("no doubt left by a random experiment", |s| s.random.ended);
        separated("the next experiment speaks more for the hidden effect than a random one", |s| {
            s.asked_for_is_better()
        });
    }

    /// Coverage of the 95 % intervals.
    fn intervals(&mut self, kind: Kind, level: u32) {
        let at = (kind, Some(level));
        let all: Vec<&Outcome> = self.at(kind, Some(level)).collect();
        let right: Vec<&Outcome> = all.iter().copied().filter(|o| o.named_exactly()).collect();
        let answers = |of: &[&'a Outcome]| -> Vec<&'a Answer> {
            of.iter().filter_map(|o| o.answer.as_ref().ok()).collect()
        };
        let (all, in_right) = (answers(&all), answers(&right));
        let of_effects = || all.iter().flat_map(|answer| &answer.effect_parameters);
        let of_plant = in_right.iter().flat_map(|answer| &answer.plant_parameters);
        let gains = right.iter().filter_map(|o| o.fresh.as_ref());
        let nothing = Wanted::Nothing;
        self.add(at, "gain on fresh data held", Wanted::AtLeast(0.90), gains.map(Fresh::held));
        let held = of_effects().filter_map(Estimated::held);
        self.add(at, "parameters of named effects held", nothing, held);
        let held = of_plant.filter_map(Estimated::held);
        self.add(at, "parameters of the plant held", nothing, held);
        let given = of_effects().map(|estimate| estimate.interval95.is_some());
        self.add(at, "parameters of named effects with an interval", nothing, given);
    }
}

fn names_something(outcome: &Outcome) -> bool {
    !outcome.causes().is_empty()
}
