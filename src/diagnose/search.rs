//! Which effects the base model lacks.
//!
//! Every effect is fitted together with the base model, from several starts;
//! then pairs and triples grow from the best. An effect stays only while its
//! model is worse without it by more than chance makes any effect of the
//! library gain (`family`), each model refitted; among the models of which that
//! holds the evidence decides (`evidence`).

use std::collections::{BTreeMap, BTreeSet};

use rayon::prelude::*;

use crate::effects::{ALL, Effect};
use crate::identify::{Effort, Model, Workbench};
use crate::observer::Observer;

use super::anchor::Anchor;
use super::evidence::{self, Yardstick};
use super::family::Family;
use super::probes::{Changes, Probe, Probed};
use super::progress::{Part, Stage};

/// Starts of a fit of which a few steps are taken.
const STARTS: usize = 4;

/// Starts that are followed to their end.
const FOLLOWED: usize = 2;

/// Effects that are fitted in addition to others, those of the largest gain.
const FURTHER: usize = 5;

/// Models of one size from which larger ones grow.
const BREADTH: usize = 3;

/// Effects of a model, at most.
const MOST_EFFECTS: usize = 3;

/// Share of the limit that a probe's gain must reach for a fit to be worthwhile.
const PROMISING: f64 = 0.7;

/// Shares of a search: what every effect would change, and every effect alone.
const PROBING: [f64; 2] = [0.0, 0.3];
const CANDIDATES: [f64; 2] = [0.3, 0.7];

/// Share of what is left of a search that adding one more effect takes: how often that
/// will be done is not known.
const COMBINATIONS: f64 = 0.3;

/// Ids of a model's effects, in order.
pub(super) type Key = Vec<&'static str>;

/// A model that was fitted.
pub(super) struct Visited {
    /// The model.
    pub model: Model,
    /// −2 ln of what speaks for its parameters: see [`evidence`].
    pub complexity: f64,
}

/// The models that were fitted, and what they are judged by.
pub(super) struct Search<'a> {
    workbench: &'a Workbench<'a>,
    part: Part<'a>,
    seed: u64,
    /// How costs are compared.
    pub yardstick: Yardstick,
    /// Every fitted model.
    pub visited: BTreeMap<Key, Visited>,
    /// What every effect changes beside the base model.
    changes: Vec<Changes>,
    /// Share of the search that is done.
    reached: f64,
    /// Models from which larger ones were grown.
    grown: BTreeSet<Key>,
    /// What an effect must gain at the base model.
    pub family: Option<Family>,
}

/// Ids of a model's effects, in order.
pub(super) fn key(model: &Model) -> Key {
    let mut key: Key = model.effects().iter().map(|effect| effect.id()).collect();
    key.sort_unstable();
    key
}

/// Whether an effect may gain more than chance; `scale` is the noise's variance in
/// units of the weights.
fn promises(probed: &Probed, family: &Family, scale: f64) -> bool {
    probed.promise() / scale > PROMISING * family.limit(probed.effect.id())
}

/// Models that have a response, the best first.
fn best_first(mut models: Vec<Model>) -> Vec<Model> {
    models.retain(|model| model.cost.is_finite());
    models.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    models
}

impl<'a> Search<'a> {
    /// With nothing but the base model.
    pub fn new(
        workbench: &'a Workbench<'a>,
        part: Part<'a>,
        seed: u64,
        yardstick: Yardstick,
    ) -> Self {
        let base = Visited { model: workbench.base().clone(), complexity: 0.0 };
        let visited = BTreeMap::from([(Key::new(), base)]);
        Self {
            workbench,
            part,
            seed,
            yardstick,
            visited,
            changes: Vec::new(),
            reached: CANDIDATES[1],
            grown: BTreeSet::new(),
            family: None,
        }
    }

    /// Fits every effect alone.
    pub fn singles(&mut self) {
        let Some(anchor) = Anchor::new(self.workbench, self.workbench.base()) else { return };
        self.changes = self.changes(&anchor);
        let probed = self.probe(&anchor);
        let family = self.family(&anchor, &probed);
        let scale = self.variance(&anchor);
        let stage = self.part.part(CANDIDATES).stage("candidates", probed.len());
        let promising = |probed: &Probed| promises(probed, &family, scale);
        let fits = self.fit(&anchor.model, &probed, promising, &stage);
        self.family = Some(family);
        fits.into_iter().for_each(|visited| self.keep(visited));
    }

