//! A fit session: a measurement with its fitted base model, to which models with effects are
//! fitted.

mod answered;
mod changed;
mod coarse;
mod extension;
mod left_out;
mod model;
mod predictions;
mod refit;
mod scales;
mod stated_noise;
mod torque_changes;
mod weighted;

use nalgebra::{DMatrix, DVector};

use crate::answers::{NoiseSource, OrderChoice, Stage};
use crate::effects::{Effect, Scope};
use crate::measurement::{Complex, Measurement};
use crate::observer::Observer;
use crate::simulate::{Counts, LastMotion};

use super::model_fit;
use super::model_fit::ModelFit;
use super::noise::Weights;
use super::noise_law::NoiseLaw;
use super::objective::Misfit;
use super::pipeline::Fitted;
use super::prediction;
use super::problem::Problem;
use super::refine;
use super::refine::Patience;
use super::request::{IdentifyError, IdentifyRequest, no_response};
use super::search_settings::SearchSettings;
use super::solve::{Solved, answer, solve};
use super::summary::Intervals;
use super::unknown_jump;
pub use changed::DatumChange;
use coarse::Coarse;
pub use left_out::LeavingOut;
pub use model::Model;

/// Differences below this share of the largest component count as rounding: two good simulations of
/// one machine agree to no better (contract, section 3).
const ROUNDING_SHARE: f64 = 1e-5;

/// How accurate a fit has to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FitAccuracy {
    /// A few steps, to choose among several starts and effects.
    Glance,
    /// Until χ² changes by far less than 1.
    Settle,
    /// Until no step matters any more: see `refine::THOROUGH`.
    Thorough,
}

/// The residuals of a model, linearised in its parameters.
#[derive(Debug, Clone)]
pub struct Linear {
    /// (Y − Ŷ)/σ.
    pub residuals: DVector<f64>,
    /// (∂Ŷ/∂p)/σ, one column for each parameter.
    pub jacobian: DMatrix<f64>,
    /// Which parameters are held at a bound.
    pub held: Vec<bool>,
}

/// A measurement with its fitted base model.
pub struct FitSession<'a> {
    measurement: &'a Measurement,
    request: &'a IdentifyRequest,
    observer: &'a dyn Observer,
    problem: Problem,
    fitted: Fitted,
    order_choice: Option<OrderChoice>,
    /// Base models of all orders that were tried.
    orders: Vec<Fitted>,
    base: Model,
    stand_in: Vec<Vec<Complex>>,
    /// Where a search looks for the best model; `None` if simulations are cheap.
    coarse: Option<Coarse>,
}

impl<'a> FitSession<'a> {
    /// Fits the base model.
    ///
    /// # Errors
    /// See [`IdentifyError`].
    pub fn new(
        measurement: &'a Measurement,
        request: &'a IdentifyRequest,
        observer: &'a dyn Observer,
    ) -> Result<Self, IdentifyError> {
        let problem = Problem::new(measurement)?;
        Self::solved(measurement, request, observer, problem, (None, &[]))
    }

    /// Fits the base model with the given weights or, without any, with those that the request asks
    /// for; `known` are fits of the same problem with other weights.
    fn solved(
        measurement: &'a Measurement,
        request: &'a IdentifyRequest,
        observer: &'a dyn Observer,
        problem: Problem,
        (weights, known): (Option<&Weights>, &[Fitted]),
    ) -> Result<Self, IdentifyError> {
        let Solved { chosen, order_choice, fits } =
            solve(measurement, &problem, request, (weights, known), observer)?;
        // Of given weights it is still true that others may follow from a better model.
        let depend_on_model =
            weights.map_or(chosen.weights.depend_on_model, |given| given.depend_on_model);
        let weights = Weights { depend_on_model, ..chosen.weights };
        let fitted = Fitted { weights, ..chosen };
        let base = Model {
            coordinates: fitted.coordinates.clone(),
            point: fitted.point.clone(),
            cost: fitted.cost,
            evaluations: fitted.stages.iter().map(|stage| stage.evaluations).sum(),
        };
        let mut this = Self {
            measurement,
            request,
            observer,
            problem,
            fitted,
            order_choice,
            orders: fits,
            base,
            stand_in: Vec::new(),
            coarse: None,
        };
        this.stand_in =
            this.misfit(&this.base).predict(&this.base.point).map_err(|_| no_response())?;
        this.coarse = this.coarsened();
        Ok(this)
    }

