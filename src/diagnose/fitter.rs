//! Fits of effects beside a model, from where their probes point.

use rayon::prelude::*;

use crate::effects::{are_alike, are_kin};
use crate::identify::{Effort, Model, Workbench};
use crate::observer::Observer as _;

use super::evidence::Yardstick;
use super::probes::{Probe, Probed};
use super::progress::{Part, Stage};

/// Share of the leader's gain that a rival must have come to in its first steps.
const RIVAL: f64 = 0.5;

/// The same of an effect that may be one of several, where none explains the data.
const HOPEFUL: f64 = 0.02;

/// Models that have a response, the best first.
fn best_first(mut models: Vec<Model>) -> Vec<Model> {
    models.retain(|model| model.cost.is_finite());
    models.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    models
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
    /// Of them, those that are followed to their end.
    pub followed: usize,
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
        let mut tried: Vec<(&Probed, Vec<Model>)> = probed.par_iter().map(try_out).collect();
        tried.retain(|(_, models)| !models.is_empty());
        tried.sort_by(|a, b| a.1[0].cost.total_cmp(&b.1[0].cost));
        let Some(first) = tried.iter().position(|(probed, _)| promising(probed)) else {
            return tried.into_iter().filter_map(|(_, models)| models.into_iter().next()).collect();
        };
        let (probed, models) = tried.remove(first);
        let leader = self.settled(models, self.followed).unwrap_or_else(|| from.clone());
        let unexplained = !self.yardstick.explains(leader.cost);
        let most = from.cost - leader.cost;
        let follow = |(rival, models): (&Probed, Vec<Model>)| {
            let gain = from.cost - models[0].cost;
            if are_alike(probed.effect, rival.effect) || gain > RIVAL * most {
                self.settled(models, self.followed)
            } else if self.patient && unexplained && promising(rival) && gain > HOPEFUL * most {
                self.settled(models, 1)
            } else {
                models.into_iter().next()
            }
        };
        let mut fits: Vec<Model> = tried.into_par_iter().filter_map(follow).collect();
        fits.push(leader);
        let hopes = if self.patient && unexplained { HOPEFUL } else { RIVAL };
        let counts = |kin: &&Model| from.cost - kin.cost > hopes * most;
        let kin: Vec<&Model> = fits.iter().filter(counts).collect();
        let again = |fit| self.refit_from_kin(fit, &kin);
        let again: Vec<Model> = fits.par_iter().filter_map(again).collect();
        fits.extend(again);
        fits
    }

    /// A fit again, from where the best of its kin ended, if that fits better: what contains
    /// another can do no worse, and what is contained may do as well.
    fn refit_from_kin(&self, fit: &Model, kin: &[&Model]) -> Option<Model> {
        let own = *fit.effects().last()?;
        let is_kin = |other: &&&Model| other.effects().last().is_some_and(|o| are_kin(own, *o));
        let better = kin.iter().filter(is_kin).filter(|other| other.cost < fit.cost);
        let best = better.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        self.settled(self.workbench.exchange(best, own).into(), self.followed)
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

#[cfg(test)]
mod tests {
    use super::super::tests::{exact, noisy, request};
    use super::*;
    use crate::benchmark::draw::NoiseStatement;
    use crate::effects::find;
    use crate::observer::Silent;

    // What contains it must come to its cost at least; a settled cost is good to 1e-5.
    #[test]
    fn play_that_fits_worse_than_the_joint_without_it_starts_again_from_there() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 4), request());
        let workbench = Workbench::new(&measurement, &request, &Silent).unwrap();
        let base = workbench.base();
        let part = Part { whole: &Silent, span: [0.0, 1.0] };
        let yardstick = Yardstick { known: true, rounding: 0.0, dof: 100.0 };
        let (workbench, starts, followed, patient) = (&workbench, 1, 2, true);
        let fitter = Fitter { workbench, part, yardstick, starts, followed, patient };
        let with = |id: &str| workbench.extend(base, find(id).unwrap());
        let mut joint = with("flexible_mode");
        let places = workbench.places(joint.effects()[0]);
        let own = joint.parameters_of(0).zip(&places[places.len() / 2]);
        own.for_each(|(i, value)| joint.set(i, *value));
        let joint = fitter.refine(&joint, Effort::Settle);
        let costing = |cost: f64, id: &str| {
            let mut model = with(id);
            model.cost = cost;
            model
        };
        let lost = costing(2.0 * joint.cost, "backlash");
        let found = fitter.refit_from_kin(&lost, &[&joint]).unwrap();
        assert_eq!(found.effects()[0].id(), "backlash");
        assert!(found.cost < joint.cost * (1.0 + 1e-5), "{} {}", found.cost, joint.cost);
        assert!(fitter.refit_from_kin(&joint, &[&lost]).is_none());
        assert!(fitter.refit_from_kin(&costing(f64::MAX, "spring"), &[&joint]).is_none());
    }
}
