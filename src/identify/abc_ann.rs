//! The method `abc-ann`: closed form, network, bee colony, refinement.

use std::ops::ControlFlow;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::answers::{ConvergenceRow, IdentifyOptions, Progress, Stage};
use crate::measurement::Measurement;
use crate::observer::Observer;
use crate::plant::{Actuator, Plant};

use super::IdentifyError;
use super::bee_colony::{self, Objective};
use super::closed_form;
use super::noise::{self, Weights};
use super::objective::Misfit;
use super::parameters::Coordinates;
use super::problem::Problem;
use super::proposal;
use super::refine;
use super::summary;

/// Rounds in which weights that depend on the model are computed anew.
const MOST_ROUNDS: usize = 6;

/// Change of every coordinate below which the weights have settled.
const SETTLED: f64 = 1e-6;

/// A fitted base model of one actuator order.
pub(super) struct Fitted {
    /// Actuator order.
    pub order: u8,
    /// What was searched.
    pub coordinates: Coordinates,
    /// Where the search ended.
    pub point: Vec<f64>,
    /// Weights in effect there.
    pub weights: Weights,
    /// Sum of squares there.
    pub cost: f64,
    /// The stages in order.
    pub stages: Vec<Stage>,
}

/// A run of the method for one actuator order.
pub(super) struct Run<'a> {
    /// The measurement.
    pub measurement: &'a Measurement,
    /// The same, made ready.
    pub problem: &'a Problem,
    /// Actuator order to fit.
    pub order: u8,
    /// The fit of the next lower order, where there is one: a start that this
    /// order can only improve on.
    pub lower: Option<&'a Fitted>,
    /// Whether other orders are fitted too: stages are then named by order.
    pub among_orders: bool,
    /// Options.
    pub options: &'a IdentifyOptions,
    /// Who watches.
    pub observer: &'a dyn Observer,
}

/// Stages by name and the share of a run that is done when they begin.
const SHARES: [(&str, f64, f64); 4] = [
    ("closed_form", 0.0, 0.02),
    ("network", 0.02, 0.45),
    ("colony", 0.45, 0.85),
    ("refinement", 0.85, 1.0),
];

