//! Runs every method on every system, at every noise level, with every seed.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use servoscope_core::answers::{
    ConvergenceRow, Identification, IdentifyOptions, Method, PlantRequest, Stage,
};
use servoscope_core::identify::{IdentifyError, IdentifyRequest, identify};
use servoscope_core::measurement::{Complex, Measurement};
use servoscope_core::observer::Observer;
use servoscope_core::plant::Plant;

use crate::machines::draw::{DrawError, NoiseStatement};
use crate::machines::noise::RelativeNoise;
use crate::machines::responses::Responses;
use crate::machines::simulator::Settings;
use crate::methods::METHODS;

use super::figure_of_merit::{EXACT_TOLERANCE, SIGMAS, largest_error};
use super::system::{System, Values, reported};

/// The runs to make.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Systems.
    pub systems: Vec<System>,
    /// Methods.
    pub methods: Vec<Method>,
    /// Noise levels, dB; `None`: no noise.
    pub levels: Vec<Option<u32>>,
    /// Seeds, of the method and of the noise.
    pub seeds: std::ops::RangeInclusive<u64>,
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            systems: System::ALL.to_vec(),
            methods: Method::all().collect(),
            levels: vec![None, Some(60), Some(40)],
            seeds: 1..=20,
        }
    }
}

/// Result of a method at the end of a stage.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Rows of the paper's table, except N_T.
    pub rows: Vec<Complex>,
    /// Its reported parameters.
    pub(super) values: Values,
    /// Largest relative error of the rows.
    pub error: f64,
    /// Simulations of the whole measurement so far, including those for training and derivatives.
    pub evaluations: u64,
    /// Computing time so far, s.
    pub seconds: f64,
    /// Whether the error is within the success criterion: `EXACT_TOLERANCE` on noise-free data,
    /// `SIGMAS` standard deviations on noisy data.
    pub success: bool,
}

impl Outcome {
    /// The plant with the identified parameters.
    pub fn plant(&self, system: System) -> Plant {
        system.identified(&self.values)
    }
}

/// One method on one measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The system.
    pub system: System,
    /// Noise level, dB; `None`: no noise.
    pub level: Option<u32>,
    /// The method.
    pub method: Method,
    /// Seed of method and noise.
    pub seed: u64,
    /// Outcome of its search or closed form; `None` if there is no answer.
    pub alone: Option<Outcome>,
    /// Outcome after refinement, if the method has one.
    pub refined: Option<Outcome>,
    /// Evaluations that its search may use.
    pub budget: Option<u64>,
    /// Why its search ended, or why there is no answer.
    pub stop_reason: String,
    /// Its convergence history; kept for the first seed only.
    pub history: Vec<ConvergenceRow>,
}

/// All runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Reproduction {
    /// The plan of the runs.
    pub plan: Plan,
    /// The runs, in the order of the plan.
    pub runs: Vec<Run>,
}

impl Reproduction {
    /// The runs of a method on a system at a noise level, one per seed.
    pub fn of(&self, system: System, level: Option<u32>, method: Method) -> Vec<&Run> {
        let wanted =
            |run: &&Run| run.system == system && run.level == level && run.method == method;
        self.runs.iter().filter(wanted).collect()
    }
}

/// Why the reproduction failed.
#[derive(Debug, thiserror::Error)]
pub enum ReproduceError {
    /// A system could not be measured.
    #[error(transparent)]
    Measurement(#[from] DrawError),
    /// A method failed for a reason other than unusable data.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
}

/// Runs a plan, one run at a time so that computing times are independent. `done` is called with
/// every run.
///
/// # Errors
/// See [`ReproduceError`]. Ends with an error of the method if `cancelled` returns `true`.
pub fn run_all(
    plan: &Plan,
    cancelled: &(dyn Fn() -> bool + Sync),
    done: &mut dyn FnMut(&Run),
) -> Result<Reproduction, ReproduceError> {
    let mut runs = Vec::new();
    for &system in &plan.systems {
        let responses = Responses::simulate(&system.draw(), &Settings::default())?;
        for &level in &plan.levels {
            let mut deviations: HashMap<u64, Values> = HashMap::new();
            for &method in &plan.methods {
                for seed in plan.seeds.clone() {
                    let measurement = match level {
                        None => responses.exact(None)?,
                        Some(db) => {
                            let rng = &mut ChaCha8Rng::seed_from_u64(seed);
                            let noise = RelativeNoise::decibels(f64::from(db));
                            responses.noisy(&noise, NoiseStatement::Std, rng)?
                        }
                    };
                    let case = Case { system, level, method, seed, cancelled };
                    let keep = seed == *plan.seeds.start();
                    let stds = deviations.entry(seed);
                    let stds = match stds {
                        std::collections::hash_map::Entry::Occupied(known) => known.into_mut(),
                        std::collections::hash_map::Entry::Vacant(unknown) => {
                            unknown.insert(case.deviations(&measurement)?)
                        }
                    };
                    let run = case.run(&measurement, stds, keep)?;
                    done(&run);
                    runs.push(run);
                }
            }
        }
    }
    Ok(Reproduction { plan: plan.clone(), runs })
}

struct Case<'a> {
    system: System,
    level: Option<u32>,
    method: Method,
    seed: u64,
    cancelled: &'a (dyn Fn() -> bool + Sync),
}

