//! Finds the effects that the base model lacks, by forward selection with backward elimination.
//!
//! Every effect is fitted together with the base model, from several starting points. Pairs and
//! triples are then grown from the best models. An effect counts only if the model without it,
//! refitted, is worse by more than the family-wise threshold (`familywise_threshold`). Among models
//! whose effects all count, the evidence decides (`evidence`, `models`).

pub(super) mod fitter;
mod frequency_scan;
mod grid;
pub(super) mod linearization;
mod multistart;
pub(super) mod score_tests;

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::effects::{Effect, check_slots};
use crate::identify::{FitAccuracy, FitSession, Model, SearchBreadth, SearchSettings};
use crate::observer::Observer as _;

use super::progress::{Part, Remaining};
use super::selection::evidence::NoiseScale;
use super::selection::familywise_threshold::FamilywiseThreshold;
use super::selection::models::{Key, Models, ScoredModel, key};
use fitter::Fitter;
use linearization::Linearization;
use score_tests::{Changes, Probed};

/// Spans of the progress: the score tests, and the fits of every effect alone.
const TESTS_SPAN: [f64; 2] = [0.0, 0.3];
const SINGLES_SPAN: [f64; 2] = [0.3, 1.0];

/// Rounds of adding an effect to a model that are expected: to the best effect, and to each effect
/// of the best pair.
const EXPECTED_ROUNDS: usize = 3;

/// A search for the effects that a session's base model lacks.
pub(super) struct Search<'a> {
    session: &'a FitSession<'a>,
    seed: u64,
    breadth: SearchBreadth,
    /// Every model that was fitted.
    pub models: Models,
    /// How every effect changes the response of the base model.
    changes: Vec<Changes>,
    /// Models to which a further effect was already added.
    grown: BTreeSet<Key>,
}

impl<'a> Search<'a> {
    /// Starts a search: fits every effect alone.
    pub fn new(
        session: &'a FitSession<'a>,
        part: Part<'_>,
        seed: u64,
        noise_scale: NoiseScale,
    ) -> Self {
        let models = Models::new(session.base().clone(), noise_scale);
        let (changes, grown) = (Vec::new(), BTreeSet::new());
        let SearchSettings { cosines, records, .. } = *session.search();
        let breadth = if session.has_cosines_alone() { cosines } else { records };
        let mut this = Self { session, seed, breadth, models, changes, grown };
        this.singles(part);
        this
    }

    fn singles(&mut self, part: Part<'_>) {
        let Some(linearization) = Linearization::new(self.session, self.session.base()) else {
            return;
        };
        self.changes = self.changes(&linearization, part);
        let probed = self.probe(&linearization, part);
        let family = self.family(&linearization, &probed);
        let scale = self.models.noise_scale.variance(linearization.model.cost);
        let promising = |probed: &Probed| self.promises(probed, &family, scale);
        let fitter = self.fitter(part.part(SINGLES_SPAN), 0);
        let fits = fitter.fit(&linearization.model, &probed, promising);
        self.models.family = Some(family);
        self.keep(fits);
    }

    /// Fits pairs and triples, up to `most` effects. It ends when the best model is `sufficient` and
    /// no further effect is promising, or when one more effect does not `add` to the model without
    /// it.
    pub fn combine(
        &mut self,
        part: Part<'_>,
        most: usize,
        sufficient: impl Fn(&Model) -> bool,
        adds: impl Fn(&Model, &Model) -> bool,
    ) {
        let mut rounds = Rounds { rest: Remaining(part), expected: EXPECTED_ROUNDS };
        for size in 1..most {
            let best = self.models.best_supported();
            let Some(model) = self.models.get(&best).filter(|_| best.len() >= size) else { break };
            let enough = sufficient(model);
            let mut grown = self.grow(&best, enough, &mut rounds);
            if size == 1 && !enough {
                // The effect of most evidence, which need not be the supported one.
                let found = self.models.best_supported();
                let is_open = !self.models.get(&found).is_some_and(&sufficient);
                if let Some(first) = self.models.ranked(size).first().cloned().filter(|_| is_open) {
                    grown |= self.grow(&first, enough, &mut rounds);
                }
            }
            if !grown {
                break;
            }
            // The best larger model is compared with every model it contains, and a pair with the
            // pairs in which one of its effects is replaced.
            if let Some(next) = self.models.ranked(size + 1).first().cloned() {
                if let (Some(without), Some(with)) =
                    (self.models.get(&best), self.models.get(&next))
                    && !adds(without, with)
                {
                    break;
                }
                self.shrink(&next, rounds.rest.0);
                for id in next.iter().filter(|_| size == 1) {
                    let rest = next.iter().copied().filter(|other| other != id).collect();
                    self.grow(&rest, enough, &mut rounds);
                }
            }
        }
    }

