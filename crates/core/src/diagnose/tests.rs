//! The residual tests are calibrated on noise, and departures added to a response are found.

mod calibration;
mod patterns;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::selection::evidence::NoiseScale;
use super::selection::models::{Key, Models, ScoredModel};
use super::*;
use crate::answers::{Discrepancy, IdentifyOptions, PlantRequest};
use crate::identify::{FitSession, IdentifyError, Model};
use crate::machines::draw::{Draw, NoiseStatement, draw, measure, noise_std, observe};
use crate::machines::simulator;
use crate::measurement::{Complex, Experiment, Metadata};
use crate::observer::Silent;

fn discrepancy_of(measurement: &Measurement) -> Discrepancy {
    examine(measurement, &request(), &Silent).unwrap().1
}

/// Noise-free experiments of an axis: 3 magnitudes, 8 frequencies, harmonics 0 to 5.
pub(super) fn exact() -> Vec<Experiment> {
    let mut draw = Draw { harmonics: 5, noise_db: None, ..draw(0, 3) };
    let mut index = 0;
    draw.design.retain(|_| {
        index += 1;
        index % 2 == 0
    });
    measure(&draw, 1).unwrap().experiments().to_vec()
}

/// These experiments with noise of 60 dB; `statement` is how the measurement states its noise.
pub(super) fn noisy(exact: &[Experiment], statement: NoiseStatement, seed: u64) -> Measurement {
    with_noise(exact, 60.0, statement, seed)
}

/// These experiments with noise that is so many dB below the largest response.
pub(super) fn with_noise(
    exact: &[Experiment],
    level_db: f64,
    statement: NoiseStatement,
    seed: u64,
) -> Measurement {
    let values = |e: &Experiment| e.response.iter().map(|h| h.value).collect::<Vec<Complex>>();
    let responses: Vec<Vec<Complex>> = exact.iter().map(values).collect();
    let std = noise_std(&responses, level_db);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let experiment = |(experiment, exact): (&Experiment, &Vec<Complex>)| {
        let (response, repeats) = observe(exact, std, statement, &mut rng);
        Experiment { response, repeats, ..experiment.clone() }
    };
    let experiments = exact.iter().zip(&responses).map(experiment).collect();
    Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap()
}

/// A request with actuator order 0 that starts from the closed form alone.
pub(super) fn request() -> IdentifyRequest {
    let mut options = IdentifyOptions::default();
    options.network.enabled = false;
    options.colony.enabled = false;
    let plant = Some(PlantRequest { actuator_order: 0 });
    IdentifyRequest { plant, options, ..IdentifyRequest::default() }
}

/// The key of a model with these effects.
pub(super) fn key(ids: &[&'static str]) -> Key {
    let mut key = ids.to_vec();
    key.sort_unstable();
    key
}

/// Models with these effects and costs, as if they had been fitted to data of known noise. Every
/// effect's parameters are in the middle of their ranges.
pub(super) fn fitted_to(costs: &[(&[&str], f64)]) -> Models {
    let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 1), request());
    let session = FitSession::new(&measurement, &request, &Silent).unwrap();
    let noise_scale = NoiseScale { known: true, rounding: 0.0, dof: 100.0 };
    let mut base = session.base().clone();
    base.cost = 1e6;
    let mut models = Models::new(base, noise_scale);
    for (ids, cost) in costs {
        let effects = ids.iter().map(|id| crate::effects::find(id).unwrap());
        let extend = |model: Model, effect| session.extend(&model, effect);
        let mut model = effects.fold(session.base().clone(), extend);
        model.cost = *cost;
        models.keep(ScoredModel::new(&session, model, &noise_scale));
    }
    models
}