    /// The observer of the computation.
    pub fn observer(&self) -> &'a dyn Observer {
        self.observer
    }

    /// The base model, fitted.
    pub fn base(&self) -> &Model {
        &self.base
    }

    /// The order of the actuator.
    pub fn order(&self) -> u8 {
        self.base.coordinates.plant(&self.base.point).actuator.order()
    }

    /// The measurement.
    pub fn measurement(&self) -> &'a Measurement {
        self.measurement
    }

    /// The settings of the search.
    pub fn search(&self) -> &'a SearchSettings {
        &self.request.search
    }

    /// Whether the size of the noise is known.
    pub fn noise_known(&self) -> bool {
        self.fitted.weights.source != NoiseSource::Estimated
    }

    /// The effects that a diagnosis tries.
    pub fn library(&self) -> &'static [&'static dyn Effect] {
        self.request.library.effects()
    }

    /// Number of real data.
    pub fn data(&self) -> usize {
        self.problem.data()
    }

    /// Sum of squared residuals that rounding in the upload and in the simulation leaves.
    pub fn rounding(&self) -> f64 {
        let mut sum = 0.0;
        let targets = || self.problem.experiments.iter().flat_map(|e| &e.targets);
        let largest = targets().map(|target| target.value.norm()).fold(0.0, f64::max);
        for (experiment, sigma) in self.problem.experiments.iter().zip(&self.fitted.weights.sigma) {
            for (target, sigma) in experiment.targets.iter().zip(sigma) {
                let parts = if target.real { 1.0 } else { 2.0 };
                sum += parts * (ROUNDING_SHARE * largest / sigma).powi(2);
            }
        }
        sum
    }

    /// Whether every input is a pure cosine.
    pub fn has_cosines_alone(&self) -> bool {
        self.problem.experiments.iter().all(|e| e.excitation.is_pure_cosine())
    }

    /// Whether the order of acquisition is known.
    pub fn runs_known(&self) -> bool {
        self.problem.runs_known
    }

    /// The distribution of the noise in the residuals.
    pub fn noise(&self) -> NoiseLaw {
        NoiseLaw::new(&self.problem, &self.fitted.weights)
    }

    /// Half the peak-to-peak position where that is largest, in the problem's units.
    pub fn widest_travel(&self) -> f64 {
        self.problem.widest_travel
    }

    /// The scales from which effects derive the ranges of their parameters, in the problem's units.
    fn scope(&self) -> Scope {
        self.problem.scope(&self.base.coordinates.plant(&self.base.point))
    }

    /// Fits all parameters of a model, starting at their current values. If the fit ends in a dead
    /// zone of an effect, it is repeated from outside of it, and the better fit is returned.
    pub fn refine(&self, model: &Model, effort: FitAccuracy) -> Model {
        self.refine_watched(model, effort, &|| ())
    }

    /// The same; `on_step` is called after every step of the fit.
    pub fn refine_watched(&self, model: &Model, effort: FitAccuracy, on_step: &dyn Fn()) -> Model {
        let descend = |from: &Model| self.descend(from, effort, on_step);
        self.escape(descend(model), descend)
    }

    /// If a fit ended in a dead zone of an effect, fits again from outside of it, and returns the
    /// better one.
    fn escape(&self, refined: Model, descend: impl Fn(&Model) -> Model) -> Model {
        let Some(escaped) = refined.escaped() else { return refined };
        let again = descend(&escaped);
        let evaluations = again.evaluations;
        let best = if again.cost < refined.cost { again } else { refined };
        Model { evaluations, ..best }
    }

    fn patience(&self, effort: FitAccuracy) -> Patience {
        let negligible = if self.noise_known() { self.data() as f64 } else { self.rounding() };
        let search = self.search();
        let (steps, cost_tolerance) = match effort {
            FitAccuracy::Glance => (search.glance_steps, search.trial_tolerance),
            FitAccuracy::Settle => (refine::THOROUGH.steps, search.settle_tolerance),
            FitAccuracy::Thorough => return refine::THOROUGH,
        };
        Patience { steps, cost_tolerance, negligible, ..refine::THOROUGH }
    }

    /// A memory of the last motion of each experiment, if others than those from rest count.
    fn motions(&self, misfit: &Misfit<'_>) -> Option<Vec<LastMotion>> {
        let from_rest = matches!(misfit.counts, Counts::FromRest);
        let each = || misfit.problem.experiments.iter().map(|_| LastMotion::default());
        (!from_rest).then(|| each().collect())
    }

    /// Fits a model by this misfit. Each simulation starts from the motion of the one before, unless
    /// only motions from rest count.
    fn descend_by(
        &self,
        misfit: &Misfit<'_>,
        model: &Model,
        patience: Patience,
        on_step: &dyn Fn(),
    ) -> Model {
        let motions = self.motions(misfit);
        let misfit = Misfit { motions: motions.as_deref(), ..*misfit };
        model.refined(refine::refine(&misfit, &model.point, patience, &mut |_, _, _| on_step()))
    }

    /// Everything needed to judge a fitted model. If it has no response from rest in some
    /// experiments, it is fitted again to the others and judged by them.
    ///
    /// # Errors
    /// When it has no response at all.
    pub fn judge(&self, model: &Model, intervals: Intervals) -> Result<ModelFit, IdentifyError> {
        match self.where_answered(model) {
            None => self.judge_whole(model, intervals),
            Some((rest, _)) if rest.data() == 0 => Err(no_response()),
            Some((rest, model)) => rest.judge_whole(&model, intervals),
        }
    }

    fn judge_whole(&self, model: &Model, intervals: Intervals) -> Result<ModelFit, IdentifyError> {
        let fitted = self.fitted(model);
        let (coordinates, weights) = (&fitted.coordinates, &fitted.weights);
        let misfit = self.misfit(model);
        let choice = self.order_choice.clone();
        let (measurement, request) = (self.measurement, self.request);
        let mut identification = answer(measurement, &misfit, request, &fitted, choice, intervals)?;
        let here = misfit.linearise(&model.point).map_err(|_| no_response())?;
        let held = refine::held(&misfit, &model.point, &here);
        let free: Vec<usize> = (0..held.len()).filter(|i| !held[*i]).collect();
        let plant = coordinates.plant(&model.point);
        let effects = coordinates.effects_at(&model.point);
        if self.observer.cancelled() {
            return Err(IdentifyError::Cancelled);
        }
        let dof = identification.fit.dof;
        let all = |_| true;
        let comparison = prediction::beside(
            self.measurement,
            (&self.problem, &[]),
            (&plant, &effects),
            weights,
            dof,
            all,
        );
        identification.fit.unanswered.clone_from(&comparison.unanswered);
        let sigma = match weights.known() {
            true => 1.0,
            false => (model.cost / dof.max(1) as f64).sqrt().max(f64::MIN_POSITIVE),
        };
        Ok(ModelFit {
            identification,
            comparison,
            components: model_fit::components(&self.problem),
            residuals: -here.residuals / sigma,
            jacobian: here.jacobian.select_columns(&free) / sigma,
            eliminated: unknown_jump::columns(&self.problem, weights),
            noise: self.noise(),
            contradicts_noise: self.contradicted_noise(model, dof),
        })
    }

    fn fitted(&self, model: &Model) -> Fitted {
        let mut stages = self.fitted.stages.clone();
        if !model.effects().is_empty() {
            stages.push(Stage {
                name: "extension".into(),
                evaluations: model.evaluations,
                budget: None,
                seconds: 0.0,
                cost: model.cost,
                parameters: super::parameter_names::values(
                    &self.problem.in_units(&model.coordinates.plant(&model.point)),
                ),
                stop_reason: "converged".into(),
            });
        }
        Fitted {
            order: self.fitted.order,
            coordinates: model.coordinates.clone(),
            point: model.point.clone(),
            weights: self.fitted.weights.clone(),
            cost: model.cost,
            stages,
        }
    }

    fn misfit<'m>(&'m self, model: &'m Model) -> Misfit<'m> {
        Misfit {
            problem: &self.problem,
            coordinates: &model.coordinates,
            weights: &self.fitted.weights,
            observer: self.observer,
            stand_in: (!self.stand_in.is_empty()).then_some(&self.stand_in),
            counts: Counts::EvenUnstable,
            motions: None,
        }
    }
}