    /// Fits models with one more effect than `from`: the most promising effects, or, if `from` is
    /// not `enough`, those with the largest score. Returns whether there was any.
    fn grow(&mut self, from: &Key, enough: bool, rounds: &mut Rounds<'_>) -> bool {
        if self.session.observer().cancelled() || !self.grown.insert(from.clone()) {
            return false;
        }
        let linearization =
            self.models.get(from).and_then(|model| Linearization::new(self.session, model));
        let Some(linearization) = linearization else { return false };
        let part = rounds.next();
        let mut probed = self.probe(&linearization, part);
        let family = self.family(&linearization, &probed);
        let scale = self.models.noise_scale.variance(linearization.model.cost);
        let promising = |probed: &Probed| self.promises(probed, &family, scale);
        probed.retain(|probed| !enough || promising(probed));
        probed.sort_by(|a, b| b.promise().total_cmp(&a.promise()));
        probed.truncate(self.breadth.partners);
        let fits = self.fitter(part, from.len()).fit(&linearization.model, &probed, promising);
        let any = !fits.is_empty();
        self.keep(fits);
        any
    }

    /// Whether [`Self::deepen`] fits anything.
    pub fn deepens(&self) -> bool {
        self.breadth.deepening_starts > 0
    }

    /// Fits a model without each of its effects in turn, if that model was not fitted yet or the
    /// first steps of a fit from here are already better.
    fn shrink(&mut self, from: &Key, part: Part<'_>) {
        let Some(model) = self.models.get(from) else { return };
        let fitter = self.fitter(part, from.len() - 1);
        let without = |index| {
            let rest = self.session.reduce(model, index);
            let Some(known) = self.models.get(&key(&rest)) else {
                return Some(fitter.refine(&rest, FitAccuracy::Settle));
            };
            let rest = fitter.refine(&rest, FitAccuracy::Glance);
            (rest.cost < known.cost).then(|| fitter.refine(&rest, FitAccuracy::Settle))
        };
        let fits = (0..model.effects().len()).into_par_iter().filter_map(without).collect();
        self.keep(fits);
    }

    /// The settings for fits of an effect beside so many others.
    fn fitter<'p>(&self, part: Part<'p>, beside: usize) -> Fitter<'p>
    where
        'a: 'p,
    {
        let (session, noise_scale) = (self.session, self.models.noise_scale);
        let (starts, followed) = (self.breadth.starts(beside), self.breadth.followed_starts);
        Fitter { session, part, noise_scale, starts, followed }
    }

    /// Whether an effect may gain more than the family-wise threshold; `scale` is the variance of
    /// the noise in units of the weights.
    fn promises(&self, probed: &Probed, family: &FamilywiseThreshold, scale: f64) -> bool {
        let least = self.session.search().promising_share * family.limit(probed.effect.id());
        probed.promise() / scale > least
    }

    fn keep(&mut self, fits: Vec<Model>) {
        let (session, noise_scale) = (self.session, self.models.noise_scale);
        let weighed = |model| ScoredModel::new(session, session.from_rest(model), &noise_scale);
        let fits: Vec<ScoredModel> = fits.into_par_iter().map(weighed).collect();
        fits.into_iter().for_each(|scored| self.models.keep(scored));
    }

    /// How each testable effect of the library changes the response.
    fn changes(&self, linearization: &Linearization, part: Part<'_>) -> Vec<Changes> {
        let (session, base) = (self.session, &linearization.model);
        let testable = |effect: &&&'static dyn Effect| {
            (session.runs_known() || !effect.search().needs_run)
                && session.can_decide(base, **effect)
        };
        let effects: Vec<&&dyn Effect> = session.library().iter().filter(testable).collect();
        let stage = part.part(TESTS_SPAN).stage("one effect: quick tests", effects.len());
        let changes = |effect: &&'static dyn Effect| {
            let changes = Changes::of(self.session, linearization, *effect);
            stage.step();
            changes
        };
        effects.into_par_iter().filter(|_| !part.cancelled()).map(changes).collect()
    }

    /// Score tests of every effect that can be added to the model.
    fn probe(&self, linearization: &Linearization, part: Part<'_>) -> Vec<Probed> {
        let (own, session) = (linearization.model.effects(), self.session);
        let lacks = |changes: &&Changes| {
            let together: Vec<&dyn Effect> = own.iter().copied().chain([changes.effect]).collect();
            check_slots(&together).is_ok()
                && session.can_decide(&linearization.model, changes.effect)
        };
        let lacking: Vec<&Changes> = self.changes.iter().filter(lacks).collect();
        let settles = own.iter().any(|effect| effect.search().forces_zero_mean);
        lacking
            .into_par_iter()
            .filter(|_| !part.cancelled())
            .map(|changes| match settles && changes.effect.search().forces_zero_mean {
                // The model has an effect that forces a zero mean already, so the change beside
                // the base model, which includes that, does not apply.
                true => Changes::of(session, linearization, changes.effect)
                    .probe(session, linearization),
                false => changes.probe(session, linearization),
            })
            .collect()
    }

    fn family(&self, linearization: &Linearization, probed: &[Probed]) -> FamilywiseThreshold {
        let (session, known) = (self.session, self.models.noise_scale.known);
        FamilywiseThreshold::new(session, linearization, known, probed, self.seed)
    }
}

