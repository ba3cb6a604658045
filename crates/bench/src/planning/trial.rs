//! One machine, measured as planned and by sweeps.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;
use servoscope_core::answers::{
    IdentifyOptions, PlanOptions, PlanRequest, PlannedExperiment, PlantRequest, RoughAxis,
};
use servoscope_core::diagnose::{DiagnoseError, PlanError, diagnose, plan};
use servoscope_core::effects::{ALL, find};
use servoscope_core::identify::{IdentifyError, IdentifyRequest};
use servoscope_core::measurement::{InvalidMeasurement, Measurement, Metadata};
use servoscope_core::observer::Observer;
use servoscope_core::plant::{Actuator, Plant};

use crate::machines::draw::{Draw, DrawError, NoiseStatement, draw, log_uniform};
use crate::machines::noise::NoiseLaw;
use crate::machines::responses::Responses;
use crate::machines::simulator::{Effect, Settings as Simulation};
use crate::naming::base_excess;
use crate::naming::effect_draws::{draw_effect, scales};

/// How trials are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Time for all experiments, as a multiple of the slowest time constant of the machine.
    pub budget: f64,
    /// Standard deviation of the logarithm of what the rough idea is off by.
    pub off: f64,
    /// Noise after one time constant, in decibels below the response to the middle magnitude at the
    /// lowest frequency.
    pub noise_db: f64,
    /// Smallest size of an effect, as a share of what a laboratory would meet; sizes are log-uniform up to
    /// 1. A thirtieth is what the criterion of a plan assumes.
    pub least_size: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { seed: 1, budget: 800.0, off: 0.25, noise_db: 25.0, least_size: 1.0 / 30.0 }
    }
}

/// What comes of one design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// Whether the first cause is the hidden effect.
    pub first: bool,
    /// Whether it is that or names it as an equivalent.
    pub equivalent: bool,
    /// Ids of the named causes.
    pub named: Vec<String>,
    /// Number of experiments.
    pub experiments: usize,
    /// Their duration, s.
    pub duration_s: f64,
    /// The excess χ² that the base model leaves of the response without noise.
    pub excess: f64,
}

/// One machine, measured in each way.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    /// The hidden effect.
    pub effect: &'static str,
    /// Order of the actuator.
    pub order: u8,
    /// As planned.
    pub planned: Verdict,
    /// The score of the plan: the share of effects that it expects to name.
    pub expected: f64,
    /// By the sweep at one magnitude, and by that at three if the time pays for one.
    pub swept: Vec<Swept>,
}

/// What comes of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Swept {
    /// Number of magnitudes.
    pub magnitudes: usize,
    /// Its answer.
    pub verdict: Verdict,
    /// Its score.
    pub expected: f64,
}