impl Run<'_> {
    /// Runs all enabled stages.
    ///
    /// # Errors
    /// When cancelled, or when no start gives any response.
    pub fn fit(&self) -> Result<Fitted, IdentifyError> {
        let problem = self.problem;
        let coordinates = Coordinates::new(self.order, problem.tied_friction, &problem.prior);
        let mut weights = noise::weights(self.measurement, problem, self.options.noise_std, None);
        let mut stages = Vec::new();
        let mut starts: Vec<Vec<f64>> = Vec::new();
        let misfit = self.misfit(&coordinates, &weights);
        // Every stage has a stream of its own, so that switching one off leaves
        // the others' random numbers as they were.
        let stream = |stage: u64| {
            let mut rng = ChaCha8Rng::seed_from_u64(self.options.seed);
            rng.set_stream(16 * u64::from(self.order) + stage);
            rng
        };

        if self.options.closed_form_start {
            let begun = self.observer.elapsed_s();
            self.progress("closed_form", 0, 1);
            if let Some(plant) = closed_form::start(problem, self.order) {
                let mut point = coordinates.point(&plant);
                let cost = misfit.solve_for_constant(&mut point);
                self.row("closed_form", 0, 1, cost, None);
                stages.push(self.stage(
                    "closed_form",
                    &coordinates,
                    1,
                    begun,
                    cost,
                    &point,
                    "done",
                ));
                starts.push(point);
            }
        }
        let mut sources: Vec<Vec<f64>> =
            starts.iter().map(|point| coordinates.share_of_search(point)).collect();
        if self.options.network.enabled {
            let begun = self.observer.elapsed_s();
            let epochs = self.options.network.epochs as u64;
            let plants = self.options.network.training_plants as u64;
            self.progress("network", 0, epochs);
            let mut rng = stream(1);
            let proposal = proposal::propose(
                &misfit,
                &self.options.network,
                &mut rng,
                &mut |epoch, training, held_out| {
                    self.row("network", epoch as u64, plants, held_out, Some(training));
                    self.progress("network", epoch as u64, epochs);
                },
            );
            self.go_on()?;
            if let Some(proposal) = proposal {
                let point = proposal.point(&coordinates);
                let cost = misfit.cost(&point);
                let used = proposal.evaluations + 1;
                stages.push(self.stage(
                    "network",
                    &coordinates,
                    used,
                    begun,
                    cost,
                    &point,
                    "every epoch trained",
                ));
                starts.push(point);
                let wanted = self.options.colony.food_sources.saturating_sub(sources.len());
                sources.extend(proposal.food_sources(wanted.max(1), &mut rng));
            }
        }
        if self.options.colony.enabled {
            let begun = self.observer.elapsed_s();
            let cycles = self.options.colony.cycles as u64;
            let outcome = bee_colony::search(
                &Foraging { misfit: &misfit },
                &sources,
                &self.options.colony,
                &mut stream(2),
                &mut |cycle| {
                    let (done, used) = (cycle.cycle as u64, cycle.evaluations as u64);
                    let mean = cycle.mean_cost.is_finite().then_some(cycle.mean_cost);
                    self.row("colony", done, used, cycle.best_cost, mean);
                    self.progress("colony", done, cycles);
                    if self.observer.cancelled() {
                        ControlFlow::Break(())
                    } else {
                        ControlFlow::Continue(())
                    }
                },
            );
            self.go_on()?;
            let mut point = coordinates.within_search(&outcome.best);
            let cost = misfit.solve_for_constant(&mut point);
            let used = outcome.evaluations as u64;
            let stop = "every cycle flown";
            stages.push(self.stage("colony", &coordinates, used, begun, cost, &point, stop));
            starts.push(point);
        }
        if starts.is_empty() {
            let mut middle = coordinates.within_search(&vec![0.5; coordinates.len() - 1]);
            misfit.solve_for_constant(&mut middle);
            starts.push(middle);
        }
        starts.extend(self.lower.map(|fitted| {
            let plant = fitted.coordinates.plant(&fitted.point);
            coordinates.point(&with_fast_pole(&plant, problem.prior.omega_high))
        }));
        let by_cost = |a: &Vec<f64>, b: &Vec<f64>| misfit.cost(a).total_cmp(&misfit.cost(b));
        starts.sort_by(by_cost);
        let mut point = starts[0].clone();
        if self.options.refine {
            let begun = self.observer.elapsed_s();
            let refinement = self.refine(&coordinates, &mut weights, starts)?;
            point = refinement.point;
            stages.push(self.stage(
                "refinement",
                &coordinates,
                refinement.evaluations,
                begun,
                refinement.cost,
                &point,
                refinement.stop,
            ));
        } else {
            // The weights that depend on the model are those of where it ended.
            let plant = coordinates.plant(&point);
            weights =
                noise::weights(self.measurement, problem, self.options.noise_std, Some(&plant));
        }
        let cost = self.misfit(&coordinates, &weights).cost(&point);
        if !cost.is_finite() {
            let reason = "no plant of the search range answers with the period of the input";
            return Err(IdentifyError::Unusable { reason: reason.into() });
        }
        Ok(Fitted { order: self.order, coordinates, point, weights, cost, stages })
    }

    /// Refines every start, then the best again until its weights have settled.
    fn refine(
        &self,
        coordinates: &Coordinates,
        weights: &mut Weights,
        starts: Vec<Vec<f64>>,
    ) -> Result<refine::Refined, IdentifyError> {
        let mut evaluations = 0;
        let mut cycle = 0;
        let mut best: Option<refine::Refined> = None;
        let total = starts.len() as u64;
        for (done, start) in starts.iter().enumerate() {
            self.progress("refinement", done as u64, total);
            let bar = best.as_ref().map_or(f64::INFINITY, |refined| refined.cost);
            let refined =
                refine::refine(&self.misfit(coordinates, weights), start, &mut |_, used, cost| {
                    self.row("refinement", cycle, evaluations + used, cost.min(bar), None);
                    cycle += 1;
                });
            self.go_on()?;
            evaluations += refined.evaluations;
            if refined.cost < bar {
                best = Some(refined);
            }
        }
        let mut best = best.ok_or_else(|| IdentifyError::Unusable {
            reason: "no plant of the search range answers with the period of the input".into(),
        })?;
        for _ in 0..MOST_ROUNDS {
            if !weights.depend_on_model {
                break;
            }
            let plant = coordinates.plant(&best.point);
            *weights = noise::weights(
                self.measurement,
                self.problem,
                self.options.noise_std,
                Some(&plant),
            );
            let refined = refine::refine(
                &self.misfit(coordinates, weights),
                &best.point,
                &mut |_, used, cost| {
                    self.row("refinement", cycle, evaluations + used, cost, None);
                    cycle += 1;
                },
            );
            self.go_on()?;
            evaluations += refined.evaluations;
            let moved = refined.point.iter().zip(&best.point).map(|(a, b)| (a - b).abs());
            let settled = moved.fold(0.0, f64::max) < SETTLED;
            best = refined;
            if settled {
                break;
            }
        }
        self.progress("refinement", total, total);
        best.evaluations = evaluations;
        Ok(best)
    }

    fn misfit<'m>(&'m self, coordinates: &'m Coordinates, weights: &'m Weights) -> Misfit<'m> {
        Misfit { problem: self.problem, coordinates, weights, observer: self.observer }
    }

    fn go_on(&self) -> Result<(), IdentifyError> {
        if self.observer.cancelled() { Err(IdentifyError::Cancelled) } else { Ok(()) }
    }

    fn name(&self, stage: &str) -> String {
        if self.among_orders { format!("{stage} (order {})", self.order) } else { stage.into() }
    }

    fn row(&self, stage: &str, cycle: u64, evaluations: u64, best: f64, mean: Option<f64>) {
        self.observer.row(ConvergenceRow {
            stage: self.name(stage),
            cycle,
            evaluations,
            best,
            mean,
            elapsed_s: self.observer.elapsed_s(),
        });
    }

    fn progress(&self, stage: &str, done: u64, total: u64) {
        let (_, begin, end) =
            SHARES.iter().find(|(name, ..)| *name == stage).expect("a stage that is listed");
        let share = begin + (end - begin) * done as f64 / total.max(1) as f64;
        let fraction =
            if self.among_orders { (f64::from(self.order) + share) / 3.0 } else { share };
        self.observer.progress(Progress { stage: self.name(stage), done, total, fraction });
    }

    #[expect(clippy::too_many_arguments, reason = "it names the fields of the stage it makes")]
    fn stage(
        &self,
        name: &str,
        coordinates: &Coordinates,
        evaluations: u64,
        begun_s: f64,
        cost: f64,
        point: &[f64],
        stop_reason: &str,
    ) -> Stage {
        Stage {
            name: self.name(name),
            evaluations,
            seconds: self.observer.elapsed_s() - begun_s,
            cost,
            parameters: summary::values(&self.problem.in_units(&coordinates.plant(point))),
            stop_reason: stop_reason.into(),
        }
    }
}

/// The plant with one more actuator pole, so fast that it hardly shows.
fn with_fast_pole(plant: &Plant, omega_high: f64) -> Plant {
    let fast = 30.0 * omega_high;
    let actuator = match plant.actuator {
        Actuator::Direct => Actuator::FirstOrder { corner_rad_s: fast },
        Actuator::FirstOrder { corner_rad_s } => {
            let natural_frequency_rad_s = (corner_rad_s * fast).sqrt();
            let damping_ratio = 0.5 * (corner_rad_s + fast) / natural_frequency_rad_s;
            Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio }
        }
        already => already,
    };
    Plant { actuator, ..*plant }
}

/// The misfit as the bees see it: over the unit cube, with K solved for.
struct Foraging<'a> {
    misfit: &'a Misfit<'a>,
}

impl Objective for Foraging<'_> {
    fn dimension(&self) -> usize {
        self.misfit.coordinates.len() - 1
    }

    fn cost(&self, cube: &[f64]) -> f64 {
        if self.misfit.observer.cancelled() {
            return f64::INFINITY;
        }
        let mut point = self.misfit.coordinates.within_search(cube);
        self.misfit.solve_for_constant(&mut point)
    }
}