/// The progress of rounds in which one more effect is added to a model. Their number is not known
/// beforehand: those that are expected take equal shares and leave half a share to later ones, each
/// of which takes two thirds of the rest.
struct Rounds<'a> {
    rest: Remaining<'a>,
    expected: usize,
}

impl<'a> Rounds<'a> {
    fn next(&mut self) -> Part<'a> {
        let part = self.rest.take(1.0 / (self.expected as f64 + 0.5));
        self.expected = (self.expected - 1).max(1);
        part
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{exact, noisy, request};
    use super::*;
    use crate::effects::find;
    use crate::machines::draw::NoiseStatement;
    use crate::observer::Silent;

    pub(super) const PART: Part<'_> = Part::of(&Silent);

    pub(super) fn nothing_fitted<'a>(session: &'a FitSession<'a>) -> Search<'a> {
        let noise_scale = NoiseScale { known: true, rounding: 0.0, dof: 100.0 };
        let models = Models::new(session.base().clone(), noise_scale);
        let (changes, grown) = (Vec::new(), BTreeSet::new());
        let breadth = session.search().cosines;
        Search { session, seed: 1, breadth, models, changes, grown }
    }

    // Three expected rounds leave a seventh.
    #[test]
    fn expected_rounds_have_equal_shares_and_later_ones_fit_into_the_rest() {
        let mut rounds = Rounds { rest: Remaining(PART), expected: 3 };
        let ends: Vec<f64> = (0..5).map(|_| rounds.next().span[1]).collect();
        for (end, left) in ends.iter().zip([5.0, 3.0, 1.0, 1.0 / 3.0, 1.0 / 9.0]) {
            assert!((end - (1.0 - left / 7.0)).abs() < 1e-12, "{ends:?}");
        }
    }

    // A settled cost is accurate to 1e-5.
    #[test]
    fn what_a_pair_is_without_one_effect_replaces_a_fit_of_the_other_alone_that_was_worse() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 4), request());
        let session = &FitSession::new(&measurement, &request, &Silent).unwrap();
        let mut search = nothing_fitted(session);
        let mut astray = session.extend(session.base(), find("sensor_lag").unwrap());
        let fitted = session.refine(&astray, FitAccuracy::Settle);
        astray.cost = 2.0 * fitted.cost;
        let pair = session.extend(&fitted, find("quadratic_drag").unwrap());
        let pair = session.refine(&pair, FitAccuracy::Glance);
        let keys = [&fitted, &pair].map(key);
        search.keep(vec![astray, pair]);
        search.shrink(&keys[1], PART);
        let found = search.models.get(&keys[0]).unwrap();
        assert!(found.cost < fitted.cost * (1.0 + 1e-5), "{} {}", found.cost, fitted.cost);
    }
}