impl Case<'_> {
    /// Standard deviation of each parameter due to the noise, as reported by `least-squares` for
    /// this data. It belongs to the least-squares optimum and serves all methods. Empty without
    /// noise.
    fn deviations(&self, measurement: &Measurement) -> Result<Values, ReproduceError> {
        if self.level.is_none() {
            return Ok(Values::default());
        }
        let answer = self.ask(measurement, Method::LeastSquares, &Watch::new(self.cancelled))?;
        let stds = answer.parameters.iter().filter_map(|(name, p)| Some((name.clone(), p.std?)));
        Ok(stds.collect())
    }

    fn ask(
        &self,
        measurement: &Measurement,
        method: Method,
        watch: &Watch<'_>,
    ) -> Result<Identification, IdentifyError> {
        let plant = Some(PlantRequest { actuator_order: self.system.actuator_order() });
        let options = IdentifyOptions { seed: self.seed, ..IdentifyOptions::default() };
        let request =
            IdentifyRequest { plant, method, options, methods: METHODS, ..Default::default() };
        identify(measurement, &request, watch)
    }

    fn run(
        &self,
        measurement: &Measurement,
        stds: &Values,
        keep: bool,
    ) -> Result<Run, IdentifyError> {
        let watch = Watch::new(self.cancelled);
        let Self { system, level, method, seed, .. } = *self;
        let mut run = Run {
            system,
            level,
            method,
            seed,
            alone: None,
            refined: None,
            budget: None,
            stop_reason: String::new(),
            history: Vec::new(),
        };
        let answer = match self.ask(measurement, method, &watch) {
            Ok(answer) => answer,
            Err(error @ IdentifyError::Unusable { .. }) => {
                run.stop_reason = error.to_string();
                return Ok(run);
            }
            Err(error) => return Err(error),
        };
        let stages = &answer.stages;
        let searched = stages.iter().rposition(|stage| stage.name != "refinement");
        if let Some(last) = searched {
            run.alone = Some(self.outcome(&stages[..=last], stds));
            run.budget = stages[last].budget;
            run.stop_reason.clone_from(&stages[last].stop_reason);
        }
        let is_refined = stages.last().is_some_and(|stage| stage.name == "refinement");
        run.refined = is_refined.then(|| self.outcome(stages, stds));
        if keep {
            run.history = watch.rows.into_inner().unwrap_or_else(PoisonError::into_inner);
        }
        Ok(run)
    }

    fn outcome(&self, stages: &[Stage], stds: &Values) -> Outcome {
        let last = stages.last().expect("at least one stage");
        let values = last.parameters.clone();
        let rows = self.system.rows(&values);
        let error = largest_error(self.system, &rows);
        let truth = reported(&self.system.plant());
        let within = |(name, std): (&String, &f64)| {
            values.get(name).is_some_and(|value| (value - truth[name]).abs() <= SIGMAS * std)
        };
        let success = match self.level {
            None => error <= EXACT_TOLERANCE,
            Some(_) => stds.len() == truth.len() && stds.iter().all(within),
        };
        let evaluations = stages.iter().map(|stage| stage.evaluations).sum();
        let seconds = stages.iter().map(|stage| stage.seconds).sum();
        Outcome { rows, values, error, evaluations, seconds, success }
    }
}

/// An observer with a clock, which records the convergence history and passes on cancellation.
struct Watch<'a> {
    began: Instant,
    rows: Mutex<Vec<ConvergenceRow>>,
    cancelled: &'a (dyn Fn() -> bool + Sync),
}

impl<'a> Watch<'a> {
    fn new(cancelled: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self { began: Instant::now(), rows: Mutex::default(), cancelled }
    }
}

impl Observer for Watch<'_> {
    fn elapsed_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    fn row(&self, row: ConvergenceRow) {
        self.rows.lock().unwrap_or_else(PoisonError::into_inner).push(row);
    }

    fn cancelled(&self) -> bool {
        (self.cancelled)()
    }
}
