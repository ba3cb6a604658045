//! Transfers models fitted to one measurement to another of the same machine, as starting points.

use crate::answers::Comparison;
use crate::measurement::Measurement;
use crate::observer::Observer;
use crate::plant::Plant;

use super::{FitSession, Model};
use crate::identify::history::History;
use crate::identify::parameters::Coordinates;
use crate::identify::pipeline::Run;
use crate::identify::prediction;
use crate::identify::problem::{Problem, Scales};
use crate::identify::request::{IdentifyError, IdentifyRequest};

impl<'a> FitSession<'a> {
    /// A session on `measurement` whose base model is refined from that of `other`.
    ///
    /// # Errors
    /// When cancelled, if the measurement cannot be fitted, or if the base model has no response to
    /// it.
    pub fn continued(
        measurement: &'a Measurement,
        request: &'a IdentifyRequest,
        observer: &'a dyn Observer,
        other: &FitSession<'_>,
    ) -> Result<Self, IdentifyError> {
        let problem = Problem::new(measurement)?;
        let history = History { observer, order: other.order(), orders: (0, 1) };
        let options = &request.options;
        let run = Run {
            steps: request.methods.steps(request.method)?,
            measurement,
            problem: &problem,
            options,
            weights: None,
            lower: None,
            history,
        };
        let plant = problem.in_scale(&other.plant_in_units(&other.base));
        let fitted = run.refit(&plant, other.fitted.stages.clone())?;
        Self::of(measurement, request, observer, problem, fitted, other.order_choice.clone())
    }

    /// Converts a model of another session to this one's units; its cost is unknown.
    pub fn adopt(&self, other: &FitSession<'_>, model: &Model) -> Model {
        let plant = self.problem.in_scale(&other.plant_in_units(model));
        let Problem { tied_friction, prior, .. } = &self.problem;
        let base = Coordinates::new(plant.actuator.order(), *tied_friction, prior);
        let scope = self.problem.scope(&plant);
        let coordinates = model
            .effects()
            .iter()
            .fold(base, |coordinates, effect| coordinates.with_effect(*effect, &scope));
        let mut point = coordinates.point(&plant);
        for (index, effect) in model.effects().iter().enumerate() {
            for (parameter, from) in effect.parameters().iter().zip(model.parameters_of(index)) {
                let unit = |Scales { omega, input, velocity }: Scales| {
                    parameter.dimension.factor(input, velocity, 1.0 / omega)
                };
                let value =
                    model.value(from) * unit(other.problem.scales) / unit(self.problem.scales);
                // If friction is tied in one session and not in the other, the indices of effects
                // differ.
                let to = from - model.coordinates.base_len() + coordinates.base_len();
                point[to] = coordinates.coordinate(to, value);
            }
        }
        coordinates.clamp(&mut point);
        Model { coordinates, point, cost: f64::NAN, evaluations: model.evaluations }
    }

    /// Compares the measurement with a model, in the experiments that are `wanted`.
    pub fn compare(&self, model: &Model, wanted: impl Fn(usize) -> bool) -> Comparison {
        let plant = model.coordinates.plant(&model.point);
        let effects = model.coordinates.effects_at(&model.point);
        let dof = self.problem.data() as i64 - model.parameters() as i64;
        let weights = &self.fitted.weights;
        prediction::beside(self.measurement, &self.problem, &plant, &effects, weights, dof, wanted)
    }

    fn plant_in_units(&self, model: &Model) -> Plant {
        self.problem.in_units(&model.coordinates.plant(&model.point))
    }
}
