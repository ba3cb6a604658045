//! Runs the stages of a method in order: closed form, network, search, refinement.

mod refinement;
mod starts;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::answers::{IdentifyOptions, Stage};
use crate::measurement::Measurement;
use crate::plant::{Actuator, Plant};

use super::history::History;
use super::methods::Steps;
use super::noise::{self, Beside, Weights};
use super::objective::Misfit;
use super::parameters::Coordinates;
use super::problem::Problem;
use super::request::IdentifyError;

/// The base model, fitted with one actuator order.
#[derive(Clone)]
pub(super) struct Fitted {
    /// Actuator order.
    pub order: u8,
    /// The coordinates of the fit.
    pub coordinates: Coordinates,
    /// The fitted point.
    pub point: Vec<f64>,
    /// The weights at that point.
    pub weights: Weights,
    /// The sum of squared residuals at that point.
    pub cost: f64,
    /// The stages that ran, in order.
    pub stages: Vec<Stage>,
}

/// A run of a method for one actuator order.
pub(super) struct Run<'a> {
    /// The stages of the method.
    pub steps: &'a Steps,
    /// The measurement.
    pub measurement: &'a Measurement,
    /// The measurement, prepared for fitting.
    pub problem: &'a Problem,
    /// The same with coarser simulations, for everything before the refinement and for its
    /// beginning; `None` if simulations are cheap.
    pub coarse: Option<&'a Problem>,
    /// The options.
    pub options: &'a IdentifyOptions,
    /// The weights to use; without them, those of the noise.
    pub weights: Option<&'a Weights>,
    /// A fit of this order with other weights: a starting point that takes the place of the
    /// network.
    pub known: Option<&'a Fitted>,
    /// The fit of the next lower order, if there is one: a starting point that this order can only
    /// improve.
    pub lower: Option<&'a Fitted>,
    /// Reports progress.
    pub history: History<'a>,
}

/// What each stage hands on to the next.
#[derive(Default)]
struct StageResults {
    /// Points to refine, as coordinates.
    starts: Vec<Vec<f64>>,
    /// The closed form beside the best of many actuators, as coordinates: followed only if it leads to a
    /// far better fit than all others.
    beside_actuators: Option<Vec<f64>>,
    /// First points of the search, in the unit cube.
    sources: Vec<Vec<f64>>,
    stages: Vec<Stage>,
}

impl Run<'_> {
    /// Runs the stages that the method has and the options enable.
    ///
    /// # Errors
    /// When cancelled, or when no start has a response.
    pub fn fit(&self) -> Result<Fitted, IdentifyError> {
        let coordinates =
            Coordinates::new(self.history.order, self.problem.tied_friction, &self.problem.prior);
        let mut weights = self.weights(None);
        let mut found = StageResults::default();
        let fine = self.misfit(&coordinates, &weights);
        let misfit = Misfit { problem: self.coarse.unwrap_or(self.problem), ..fine };
        self.starts(&misfit, &mut found)?;
        found.starts.sort_by(|a, b| misfit.cost(a).total_cmp(&misfit.cost(b)));
        let point = if self.steps.refinement && self.options.refine {
            self.refinement(&coordinates, &mut weights, &mut found)?
        } else {
            let best = found.starts.swap_remove(0);
            weights = self.weights(Some(&coordinates.plant(&best)));
            best
        };
        let cost = self.misfit(&coordinates, &weights).cost(&point);
        if !cost.is_finite() {
            return Err(no_response());
        }
        let order = self.history.order;
        Ok(Fitted { order, coordinates, point, weights, cost, stages: found.stages })
    }

    /// The fit of the next lower order as a point of this order.
    fn start_of_lower(&self, coordinates: &Coordinates) -> Option<Vec<f64>> {
        self.lower.map(|fitted| {
            let plant = fitted.coordinates.plant(&fitted.point);
            coordinates.point(&with_fast_pole(&plant, self.problem.prior.omega_high))
        })
    }

    fn weights(&self, plant: Option<&Plant>) -> Weights {
        match self.weights {
            Some(weights) => Weights { depend_on_model: false, ..weights.clone() },
            None => {
                let beside = plant.map(|plant| Beside { plant, effects: &[] });
                noise::weights(self.measurement, self.problem, self.options, beside)
            }
        }
    }

    fn misfit<'m>(&'m self, coordinates: &'m Coordinates, weights: &'m Weights) -> Misfit<'m> {
        Misfit::new(self.problem, coordinates, weights, self.history.observer)
    }

    fn in_units(&self, misfit: &Misfit<'_>, point: &[f64]) -> Plant {
        self.problem.in_units(&misfit.coordinates.plant(point))
    }

    /// The random numbers of a stage. Each stage has its own stream, so that disabling one does not
    /// change the others.
    fn stream(&self, stage: u64) -> ChaCha8Rng {
        let mut rng = ChaCha8Rng::seed_from_u64(self.options.seed);
        rng.set_stream(16 * u64::from(self.history.order) + stage);
        rng
    }
}

fn no_response() -> IdentifyError {
    IdentifyError::Unusable {
        reason: "no axis in the search range has a periodic response to this input: check the \
                 units, sign and magnitude of the input, and whether the axis moved"
            .into(),
    }
}

/// The plant with one more actuator pole, too fast to be seen.
fn with_fast_pole(plant: &Plant, omega_high: f64) -> Plant {
    let fast = 30.0 * omega_high;
    let actuator = match plant.actuator {
        Actuator::Direct => Actuator::FirstOrder { corner_rad_s: fast },
        Actuator::FirstOrder { corner_rad_s } => {
            let natural_frequency_rad_s = (corner_rad_s * fast).sqrt();
            let damping_ratio = 0.5 * (corner_rad_s + fast) / natural_frequency_rad_s;
            Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio }
        }
        already @ Actuator::SecondOrder { .. } => already,
    };
    Plant { actuator, ..*plant }
}
