//! Runs the stages of a method in order: closed form, network, search, refinement.

use std::ops::ControlFlow;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::answers::{IdentifyOptions, Stage};
use crate::measurement::Measurement;
use crate::plant::{Actuator, Plant};

use super::closed_form;
use super::history::History;
use super::methods::Steps;
use super::minima::different_minima;
use super::noise::{self, Beside, Weights};
use super::objective::Misfit;
use super::optimiser::{self, Optimiser, Search};
use super::parameters::Coordinates;
use super::problem::Problem;
use super::proposal;
use super::refine::{self, Patience, Refined};
use super::request::IdentifyError;
use super::saturated;
use super::unit_cube_objective::OverCube;

/// Most rounds of refinement in which weights that depend on the model are recomputed.
const MOST_REWEIGHTINGS: usize = 6;

/// If no coordinate moves by more than this in a round, the weights have converged.
const CONVERGED_CHANGE: f64 = 1e-6;

/// How far every start is refined, on the coarse problem if there is one.
const ROUGH: Patience = Patience { cost_tolerance: 1e-5, ..refine::THOROUGH };

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

    /// The points to refine: those of every stage that the method has and the options enable.
    fn starts(&self, misfit: &Misfit<'_>, found: &mut StageResults) -> Result<(), IdentifyError> {
        let Steps { closed_form, network, search, .. } = self.steps;
        if search.is_none() {
            self.closed_form_alone(misfit, found)?;
        } else if *closed_form && self.options.closed_form_start {
            self.closed_form(misfit, found);
        }
        if let Some(known) = self.known {
            found.sources.push(misfit.coordinates.share_of_search(&known.point));
            found.starts.push(known.point.clone());
        } else if *network && self.options.network.enabled {
            self.network(misfit, found)?;
        }
        if let Some(optimiser) = search.filter(|search| search.is_enabled(self.options)) {
            self.search(optimiser, misfit, found)?;
        }
        if found.starts.is_empty() {
            let coordinates = misfit.coordinates;
            let mut middle = coordinates.within_search(&vec![0.5; coordinates.len() - 1]);
            misfit.solve_for_constant(&mut middle);
            found.starts.push(middle);
        }
        Ok(())
    }

    fn closed_form(&self, misfit: &Misfit<'_>, found: &mut StageResults) {
        let begun = self.history.begin("closed_form", 1);
        if let Some(plant) = closed_form::start(self.problem, self.history.order) {
            let mut point = misfit.coordinates.point(&plant);
            let cost = misfit.solve_for_constant(&mut point);
            begun.row(0, 1, cost, None);
            found.stages.push(begun.end(1, cost, &self.in_units(misfit, &point), "solved"));
            found.sources.push(misfit.coordinates.share_of_search(&point));
            found.starts.push(point);
        }
    }

    fn network(&self, misfit: &Misfit<'_>, found: &mut StageResults) -> Result<(), IdentifyError> {
        let options = &self.options.network;
        let begun = self.history.begin("network", options.epochs as u64);
        let plants = options.training_plants as u64;
        let mut rng = self.stream(1);
        let proposal =
            proposal::propose(misfit, options, &mut rng, &mut |epoch, training, held_out| {
                begun.row(epoch as u64, plants, held_out, Some(training));
                begun.progress(epoch as u64);
            });
        self.history.check_cancelled()?;
        if let Some(proposal) = proposal {
            let point = proposal.point(misfit.coordinates);
            let cost = misfit.cost(&point);
            let plant = self.in_units(misfit, &point);
            let used = proposal.evaluations + 1;
            found.stages.push(begun.end(used, cost, &plant, "every epoch trained"));
            found.starts.push(point);
            let wanted = self.options.colony.food_sources.saturating_sub(found.sources.len());
            found.sources.extend(proposal.food_sources(wanted.max(1), &mut rng));
        }
        Ok(())
    }

    /// The closed form as the answer of the method. It requires two magnitudes at one frequency. If
    /// these show no actuator of this order, the plant of the next lower order is taken, with an
    /// additional pole too fast to be seen.
    fn closed_form_alone(
        &self,
        misfit: &Misfit<'_>,
        found: &mut StageResults,
    ) -> Result<(), IdentifyError> {
        let unusable = |reason: &str| IdentifyError::Unusable { reason: reason.into() };
        if !closed_form::has_two_magnitudes(self.problem) {
            return Err(unusable(
                "two-magnitude needs single sines at two magnitudes of one frequency, both of \
                 which move the axis; other methods need less",
            ));
        }
        self.closed_form(misfit, found);
        if found.starts.is_empty() {
            found.starts.extend(self.start_of_lower(misfit.coordinates));
        }
        if found.starts.is_empty() {
            return Err(unusable(
                "the closed form finds no axis of this order in the describing functions; leave \
                 the order to the data or take another method",
            ));
        }
        Ok(())
    }

    fn search(
        &self,
        optimiser: &dyn Optimiser,
        misfit: &Misfit<'_>,
        found: &mut StageResults,
    ) -> Result<(), IdentifyError> {
        let budget = optimiser.budget(self.options);
        let begun = self.history.begin(optimiser.stage(), budget as u64).within(budget as u64);
        let objective = OverCube { misfit };
        let mut watch = |generation: &optimiser::Generation| {
            let optimiser::Generation { index, evaluations, best, mean } = *generation;
            begun.row(index as u64, evaluations as u64, best, mean);
            begun.progress(evaluations as u64);
            match self.history.observer.cancelled() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let mut search = Search::new(&objective, &found.sources, self.options, budget, &mut watch);
        let Err(stop) = optimiser.search(&mut search, &mut self.stream(2));
        self.history.check_cancelled()?;
        let used = search.used() as u64;
        let Some((best, _)) = search.best() else { return Ok(()) };
        let mut point = misfit.coordinates.within_search(best);
        let cost = misfit.solve_for_constant(&mut point);
        let plant = self.in_units(misfit, &point);
        found.stages.push(begun.end(used, cost, &plant, stop.reason()));
        found.starts.push(point);
        Ok(())
    }

    /// Refines every start roughly, then those that lead to different minima about as low as the
    /// lowest one, then the best again until its weights have converged.
    fn refinement(
        &self,
        coordinates: &Coordinates,
        weights: &mut Weights,
        found: &mut StageResults,
    ) -> Result<Vec<f64>, IdentifyError> {
        found.starts.extend(self.start_of_lower(coordinates));
        let begun = self.history.begin("refinement", found.starts.len() as u64);
        let (mut evaluations, mut steps) = (0, 0);
        let mut descend = |problem, weights: &Weights, start: &[f64], patience, bar: f64| {
            let misfit = Misfit { problem, ..self.misfit(coordinates, weights) };
            let mut on_step = |_, used: u64, cost: f64| {
                begun.row(steps, evaluations + used, cost.min(bar), None);
                steps += 1;
            };
            let refined = refine::refine(&misfit, start, patience, &mut on_step);
            evaluations += refined.evaluations;
            self.history.check_cancelled().map(|()| refined)
        };
        let mut rough: Vec<Refined> = Vec::new();
        for (done, start) in found.starts.iter().enumerate() {
            begun.progress(done as u64);
            let problem = self.coarse.unwrap_or(self.problem);
            let bar = rough.iter().map(|refined| refined.cost).fold(f64::INFINITY, f64::min);
            rough.push(descend(problem, weights, start, ROUGH, bar)?);
        }
        let mut best: Option<Refined> = None;
        for start in different_minima(rough) {
            let bar = best.as_ref().map_or(f64::INFINITY, |refined| refined.cost);
            // The damping that the fit has by then.
            let patience = Patience { damping: start.damping, ..refine::THOROUGH };
            let refined = descend(self.problem, weights, &start.point, patience, bar)?;
            if refined.cost < bar {
                best = Some(refined);
            }
        }
        let mut best = best.ok_or_else(no_response)?;
        let mut rng = self.stream(3);
        for _ in 0..saturated::STARTS {
            let misfit = self.misfit(coordinates, weights);
            if !saturated::misses(&misfit, best.cost) {
                break;
            }
            let start = saturated::start(&misfit, &mut rng);
            let refined = descend(self.problem, weights, &start, refine::THOROUGH, best.cost)?;
            if refined.cost < best.cost {
                best = refined;
            }
        }
        for _ in 0..MOST_REWEIGHTINGS {
            if !weights.depend_on_model {
                break;
            }
            *weights = self.weights(Some(&coordinates.plant(&best.point)));
            let patience = Patience { damping: best.damping, ..refine::THOROUGH };
            let refined = descend(self.problem, weights, &best.point, patience, f64::INFINITY)?;
            let moved = refined.point.iter().zip(&best.point).map(|(a, b)| (a - b).abs());
            let converged = moved.fold(0.0, f64::max) < CONVERGED_CHANGE;
            best = refined;
            if converged {
                break;
            }
        }
        begun.progress(found.starts.len() as u64);
        let plant = self.problem.in_units(&coordinates.plant(&best.point));
        found.stages.push(begun.end(evaluations, best.cost, &plant, best.stop));
        Ok(best.point)
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