/// One record of 60 lines between 0.5 and 30 rad/s, at 60 dB; line k is multiplied by `change(k)`.
fn multisine(change: impl Fn(usize) -> f64) -> Measurement {
    let omega_rad_s = 0.5;
    let mut input = vec![Complex::new(0.0, 0.0)];
    input.extend((1..=60).map(|k| Complex::from_polar(0.5, f64::from(k * k))));
    let plant = draw(0, 3).plant;
    let settings = simulator::Settings::default();
    let machine = simulator::Machine::base(plant);
    let mut exact = simulator::respond(&machine, 0.0, omega_rad_s, &input, 60, &settings).unwrap();
    exact.iter_mut().enumerate().for_each(|(k, value)| *value *= change(k));
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let std = 1e-3 * exact[1].norm();
    let (response, _) = observe(&exact, Some(std), NoiseStatement::Std, &mut rng);
    let experiment = Experiment {
        magnitude: 10.0,
        omega_rad_s,
        input,
        input_mean_measured: false,
        mean_velocity: 0.0,
        rounding_std: 0.0,
        open_samples: None,
        bad_samples: None,
        clipping: None,
        range: None,
        unknown_input: Vec::new(),
        response,
        run: None,
        repeats: Vec::new(),
        from_record: false,
    };
    Measurement::new(Metadata::default(), vec![experiment], Vec::new(), String::new()).unwrap()
}

#[test]
fn a_wrong_band_of_lines_is_found_in_a_record() {
    let clean = discrepancy_of(&multisine(|_| 1.0));
    assert!(clean.noise_like, "{:?}", clean.tests);
    let off = multisine(|k| if (25..=34).contains(&k) { 1.05 } else { 1.0 });
    let discrepancy = discrepancy_of(&off);
    let pattern = &discrepancy.patterns[0];
    assert!(pattern.sentence.starts_with("between "), "{}", pattern.sentence);
    assert!(pattern.sentence.contains("the response is "), "{}", pattern.sentence);
    assert!(pattern.harmonics.is_empty() && pattern.magnitudes.is_none());
    // To the bands that 60 lines are put into: 24 of two or three lines.
    let [low, high] =
        pattern.frequencies_hz.unwrap().map(|hertz| hertz * std::f64::consts::TAU / 0.5);
    assert!((23.0..=27.0).contains(&low) && (32.0..=36.0).contains(&high), "{low} {high}");
}

#[test]
fn too_little_data_is_reported_and_not_judged() {
    let all = noisy(&exact(), NoiseStatement::Silent, 1);
    let mut few: Vec<Experiment> = all.experiments().iter().step_by(6).cloned().collect();
    few.iter_mut().for_each(|experiment| experiment.response.retain(|h| h.order == 1));
    let few = Measurement::new(Metadata::default(), few, Vec::new(), String::new()).unwrap();
    let discrepancy = discrepancy_of(&few);
    let Discrepancy { sentence, tests, .. } = discrepancy;
    assert!(tests.iter().all(|test| test.p_value.is_none() && test.passed));
    assert!(sentence.contains("too few data"), "{sentence}");
}

#[test]
fn rounding_errors_are_no_departure_where_the_noise_is_unknown() {
    let measurement =
        Measurement::new(Metadata::default(), exact(), Vec::new(), String::new()).unwrap();
    let discrepancy = discrepancy_of(&measurement);
    assert!(discrepancy.noise_like, "{:?}", discrepancy.tests);
    assert!(discrepancy.sentence.contains("rounding"), "{}", discrepancy.sentence);
}

#[test]
fn an_answer_survives_json() {
    let answer = diagnose(&noisy(&exact(), NoiseStatement::Std, 1), &request(), &Silent).unwrap();
    let text = serde_json::to_string(&answer).unwrap();
    assert_eq!(serde_json::from_str::<Diagnosis>(&text).unwrap(), answer);
}

#[test]
fn a_cancelled_diagnosis_stops() {
    struct Impatient;
    impl Observer for Impatient {
        fn cancelled(&self) -> bool {
            true
        }
    }
    let measurement = noisy(&exact(), NoiseStatement::Std, 1);
    let stopped = diagnose(&measurement, &request(), &Impatient).unwrap_err();
    assert_eq!(stopped, DiagnoseError::Identify(IdentifyError::Cancelled));
}