/// Why there is no trial.
#[derive(Debug, thiserror::Error)]
pub enum TrialError {
    /// There is no plan.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The machine cannot be simulated.
    #[error(transparent)]
    Draw(#[from] DrawError),
    /// The measurement is invalid.
    #[error(transparent)]
    Invalid(#[from] InvalidMeasurement),
    /// The base model cannot be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// The measurement cannot be diagnosed.
    #[error(transparent)]
    Diagnose(#[from] DiagnoseError),
}

/// Makes a trial: its index chooses effect and order in turn, and with the seed all random numbers.
///
/// # Errors
/// See [`TrialError`].
pub fn trial(
    index: usize,
    settings: &Settings,
    observer: &dyn Observer,
) -> Result<Trial, TrialError> {
    let rng = &mut ChaCha8Rng::seed_from_u64(settings.seed);
    rng.set_stream(index as u64);
    let effect = ALL[index % ALL.len()].id();
    // The orders change from one turn of the effects to the next, too.
    let order = ((index + index / ALL.len()) % 3) as u8;
    let machine = draw(order, rng.random());
    let hidden = sized(effect, &machine, settings.least_size, rng);
    let machine = Draw { effects: vec![hidden], ..machine };
    let rate = slowest_rate(&machine.plant);
    let noise_std = noise_std(&machine, settings.noise_db);
    let options = PlanOptions {
        uncertainty: settings.off,
        noise_std: Some(noise_std),
        seed: rng.random::<u32>().into(),
        ..PlanOptions::default()
    };
    let axis = rough(&machine.plant, settings.off, rng);
    let request = PlanRequest { axis, budget_s: settings.budget / rate, options };
    let planned = plan(&request, observer)?;
    let mut answer = |experiments: &[PlannedExperiment]| -> Result<Verdict, TrialError> {
        let (exact, measurement) = measured(&machine, experiments, noise_std, rng)?;
        let identify = IdentifyRequest {
            plant: Some(PlantRequest { actuator_order: order }),
            options: IdentifyOptions {
                seed: rng.random::<u32>().into(),
                ..IdentifyOptions::default()
            },
            ..IdentifyRequest::default()
        };
        let causes = diagnose(&measurement, &identify, observer)?.causes;
        let first = causes.first();
        Ok(Verdict {
            first: first.is_some_and(|cause| cause.effect == effect),
            equivalent: first.is_some_and(|cause| {
                cause.effect == effect || cause.equivalents.iter().any(|other| other == effect)
            }),
            named: causes.iter().map(|cause| cause.effect.clone()).collect(),
            experiments: experiments.len(),
            duration_s: experiments.iter().map(|experiment| experiment.duration_s).sum(),
            excess: base_excess(&exact, order)?,
        })
    };
    let verdict = answer(&planned.experiments)?;
    let mut swept = Vec::new();
    for sweep in &planned.sweeps {
        swept.push(Swept {
            magnitudes: sweep.magnitudes.len(),
            verdict: answer(&sweep.experiments)?,
            expected: sweep.score,
        });
    }
    Ok(Trial { effect, order, planned: verdict, expected: planned.score, swept })
}

/// An effect as a laboratory would meet it, made smaller by a log-uniform factor.
fn sized(id: &str, machine: &Draw, least: f64, rng: &mut ChaCha8Rng) -> Effect {
    let drawn = draw_effect(id, machine, rng);
    let factor = log_uniform(least, 1.0, rng);
    let scaled = find(id).and_then(|effect| {
        (effect.descriptor().draw.scaled)(&scales(machine), drawn.values(), factor)
    });
    scaled.map_or(drawn, |values| Effect::of(id, &values))
}

/// The slowest rate at which a motion dies away, 1/s.
fn slowest_rate(plant: &Plant) -> f64 {
    let actuator = match plant.actuator {
        Actuator::Direct => f64::INFINITY,
        Actuator::FirstOrder { corner_rad_s } => corner_rad_s,
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            natural_frequency_rad_s * damping_ratio
        }
    };
    plant.viscous_rate_rad_s.min(actuator)
}

/// What is thought of a plant: every parameter off by a log-normal factor.
fn rough(plant: &Plant, off: f64, rng: &mut ChaCha8Rng) -> RoughAxis {
    let mut off = |value: f64| {
        let normal: f64 = StandardNormal.sample(rng);
        value * (off * normal).exp()
    };
    let mut axis = RoughAxis {
        pole: -off(plant.viscous_rate_rad_s),
        constant: off(plant.constant),
        fc_plus: off(plant.friction.fc_plus),
        fc_minus: off(plant.friction.fc_minus),
        actuator_pole: None,
        natural_frequency: None,
        damping_ratio: None,
    };
    match plant.actuator {
        Actuator::Direct => {}
        Actuator::FirstOrder { corner_rad_s } => axis.actuator_pole = Some(-off(corner_rad_s)),
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            axis.natural_frequency = Some(off(natural_frequency_rad_s));
            axis.damping_ratio = Some(off(damping_ratio));
        }
    }
    axis
}

/// Standard deviation of a harmonic that is measured for one second, velocity units.
fn noise_std(machine: &Draw, noise_db: f64) -> f64 {
    let Plant { viscous_rate_rad_s, constant, friction, .. } = machine.plant;
    let level = 0.5 * (friction.fc_plus + friction.fc_minus);
    let response = 3.0 * level * constant / viscous_rate_rad_s;
    response * 10.0_f64.powf(-noise_db / 20.0) / viscous_rate_rad_s.sqrt()
}

/// The measurement of a machine by these experiments without noise, its deviations stated, and with the
/// noise of the duration of each.
fn measured(
    machine: &Draw,
    experiments: &[PlannedExperiment],
    noise_std: f64,
    rng: &mut ChaCha8Rng,
) -> Result<(Measurement, Measurement), TrialError> {
    let design = experiments.iter().map(|e| (e.magnitude, e.omega_rad_s)).collect();
    let machine = Draw { design, ..machine.clone() };
    let exact = Responses::simulate(&machine, &Simulation::default())?.exact(None)?;
    let (mut clean, mut noisy) = (exact.experiments().to_vec(), exact.experiments().to_vec());
    for (clean, noisy) in clean.iter_mut().zip(&mut noisy) {
        let run = noisy.run.map_or(0, |run| run as usize);
        let PlannedExperiment { repeats, measured_periods, omega_rad_s, .. } = experiments[run];
        let periods = (repeats * measured_periods) as f64;
        let measured_s = periods * std::f64::consts::TAU / omega_rad_s;
        let law = NoiseLaw::uniform(noise_std / measured_s.sqrt());
        let values: Vec<_> = noisy.response.iter().map(|harmonic| harmonic.value).collect();
        (noisy.response, noisy.repeats) = law.observe(&values, NoiseStatement::Std, rng);
        for (exact, observed) in clean.response.iter_mut().zip(&noisy.response) {
            exact.std = observed.std;
        }
    }
    let whole =
        |experiments| Measurement::new(Metadata::default(), experiments, Vec::new(), String::new());
    Ok((whole(clean)?, whole(noisy)?))
}
