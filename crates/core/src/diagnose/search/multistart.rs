//! Multistart for the chosen model: its effects that gain little, and those easily confused with them,
//! are fitted again from further starting points, and the lowest minimum is kept. A model that leaves
//! no more than noise would, but with a structure, is started again from displaced parameters.

use rayon::prelude::*;

use crate::effects;
use crate::effects::Effect;

use super::Search;
use super::fitter::Fitter;
use super::linearization::Linearization;
use super::score_tests::Probed;
use crate::diagnose::progress::{Part, Remaining};
use crate::diagnose::selection::evidence::CHANCE_GAIN;
use crate::diagnose::selection::models::{Key, key};
use crate::identify::{FitAccuracy, Model};

impl Search<'_> {
    /// Fits effects of a model again, from the starting points that were not used yet, if they gain
    /// little and their misfit has several minima; and with them the effects that are easily
    /// confused with them. The search may have missed the lowest minimum. An effect with a large
    /// gain is left alone: no overlooked minimum of a rival could outweigh it.
    pub fn deepen(&mut self, chosen: &Key, part: Part<'_>) {
        let most = self.breadth.deepening_starts;
        let is_hidden = |effect: &&&'static dyn Effect| {
            let id = effect.id();
            chosen.contains(&id)
                && !self.session.start_points(**effect).is_empty()
                && !self.models.exceeds(chosen, id, self.session.search().deepening_limit)
        };
        let hidden: Vec<&dyn Effect> =
            self.session.library().iter().filter(|_| most > 0).filter(is_hidden).copied().collect();
        let mut part = Remaining(part);
        for (before, effect) in hidden.iter().copied().enumerate() {
            let rest: Key = chosen.iter().copied().filter(|id| *id != effect.id()).collect();
            let linearization =
                self.models.get(&rest).and_then(|rest| Linearization::new(self.session, rest));
            let Some(linearization) = linearization else { continue };
            let mut probed = self.probe(&linearization, part.0);
            probed.retain(|Probed { effect: other, .. }| {
                other.id() == effect.id() || effects::are_confusable(effect, *other)
            });
            let tried = self.breadth.starts(rest.len());
            for Probed { probes, .. } in &mut probed {
                probes.drain(..tried.min(probes.len()));
            }
            let part = part.take(1.0 / (hidden.len() - before) as f64);
            let fitter = Fitter { starts: most, ..self.fitter(part, rest.len()) };
            let fits = fitter.fit(&linearization.model, &probed, |_| true);
            self.keep(fits);
        }
    }

    /// Fits the models with the closest imitator of an effect in its place, where the search has not:
    /// only beside the same other effects can the two be compared.
    pub fn exchange_imitators(&mut self, chosen: &Key, part: Part<'_>) {
        let mut part = Remaining(part);
        for id in chosen {
            let rest: Key = chosen.iter().copied().filter(|other| other != id).collect();
            let (Some(effect), Some(model)) = (self.models.effect(id), self.models.get(&rest))
            else {
                continue;
            };
            let is_missing = |other: &dyn Effect| {
                let mut with: Key = rest.iter().copied().chain([other.id()]).collect();
                with.sort_unstable();
                effects::are_closest_imitators(effect, other) && self.models.get(&with).is_none()
            };
            if !self.session.library().iter().any(|other| is_missing(*other)) {
                continue;
            }
            let Some(linearization) = Linearization::new(self.session, model) else { continue };
            let mut probed = self.probe(&linearization, part.0);
            probed.retain(|probed| is_missing(probed.effect));
            let fits =
                self.fitter(part.take(0.5), rest.len())
                    .fit(&linearization.model, &probed, |_| true);
            self.keep(fits);
        }
    }

    /// Fits the models with a special case of an effect in its place, such as a flexible mode for
    /// backlash, where the search has not or has found one that fits worse, and those without each of its
    /// effects: the gap that was found may be none. Likewise with what an effect is a special case of, if the first steps of a
    /// fit gain more than chance does: a gap that was not looked for may be there. Returns whether
    /// there was any.
    pub fn exchange_nested(&mut self, chosen: &Key, part: Part<'_>) -> bool {
        let Some(model) = self.models.get(chosen) else { return false };
        let mut starts = Vec::new();
        for (index, effect) in model.effects().iter().enumerate() {
            let rest = self.session.reduce(model, index);
            let is_nested = |other: &&&'static dyn Effect| {
                effects::are_nested(**other, *effect) && self.session.can_decide(&rest, **other)
            };
            for other in self.session.library().iter().filter(is_nested) {
                // A general case begins near the special one.
                let [_, start] = self.session.exchange((model, index), *other);
                starts.push(start);
            }
        }
        let fitter = self.fitter(part, chosen.len().saturating_sub(1));
        let misfit = |model: &Model| self.models.noise_scale.misfit(model.cost);
        let refit = |start: &Model| {
            let is_special = start.parameters() < model.parameters();
            let most = match self.models.get(&key(start)) {
                None if is_special => return Some(fitter.refine(start, FitAccuracy::Settle)),
                None => misfit(model) - CHANCE_GAIN,
                // What it is a special case of found a better place, such as a gap that is none.
                Some(known) if is_special && misfit(model) < misfit(known) => misfit(known),
                Some(_) => return None,
            };
            let begun = fitter.refine(start, FitAccuracy::Glance);
            (misfit(&begun) < most).then(|| fitter.refine(&begun, FitAccuracy::Settle))
        };
        let fits: Vec<Model> = starts.par_iter().filter_map(refit).collect();
        let found: Vec<Key> = fits.iter().map(key).collect();
        self.keep(fits);
        for found in &found {
            self.shrink(found, part);
        }
        !found.is_empty()
    }

    /// Starts the fit of a model again from displaced parameters of its last effect until it is
    /// `sufficient`.
    pub fn restart(&mut self, chosen: &Key, part: Part<'_>, sufficient: impl Fn(&Model) -> bool) {
        let Some(model) = self.models.get(chosen) else { return };
        let mut part = Remaining(part);
        let fitter = self.fitter(part.0, chosen.len().saturating_sub(1));
        let begin = &mut |restarts| part.take(0.5).stage("further starts", restarts);
        let found = fitter.leave_local_minimum(model, &sufficient, begin);
        self.keep(found.into_iter().collect());
    }
}

