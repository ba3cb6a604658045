//! Fits of effects beside a model, from where their probes point.

use rayon::prelude::*;

use crate::effects::Effect;
use crate::identify::{Effort, Model, Workbench};
use crate::observer::Observer as _;

use super::evidence::Yardstick;
use super::probes::{Probe, Probed};
use super::progress::{Part, Stage};

/// Starts that are followed to their end.
const FOLLOWED: usize = 2;

/// Share of the leader's gain that a rival must have come to in its first steps.
const RIVAL: f64 = 0.5;

/// Models that have a response, the best first.
fn best_first(mut models: Vec<Model>) -> Vec<Model> {
    models.retain(|model| model.cost.is_finite());
    models.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    models
}

/// Whether an effect that has gained this much on `from` so far may yet be as good
/// as the leading model.
fn is_rival(from: &Model, leader: &Model, effect: &'static dyn Effect, gain: f64) -> bool {
    let mistaken = |own: &&'static dyn Effect| {
        own.imitators().contains(&effect.id()) || effect.imitators().contains(&own.id())
    };
    leader.effects().iter().any(mistaken) || gain > RIVAL * (from.cost - leader.cost)
}

/// Who fits.
pub(super) struct Fitter<'a> {
    /// Where.
    pub workbench: &'a Workbench<'a>,
    /// Who may cancel.
    pub part: Part<'a>,
    /// What a good fit is.
    pub yardstick: Yardstick,
    /// Starts that are tried of an effect that promises something.
    pub starts: usize,
    /// Whether an effect is followed to its end though little was gained so far, where
    /// none explains the data.
    pub patient: bool,
}

impl Fitter<'_> {
    /// Fits every effect beside those of `from`, from its probes. What promises
    /// something is followed from several starts; once one explains the data, only what
    /// may be mistaken for it or is as good so far is followed to the end.
    pub fn fit(
        &self,
        from: &Model,
        probed: &[Probed],
        promising: impl Fn(&Probed) -> bool + Sync,
        stage: &Stage<'_>,
    ) -> Vec<Model> {
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
        fits.extend(open.into_iter().filter_map(|(_, models)| self.settled(models, FOLLOWED)));
        let leader = fits.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).cloned();
        let unexplained =
            leader.as_ref().is_some_and(|leader| !self.yardstick.explains(leader.cost));
        let follow = |(effect, models): (&'static dyn Effect, Vec<Model>)| {
            let gain = from.cost - models[0].cost;
            let rival = |leader: &Model| is_rival(from, leader, effect, gain);
            if leader.as_ref().is_none_or(rival) {
                self.settled(models, FOLLOWED)
            } else if self.patient && unexplained {
                self.settled(models, 1)
            } else {
                models.into_iter().next()
            }
        };
        fits.extend(rest.into_par_iter().filter_map(follow).collect::<Vec<Model>>());
        fits
    }

    /// The first steps from an effect's probes, the best first.
    fn tried(&self, probed: &Probed, promising: bool) -> Vec<Model> {
        let (starts, effort) = match promising {
            true => (self.starts, Effort::Glance),
            false => (1, Effort::Brief),
        };
        let starts: Vec<&Probe> = probed.probes.iter().take(starts).collect();
        let tried = starts.par_iter().map(|probe| self.refine(&probe.start, effort)).collect();
        best_first(tried)
    }

    /// The best of what the first of these come to.
    fn settled(&self, mut tried: Vec<Model>, followed: usize) -> Option<Model> {
        tried.truncate(followed);
        let settled = tried.par_iter().map(|model| self.refine(model, Effort::Settle)).collect();
        best_first(settled).into_iter().next()
    }

    /// A model, fitted; as it is once cancelled.
    pub fn refine(&self, model: &Model, effort: Effort) -> Model {
        match self.part.cancelled() {
            true => model.clone(),
            false => self.workbench.refine(model, effort),
        }
    }
}
