//! Residuals and derivatives of a model in the experiments of the measurement, and its predictions
//! for other inputs.

use nalgebra::DVector;

use crate::effects;
use crate::effects::{ActiveEffect, Axis, Effect};
use crate::simulate;
use crate::simulate::Torque;

use super::{FitSession, Linear, Model};
use crate::identify::objective::Misfit;
use crate::identify::problem::{Prepared, Scales, per_velocity};
use crate::identify::refine;
use crate::identify::unknown_jump;

/// Limits the number of samples per period: a periodic torque whose angle changes by more than this
/// over the travel, rad, is sampled no more finely (tuned).
const LARGEST_SAMPLED_ANGLE: f64 = 2000.0;

impl FitSession<'_> {
    /// Ŷ/σ of a model while a search looks for the best one, in the order of the residuals; `None`
    /// if it has no response, or once the observer cancels.
    pub fn predict(&self, model: &Model) -> Option<DVector<f64>> {
        let misfit = self.search_misfit(model);
        Some(self.prediction_less_data(&misfit, model)? + self.data_in_sigmas(&misfit))
    }

    /// Σ|Y − Ŷ|²/σ² of a model at its parameters; `None` if it has no response, or once the
    /// observer cancels.
    pub fn cost(&self, model: &Model) -> Option<f64> {
        Some(self.prediction_less_data(&self.misfit(model), model)?.norm_squared())
    }

    /// (Ŷ − Y)/σ of a model at its parameters; `None` as for [`Self::predict`].
    fn prediction_less_data(&self, misfit: &Misfit<'_>, model: &Model) -> Option<DVector<f64>> {
        if self.observer.cancelled() {
            return None;
        }
        misfit.residuals(&model.point).ok()
    }

    /// Y/σ, in the order of the residuals.
    fn data_in_sigmas(&self, misfit: &Misfit<'_>) -> DVector<f64> {
        let mut rows = Vec::with_capacity(self.data());
        for (experiment, sigma) in misfit.problem.experiments.iter().zip(&misfit.weights.sigma) {
            for (target, sigma) in experiment.targets.iter().zip(sigma) {
                rows.push(target.value.re / sigma);
                if !target.real {
                    rows.push(target.value.im / sigma);
                }
            }
        }
        DVector::from_vec(rows)
    }

    /// Change of Ŷ/σ caused by each of these `settings` of an effect that is a torque, to first
    /// order. The model's other effects are ignored, and a constant torque keeps the mean velocity
    /// unchanged. `turns` is the angle of the torque per unit of travel, in the problem's units.
    /// `None` if the base model has no response, or once the observer cancels.
    pub fn torque_changes(
        &self,
        model: &Model,
        effect: &'static dyn Effect,
        settings: &[Vec<f64>],
        turns: f64,
    ) -> Option<Vec<DVector<f64>>> {
        if self.observer.cancelled() {
            return None;
        }
        let plant = model.coordinates.plant(&model.point);
        let laws: Vec<Axis> = settings
            .iter()
            .filter_map(|values| ActiveEffect::new(effect, values.clone()).ok())
            .map(|active| effects::enter_values(plant, &[active], 0.0))
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
        let mut changes = vec![DVector::zeros(self.data()); settings.len()];
        let Misfit { problem, weights, .. } = self.search_misfit(model);
        let mut row = 0;
        for (experiment, sigma) in problem.experiments.iter().zip(&weights.sigma) {
            let Prepared { excitation, highest, targets, .. } = experiment;
            let travel = targets.iter().filter(|target| target.order > 0).map(|target| {
                let rate = target.order as f64 * excitation.omega_rad_s();
                (target.value / target.per_velocity).norm() / rate
            });
            let angle = turns * travel.fold(0.0, f64::max);
            let samples = 4 * (angle.min(LARGEST_SAMPLED_ANGLE) as usize + highest + 16);
            let moved =
                simulate::respond_to_torques(&plant, excitation, *highest, &torques, samples)
                    .ok()?;
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
        let jumps = unknown_jump::directions(problem, weights);
        changes.iter_mut().for_each(|c| unknown_jump::eliminate(&jumps, c.as_mut_slice()));
        Some(changes)
    }

    /// The residuals of a model and their derivatives while a search looks for the best one; `None`
    /// if it has no response.
    pub fn linearise(&self, model: &Model) -> Option<Linear> {
        let misfit = self.search_misfit(model);
        let here = misfit.linearise(&model.point).ok()?;
        let held = refine::held(&misfit, &model.point, &here);
        Some(Linear { residuals: -here.residuals, jacobian: here.jacobian, held })
    }

    /// Σ|ΔY|²/σ² between two models, in an experiment with a pure cosine of this magnitude (input
    /// units) and frequency (rad/s). σ is the median standard deviation of the data. `None` if
    /// either model has no response, or once the observer cancels.
    pub fn separation(&self, models: [&Model; 2], magnitude: f64, omega_rad_s: f64) -> Option<f64> {
        if self.observer.cancelled() {
            return None;
        }
        let Scales { omega, input, .. } = self.problem.scales;
        let omega = omega_rad_s / omega;
        let excitation = simulate::Excitation::cosine(omega, magnitude / input);
        let wanted = self.problem.experiments.iter().max_by_key(|experiment| experiment.highest)?;
        let respond = |model: &Model| {
            let plant = model.coordinates.plant(&model.point);
            let effects = model.coordinates.effects_at(&model.point);
            simulate::respond(&plant, &effects, &excitation, wanted.highest).ok()
        };
        let (first, second) = (respond(models[0])?, respond(models[1])?);
        let mut sigmas: Vec<f64> = self.fitted.weights.sigma.iter().flatten().copied().collect();
        sigmas.sort_by(f64::total_cmp);
        let sigma = sigmas.get(sigmas.len() / 2)?;
        let kind = self.measurement.metadata().response_kind;
        let targets = wanted.targets.iter().filter(|target| !target.constraint);
        let squares = targets.map(|target| {
            let k = target.order;
            ((first[k] - second[k]) * per_velocity(kind, k, omega) / sigma).norm_sqr()
        });
        Some(squares.sum())
    }
}
