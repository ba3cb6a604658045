//! A fit session: a measurement with its fitted base model, to which models with effects are
//! fitted.

mod answered;
mod changed;
mod coarse;
mod extension;
mod judgement;
mod left_out;
mod model;
mod predictions;
mod refinement;
mod refit;
mod scales;
mod stated_noise;
mod torque_changes;
mod weighted;

use nalgebra::{DMatrix, DVector};

use crate::answers::{NoiseSource, OrderChoice};
use crate::effects::{Effect, Scope};
use crate::measurement::{Complex, Measurement};
use crate::observer::Observer;
use crate::simulate::Counts;

use super::estimated_input;
use super::noise::Weights;
use super::noise_law::NoiseLaw;
use super::objective::Misfit;
use super::pipeline::Fitted;
use super::problem::Problem;
use super::request::{IdentifyError, IdentifyRequest, no_response};
use super::search_settings::SearchSettings;
use super::solve::{Solved, solve};
pub use changed::DatumChange;
use coarse::Coarse;
pub use left_out::LeavingOut;
pub use model::Model;
pub use refinement::FitAccuracy;

/// Differences below this share of the largest component count as rounding: two good simulations of
/// one machine agree to no better (contract, section 3).
const ROUNDING_SHARE: f64 = 1e-5;

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
        let mut problem = problem;
        let mut solved = solve(measurement, &problem, request, (weights, known), observer)?;
        if problem.lacks_inputs() {
            for _ in 0..estimated_input::ROUNDS {
                let Fitted { coordinates, point, weights: own, .. } = &solved.chosen;
                let base = (&coordinates.plant(point), &[][..]);
                problem.estimate_inputs(base, own).map_err(|_| no_response())?;
                let weights = weights.map(|weights| weights.clone().eliminating(&problem));
                let from = (weights.as_ref(), &solved.fits[..]);
                solved = solve(measurement, &problem, request, from, observer)?;
            }
        }
        let Solved { chosen, order_choice, fits } = solved;
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