    /// Fits models with one more effect than `from`, those that promise most;
    /// says whether there was any.
    pub fn grow(&mut self, from: &Key, everything: bool) -> bool {
        if !self.grown.insert(from.clone()) {
            return false;
        }
        let Some(anchor) =
            self.visited.get(from).and_then(|v| Anchor::new(self.workbench, &v.model))
        else {
            return false;
        };
        let mut probed = self.probe(&anchor);
        let family = self.family(&anchor, &probed);
        let scale = self.variance(&anchor);
        let promising = |probed: &Probed| promises(probed, &family, scale);
        probed.retain(|probed| everything || promising(probed));
        probed.sort_by(|a, b| b.promise().total_cmp(&a.promise()));
        probed.truncate(FURTHER);
        let reached = self.reached + COMBINATIONS * (1.0 - self.reached);
        let stage = self.part.part([self.reached, reached]).stage("combinations", probed.len());
        let fits = self.fit(&anchor.model, &probed, promising, &stage);
        self.reached = reached;
        let any = !fits.is_empty();
        fits.into_iter().for_each(|visited| self.keep(visited));
        any
    }

    fn variance(&self, anchor: &Anchor) -> f64 {
        let known = self.yardstick.known;
        if known { 1.0 } else { anchor.model.cost / anchor.dof() }
    }

    /// Fits what a model is without each of its effects, where it was not yet.
    pub fn shrink(&mut self, from: &Key) {
        let Some(Visited { model, .. }) = self.visited.get(from) else { return };
        let missing: Vec<Model> = (0..model.effects().len())
            .map(|index| self.workbench.reduce(model, index))
            .filter(|model| !self.visited.contains_key(&key(model)))
            .collect();
        let fits: Vec<Visited> = missing
            .par_iter()
            .map(|model| self.visit(self.refine(model, Effort::Settle)))
            .collect();
        fits.into_iter().for_each(|visited| self.keep(visited));
    }