#[cfg(test)]
mod tests {
    use crate::answers::PlantRequest;
    use crate::diagnose::fixtures::{multisine_record, plant};
    use crate::diagnose::search::linearization::Linearization;
    use crate::diagnose::search::tests::{PART, nothing_fitted};
    use crate::diagnose::selection::evidence::CHANCE_GAIN;
    use crate::diagnose::selection::models::key;
    use crate::diagnose::tests::{exact, noisy, request};
    use crate::effects::find;
    use crate::identify::{FitAccuracy, FitSession, IdentifyRequest, Model};
    use crate::machines::draw::NoiseStatement;
    use crate::machines::simulator::Effect;
    use crate::measurement::Measurement;
    use crate::observer::Silent;

    #[test]
    fn a_joint_in_the_wrong_valley_is_fitted_again_from_the_starts_that_were_passed_over() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 4), request());
        let session = &FitSession::new(&measurement, &request, &Silent).unwrap();
        let mut search = nothing_fitted(session);
        let mut astray = session.extend(session.base(), find("flexible_mode").unwrap());
        astray.cost = 2.0 * session.base().cost;
        let key = key(&astray);
        search.keep(vec![astray]);
        search.changes =
            search.changes(&Linearization::new(session, session.base()).unwrap(), PART);
        search.deepen(&key, PART);
        let found = search.models.get(&key).unwrap();
        assert!(found.cost < session.base().cost, "{}", found.cost);
    }

    #[test]
    fn a_flexible_mode_is_fitted_in_place_of_the_backlash_of_a_pair() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 4), request());
        let session = &FitSession::new(&measurement, &request, &Silent).unwrap();
        let mut search = nothing_fitted(session);
        let play = find("backlash").unwrap();
        let mut alone = session.extend(session.base(), play);
        let places = session.start_points(play);
        let own = alone.parameters_of(0).zip(&places[places.len() / 2]);
        own.for_each(|(i, value)| alone.set(i, *value));
        let pair = session.extend(&alone, find("quadratic_drag").unwrap());
        let pair = session.refine(&pair, FitAccuracy::Glance);
        let chosen = key(&pair);
        search.keep(vec![pair]);
        assert!(search.exchange_nested(&chosen, PART));
        assert!(!search.exchange_nested(&chosen, PART), "all are fitted");
        assert!(search.models.ranked(2).contains(&vec!["flexible_mode", "quadratic_drag"]));
        for id in ["flexible_mode", "quadratic_drag"] {
            assert!(search.models.ranked(1).contains(&vec![id]), "{id} alone");
        }
    }

    #[test]
    fn a_flexible_mode_in_a_worse_place_is_fitted_again_from_a_backlash_whose_gap_is_none() {
        let joint = [("load_inertia_fraction", 0.4), ("stiffness", 30.0), ("damping", 0.05)];
        let joint = Effect::new("flexible_mode", joint);
        let measurement = multisine_record(plant(), &[joint], None, 5);
        let plant = Some(PlantRequest { actuator_order: 1 });
        let request = IdentifyRequest { plant, ..request() };
        let session = &FitSession::new(&measurement, &request, &Silent).unwrap();
        let [joint, play] = ["flexible_mode", "backlash"].map(|id| find(id).unwrap());
        let refine = |model: &Model| session.refine(model, FitAccuracy::Settle);
        let fits = session.start_points(joint).into_iter().map(|place| {
            let mut model = session.extend(session.base(), joint);
            model.parameters_of(0).zip(&place).for_each(|(i, value)| model.set(i, *value));
            refine(&model)
        });
        let right = fits.min_by(|a, b| a.cost.total_cmp(&b.cost)).unwrap();
        let without_gap = refine(&session.exchange((&right, 0), play)[1]);
        let mut astray = session.extend(session.base(), joint);
        astray.cost = 1e12;
        let mut search = nothing_fitted(session);
        search.keep(vec![astray, without_gap.clone()]);
        assert!(search.exchange_nested(&key(&without_gap), PART));
        let again = search.models.get(&key(&right)).unwrap();
        assert!(again.cost < without_gap.cost + CHANCE_GAIN, "{} {}", again.cost, right.cost);
        assert_eq!(search.models.ranked(1)[0], key(&right));
    }

    #[test]
    fn a_spring_that_hardens_is_fitted_in_place_of_a_spring_where_it_gains_more_than_chance() {
        let hardening = |cubic_stiffness: f64| {
            let values = [("stiffness", 5.0), ("cubic_stiffness", cubic_stiffness)];
            multisine_record(plant(), &[Effect::new("hardening_spring", values)], None, 5)
        };
        let exchanged = |measurement: &Measurement| {
            let plant = Some(PlantRequest { actuator_order: 1 });
            let request = IdentifyRequest { plant, ..request() };
            let session = &FitSession::new(measurement, &request, &Silent).unwrap();
            let mut search = nothing_fitted(session);
            let spring = session.extend(session.base(), find("spring").unwrap());
            let spring = session.refine(&spring, FitAccuracy::Settle);
            let chosen = key(&spring);
            search.keep(vec![spring]);
            search.exchange_nested(&chosen, PART)
                && search.models.ranked(1)[0] == vec!["hardening_spring"]
        };
        assert!(exchanged(&hardening(500.0)));
        assert!(!exchanged(&hardening(0.0)));
    }

    // The pair was found without a lag ever being tried beside the drag.
    #[test]
    fn the_closest_imitator_of_an_effect_of_a_pair_is_fitted_in_its_place() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 4), request());
        let session = &FitSession::new(&measurement, &request, &Silent).unwrap();
        let mut search = nothing_fitted(session);
        let fitted = |ids: &[&str]| {
            let effects = ids.iter().map(|id| find(id).unwrap());
            let extend = |model, effect| session.extend(&model, effect);
            session.refine(&effects.fold(session.base().clone(), extend), FitAccuracy::Glance)
        };
        let pair = fitted(&["quadratic_drag", "transport_delay"]);
        let chosen = key(&pair);
        search.keep(vec![fitted(&["quadratic_drag"]), fitted(&["transport_delay"]), pair]);
        search.changes =
            search.changes(&Linearization::new(session, session.base()).unwrap(), PART);
        search.exchange_imitators(&chosen, PART);
        let pairs = search.models.ranked(2);
        assert_eq!(pairs.len(), 2, "{pairs:?}");
        assert!(pairs.contains(&vec!["quadratic_drag", "sensor_lag"]), "{pairs:?}");
    }
}
