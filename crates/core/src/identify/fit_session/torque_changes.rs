//! How a small torque that depends on the motion changes the response, to first order.

use nalgebra::DVector;

use crate::effects;
use crate::effects::{ActiveEffect, Axis, Effect};
use crate::plant::Plant;
use crate::simulate::{Torque, TorqueResponses};

use super::{FitSession, Model};
use crate::identify::objective::Misfit;
use crate::identify::problem::Prepared;

/// Limits the number of samples per period: a periodic torque whose angle changes by more than this
/// over the travel, rad, is sampled no more finely (tuned).
const LARGEST_SAMPLED_ANGLE: f64 = 2000.0;

/// The base part of a model, moving in every experiment.
pub struct TorqueChanges<'s> {
    session: &'s FitSession<'s>,
    misfit: Misfit<'s>,
    plant: Plant,
    /// One for each experiment.
    motions: Vec<TorqueResponses<'s>>,
}

impl FitSession<'_> {
    /// Prepares what a torque changes beside a model, whose effects are ignored. `None` if the base
    /// model has no response, or once the observer cancels.
    pub fn torque_changes<'s>(&'s self, model: &'s Model) -> Option<TorqueChanges<'s>> {
        if self.observer.cancelled() {
            return None;
        }
        let misfit = self.search_misfit(model);
        let plant = model.coordinates.plant(&model.point);
        let motion = |experiment: &'s Prepared| {
            TorqueResponses::new(&plant, &experiment.excitation, experiment.highest).ok()
        };
        let motions = misfit.problem.experiments.iter().map(motion).collect::<Option<_>>()?;
        Some(TorqueChanges { session: self, misfit, plant, motions })
    }
}

impl TorqueChanges<'_> {
    /// Change of Ŷ/σ caused by each of these `settings` of an effect that is a torque. A constant
    /// torque keeps the mean velocity unchanged. `turns` is the angle of the torque per unit of
    /// travel, in the problem's units. `None` once the observer cancels.
    pub fn by(
        &self,
        effect: &'static dyn Effect,
        settings: &[Vec<f64>],
        turns: f64,
    ) -> Option<Vec<DVector<f64>>> {
        if self.session.observer.cancelled() {
            return None;
        }
        let laws: Vec<Axis> = settings
            .iter()
            .filter_map(|values| ActiveEffect::new(effect, values.clone()).ok())
            .map(|active| effects::enter_values(self.plant, &[active], 0.0))
            .collect();
        let torques: Vec<_> = laws
            .iter()
            .map(|axis| {
                move |v: f64, position: f64| -> f64 {
                    axis.torques.iter().map(|law| law.at(v, position)).sum()
                }
            })
            .collect();
        let torques: Vec<&Torque<'_>> = torques.iter().map(|torque| torque as _).collect();
        let mut changes = vec![DVector::zeros(self.session.data()); settings.len()];
        let Misfit { problem, weights, .. } = self.misfit;
        let mut row = 0;
        let experiments = problem.experiments.iter().zip(&weights.sigma).zip(&self.motions);
        for ((experiment, sigma), motion) in experiments {
            let Prepared { excitation, highest, targets, .. } = experiment;
            let travel = targets.iter().filter(|target| target.order > 0).map(|target| {
                let rate = target.order as f64 * excitation.omega_rad_s();
                (target.value / target.per_velocity).norm() / rate
            });
            let angle = turns * travel.fold(0.0, f64::max);
            let samples = 4 * (angle.min(LARGEST_SAMPLED_ANGLE) as usize + highest + 16);
            let moved = motion.to(&torques, samples);
            for (change, moved) in changes.iter_mut().zip(&moved) {
                let mut row = row;
                for (target, sigma) in targets.iter().zip(sigma) {
                    let value = moved[target.order] * target.per_velocity / *sigma;
                    change[row] = value.re;
                    row += 1;
                    if !target.real {
                        change[row] = value.im;
                        row += 1;
                    }
                }
            }
            row += targets.iter().map(|target| if target.real { 1 } else { 2 }).sum::<usize>();
        }
        changes.iter_mut().for_each(|change| weights.reduce(change.as_mut_slice()));
        Some(changes)
    }
}