    /// What every effect of the library changes that can be tested.
    fn changes(&self, anchor: &Anchor) -> Vec<Changes> {
        let testable =
            |effect: &&&'static dyn Effect| self.workbench.runs_known() || !effect.needs_run();
        let effects: Vec<&&dyn Effect> = ALL.iter().filter(testable).collect();
        let stage = self.part.part(PROBING).stage("probing", effects.len());
        let changes = |effect: &&'static dyn Effect| {
            let changes = Changes::of(self.workbench, anchor, *effect);
            stage.step();
            changes
        };
        effects.into_par_iter().filter(|_| !self.part.cancelled()).map(changes).collect()
    }

    /// Probes of every effect that the model lacks and can have.
    fn probe(&self, anchor: &Anchor) -> Vec<Probed> {
        let (own, workbench) = (anchor.model.effects(), self.workbench);
        let lacks = |changes: &&Changes| own.iter().all(|own| own.id() != changes.effect.id());
        let lacking: Vec<&Changes> = self.changes.iter().filter(lacks).collect();
        let settles = own.iter().any(|effect| effect.settles());
        lacking
            .into_par_iter()
            .filter(|_| !self.part.cancelled())
            .map(|changes| match settles && changes.effect.settles() {
                // Half of what it changes beside the base model is there already.
                true => Changes::of(workbench, anchor, changes.effect).probe(workbench, anchor),
                false => changes.probe(workbench, anchor),
            })
            .collect()
    }

    fn family(&self, anchor: &Anchor, probed: &[Probed]) -> Family {
        Family::new(anchor, &self.workbench.noise(), self.yardstick.known, probed, self.seed)
    }

    /// Fits every effect beside those of `from`, from its probes. What promises
    /// something is followed from several starts; once one explains the data, only what
    /// may be mistaken for it or is as good so far is followed to the end.
    fn fit(
        &self,
        from: &Model,
        probed: &[Probed],
        promising: impl Fn(&Probed) -> bool + Sync,
        stage: &Stage<'_>,
    ) -> Vec<Visited> {
        let try_out = |probed| {
            let tried = self.tried(probed, promising(probed));
            stage.step();
            (probed, tried)
        };
        let tried: Vec<(&Probed, Vec<Model>)> = probed.par_iter().map(try_out).collect();
        let (mut open, mut fits) = (Vec::new(), Vec::new());
        for (probed, mut models) in tried {
            match promising(probed) {
                true if !models.is_empty() => open.push((probed.effect, models)),
                _ => fits.extend(models.pop()),
            }
        }
        open.sort_by(|a, b| a.1[0].cost.total_cmp(&b.1[0].cost));
        let rest = open.split_off(open.len().min(1));
        fits.extend(open.into_iter().filter_map(|(_, models)| self.settled(models)));
        let leader = fits.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).cloned();
        let (near, far): (Vec<_>, Vec<_>) = rest.into_iter().partition(|(effect, models)| {
            let gain = from.cost - models[0].cost;
            leader.as_ref().is_none_or(|leader| self.is_rival(from, leader, *effect, gain))
        });
        let near = near.into_par_iter().filter_map(|(_, models)| self.settled(models));
        fits.extend(near.collect::<Vec<Model>>());
        fits.extend(far.into_iter().filter_map(|(_, models)| models.into_iter().next()));
        fits.into_par_iter().map(|model| self.visit(model)).collect()
    }

    /// Whether an effect that has gained this much on `from` so far may yet be as good
    /// as the leading model.
    fn is_rival(
        &self,
        from: &Model,
        leader: &Model,
        effect: &'static dyn Effect,
        gain: f64,
    ) -> bool {
        let mistaken = |own: &&'static dyn Effect| {
            own.imitators().contains(&effect.id()) || effect.imitators().contains(&own.id())
        };
        !self.yardstick.explains(leader.cost)
            || leader.effects().iter().any(mistaken)
            || gain > 0.5 * (from.cost - leader.cost)
    }

    /// The first steps from an effect's probes, the best first.
    fn tried(&self, probed: &Probed, promising: bool) -> Vec<Model> {
        let (starts, effort) = match promising {
            true => (STARTS, Effort::Glance),
            false => (1, Effort::Brief),
        };
        let starts: Vec<&Probe> = probed.probes.iter().take(starts).collect();
        let tried = starts.par_iter().map(|probe| self.refine(&probe.start, effort)).collect();
        best_first(tried)
    }

    /// The best of what these come to.
    fn settled(&self, mut tried: Vec<Model>) -> Option<Model> {
        tried.truncate(FOLLOWED);
        let settled = tried.par_iter().map(|model| self.refine(model, Effort::Settle)).collect();
        best_first(settled).into_iter().next()
    }

    fn refine(&self, model: &Model, effort: Effort) -> Model {
        match self.part.cancelled() {
            true => model.clone(),
            false => self.workbench.refine(model, effort),
        }
    }

    fn visit(&self, model: Model) -> Visited {
        let complexity = evidence::complexity(self.workbench, &model, &self.yardstick);
        Visited { model, complexity }
    }

    /// Keeps a model, unless one with the same effects fits better.
    fn keep(&mut self, visited: Visited) {
        let key = key(&visited.model);
        let best = self.visited.get(&key).map_or(f64::INFINITY, |known| known.model.cost);
        if visited.model.cost < best {
            self.visited.insert(key, visited);
        }
    }

    /// −2 ln of what speaks for a model, by a yardstick.
    pub fn criterion(&self, key: &Key) -> f64 {
        self.visited.get(key).map_or(f64::INFINITY, |visited| {
            self.yardstick.misfit(visited.model.cost) + visited.complexity
        })
    }

    /// By how much the misfit grows where this effect is taken away, everything
    /// else refitted; 0 where that was not computed.
    pub fn loss(&self, key: &Key, id: &str) -> f64 {
        let without: Key = key.iter().copied().filter(|other| *other != id).collect();
        let misfit = |key: &Key| {
            self.visited.get(key).map(|visited| self.yardstick.misfit(visited.model.cost))
        };
        match (misfit(&without), misfit(key)) {
            (Some(without), Some(with)) => without - with,
            _ => 0.0,
        }
    }

    /// Whether each effect of a model is more than chance.
    pub fn supported(&self, key: &Key) -> bool {
        let limit = |id: &str| self.family.as_ref().map_or(f64::INFINITY, |f| f.limit(id));
        key.iter().all(|id| self.loss(key, id) > limit(id))
    }

    /// Models with so many effects, the best first.
    pub fn ranked(&self, effects: usize) -> Vec<Key> {
        let mut keys: Vec<Key> =
            self.visited.keys().filter(|key| key.len() == effects).cloned().collect();
        keys.sort_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)));
        keys
    }

    /// The best of the models each of whose effects is more than chance.
    pub fn best_supported(&self) -> Key {
        self.visited
            .keys()
            .filter(|key| self.supported(key))
            .min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)))
            .cloned()
            .unwrap_or_default()
    }

    /// Fits singles, then pairs and triples as long as `sufficient` does not
    /// hold of the best.
    pub fn run(&mut self, sufficient: &mut dyn FnMut(&Model) -> bool) -> Key {
        self.singles();
        for size in 1..MOST_EFFECTS {
            let best = self.best_supported();
            if best.len() < size || self.part.cancelled() {
                break;
            }
            let enough = sufficient(&self.visited[&best].model);
            let mut grown = self.grow(&best, !enough);
            if !enough {
                for other in self.ranked(size).into_iter().take(BREADTH) {
                    if other != best {
                        grown |= self.grow(&other, true);
                    }
                }
            }
            if !grown {
                break;
            }
            // The best of the larger models is held against all that it contains,
            // and against its rivals in the place of each of its effects.
            if let Some(next) = self.ranked(size + 1).first().cloned() {
                self.shrink(&next);
                for id in &next {
                    let rest: Key = next.iter().copied().filter(|other| other != id).collect();
                    if rest != best {
                        self.grow(&rest, !enough);
                    }
                }
            }
        }
        self.best_supported()
    }
}
