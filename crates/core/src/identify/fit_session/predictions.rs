//! Residuals and derivatives of a model in the experiments of the measurement, and its predictions
//! for other inputs.

use nalgebra::DVector;

use crate::simulate;

use super::{FitSession, Linear, Model};
use crate::identify::objective::Misfit;
use crate::identify::problem::{Scales, per_velocity};
use crate::identify::refine;

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
