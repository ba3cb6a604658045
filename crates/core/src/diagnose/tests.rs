//! The residual tests are calibrated on noise, and departures added to a response are found.

use std::collections::BTreeMap;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::residuals::regions::Regions;
use super::residuals::residual::Residuals;
use super::residuals::statistics;
use super::residuals::whiteness::{Judgement, Nulls};
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
    let values = |e: &Experiment| e.response.iter().map(|h| h.value).collect::<Vec<Complex>>();
    let responses: Vec<Vec<Complex>> = exact.iter().map(values).collect();
    let std = noise_std(&responses, 60.0);
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

fn residuals(measurement: &Measurement) -> Residuals {
    Residuals::of(&crate::identify::fit_base(measurement, &request(), &Silent).unwrap())
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

// Each of 150 measurements is fitted anew; only the null distributions are linearized. The standard
// deviation of a share of 5 % is 1.8 %, of one of 50 % 4.1 %; four of those are allowed.
#[test]
fn p_values_are_uniform_however_the_noise_is_stated() {
    let exact = exact();
    for statement in [
        NoiseStatement::Std,
        NoiseStatement::Repeats(2),
        NoiseStatement::Repeats(6),
        NoiseStatement::Silent,
    ] {
        let first = residuals(&noisy(&exact, statement, 1));
        let regions = Regions::new(&first.layout, &first.freedom);
        let statistics = statistics::all(&first, &regions);
        let nulls = Nulls::draw(&first, &statistics, 1, &Silent);
        let judgements: Vec<Judgement> = (100..250)
            .into_par_iter()
            .map(|seed| {
                nulls.judge(&statistics, &residuals(&noisy(&exact, statement, seed)).values)
            })
            .collect();
        let mut p_values: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for test in judgements.iter().flat_map(|judgement| &judgement.tests) {
            p_values.entry(&test.name).or_default().extend(test.p_value);
        }
        let untested = p_values.iter().filter(|(_, values)| values.is_empty()).count();
        assert_eq!(untested, usize::from(statement == NoiseStatement::Silent));
        for (name, values) in p_values.iter().filter(|(_, values)| !values.is_empty()) {
            let share = |level: f64| {
                values.iter().filter(|p| **p < level).count() as f64 / values.len() as f64
            };
            let (few, half) = (share(0.05), share(0.5));
            assert!(few < 0.05 + 4.0 * 0.018, "{statement:?} {name}: {few} below 0.05");
            assert!((half - 0.5).abs() < 4.0 * 0.041, "{statement:?} {name}: {half} below 0.5");
        }
        // 0.75 are expected; more than 5 have a probability of 0.01 %.
        let wrong = judgements.iter().filter(|judgement| !judgement.noise_like).count();
        assert!(wrong <= 5, "{statement:?}: {wrong} of 150 called wrong");
    }
}

// At a level of 0.5 %, 5 of 1000 are expected, with a standard deviation of 2.2. The limit itself
// is estimated from 10 of 2000 draws, so the level is known to a third.
#[test]
fn white_residuals_fail_at_the_family_wise_error_rate() {
    let residuals = residuals(&noisy(&exact(), NoiseStatement::Std, 1));
    let regions = Regions::new(&residuals.layout, &residuals.freedom);
    let statistics = statistics::all(&residuals, &regions);
    let nulls = Nulls::draw(&residuals, &statistics, 1, &Silent);
    let failed = (0..1000)
        .into_par_iter()
        .filter(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(10_000 + seed);
            let left = residuals.left_of(&residuals.law.draw(&mut rng));
            !nulls.judge(&statistics, &left).noise_like
        })
        .count();
    assert!((1..=15).contains(&failed), "{failed} of 1000");
}

// Three times the noise in all rows is far beyond 1e-12; 1.05 times as much, a p-value of some 2 %, is
// not, and noise itself never is.
#[test]
fn a_few_draws_say_only_of_what_is_far_from_noise_that_it_is_none() {
    let mut residuals = residuals(&noisy(&exact(), NoiseStatement::Std, 1));
    let noise = residuals.values.clone();
    let mut is_certain = |factor: f64| {
        residuals.values = &noise * factor;
        let regions = Regions::new(&residuals.layout, &residuals.freedom);
        let statistics = statistics::all(&residuals, &regions);
        Nulls::draw_unless_certain(&residuals, &statistics, 1, &Silent).is_none()
    };
    assert_eq!([1.0, 1.05, 3.0].map(&mut is_certain), [false, false, true]);
}

/// The discrepancy of a measurement whose response was changed before noise was added.
fn examined(
    statement: NoiseStatement,
    change: impl Fn(usize, &mut Experiment),
) -> (Discrepancy, Vec<Experiment>) {
    let mut experiments = exact();
    experiments.iter_mut().enumerate().for_each(|(i, experiment)| change(i, experiment));
    (discrepancy_of(&noisy(&experiments, statement, 7)), experiments)
}

/// The geometric mean of the frequencies of experiments `index` and `index + 1`, rad/s.
fn middle(experiments: &[Experiment], index: usize) -> f64 {
    (experiments[index].omega_rad_s * experiments[index + 1].omega_rad_s).sqrt()
}

#[test]
fn noise_is_adequate_and_the_sentence_says_what_would_have_been_noticed() {
    for statement in [NoiseStatement::Std, NoiseStatement::Repeats(4), NoiseStatement::Silent] {
        let (discrepancy, _) = examined(statement, |_, _| ());
        assert!(discrepancy.noise_like, "{:?}", discrepancy.tests);
        assert!(discrepancy.patterns.is_empty());
        let sentence = &discrepancy.sentence;
        assert!(sentence.contains("to within its noise; an error of 0."), "{sentence}");
    }
}

#[test]
fn a_wrong_harmonic_in_a_corner_is_found_and_described() {
    let exact = exact();
    let (limit, lowest) = (middle(&exact, 3), exact[0].magnitude);
    for statement in [NoiseStatement::Std, NoiseStatement::Repeats(4), NoiseStatement::Silent] {
        let (discrepancy, _) = examined(statement, |_, experiment| {
            if experiment.magnitude == lowest && experiment.omega_rad_s < limit {
                experiment.response[3].value *= 1.4;
            }
        });
        assert!(!discrepancy.noise_like);
        let pattern = &discrepancy.patterns[0];
        let said = &pattern.sentence;
        assert!(said.starts_with("at the lowest magnitude ("), "{said}");
        assert!(said.contains(" Hz, the third harmonic is ") && said.contains("below "), "{said}");
        assert!(said.contains(" % larger than simulated"), "{said}");
        assert!(discrepancy.sentence.contains(said.as_str()));
        // The fit absorbs a little of the 40 %.
        let size = pattern.relative_size.unwrap();
        assert!((0.36..0.44).contains(&size), "{size}");
        // At one of the four frequencies the harmonic may be nearly 0.
        assert_eq!(pattern.harmonics, [3]);
        assert!((3..=4).contains(&pattern.count), "{}", pattern.count);
        assert!(pattern.share > 0.8, "{}", pattern.share);
    }
}

#[test]
fn a_mean_that_is_wrong_everywhere_is_described_in_units_of_the_response() {
    let (discrepancy, experiments) = examined(NoiseStatement::Std, |_, e| {
        let size = e.response[1].value.norm();
        e.response[0].value += 0.03 * size;
    });
    let pattern = &discrepancy.patterns[0];
    assert_eq!(pattern.harmonics, [0], "{}", pattern.sentence);
    assert!(pattern.sentence.contains("the mean "), "{}", pattern.sentence);
    assert_eq!(discrepancy.by_harmonic.len(), experiments[0].response.len());
}

#[test]
fn a_phase_that_leads_above_a_frequency_is_described_in_degrees() {
    let limit = middle(&exact(), 6);
    let (discrepancy, _) = examined(NoiseStatement::Std, |_, e| {
        if e.omega_rad_s > limit {
            e.response[1].value *= Complex::from_polar(1.0, 0.2);
        }
    });
    let pattern = &discrepancy.patterns[0];
    assert!(pattern.sentence.contains("the fundamental leads by "), "{}", pattern.sentence);
    assert_eq!(pattern.harmonics, [1]);
    // 0.2 rad are 11.5°; the fitted pole absorbs a part.
    assert!((4.0..12.0).contains(&pattern.phase_deg.unwrap()), "{pattern:?}");
}

#[test]
fn a_response_that_grows_while_it_is_measured_is_a_drift() {
    let count = exact().len();
    let (discrepancy, _) = examined(NoiseStatement::Std, |i, e| {
        // A permutation, as 7 and 24 have no common factor: not the order of magnitude or
        // frequency.
        let run = (7 * i % count) as f64;
        e.run = Some(run);
        e.response.iter_mut().for_each(|h| h.value *= 1.0 + 0.05 * run / count as f64);
    });
    let pattern = &discrepancy.patterns[0];
    assert_eq!(pattern.runs, Some([0.0, (count - 1) as f64]), "{}", pattern.sentence);
    assert!(pattern.sentence.starts_with("the response grows during the acquisition"));
    // From the first to the last third the mean grows by two thirds of 5 %.
    let change = pattern.relative_size.unwrap();
    assert!((0.025..0.045).contains(&change), "{change}");
    assert_eq!(discrepancy.by_run.len(), 8);
}

#[test]
fn a_single_wrong_point_is_described_by_where_it_is() {
    let (discrepancy, experiments) = examined(NoiseStatement::Std, |i, e| {
        if i == 12 {
            let size = e.response[1].value.norm();
            e.response[2].value += 0.02 * size;
        }
    });
    let pattern = &discrepancy.patterns[0];
    let hertz = experiments[12].omega_rad_s / std::f64::consts::TAU;
    assert_eq!((pattern.count, pattern.harmonics.as_slice()), (1, &[2][..]));
    let [low, high] = pattern.frequencies_hz.unwrap();
    assert!((low - hertz).abs() < 1e-9 * hertz && (high - hertz).abs() < 1e-9 * hertz);
    assert_eq!(pattern.magnitudes, Some([experiments[12].magnitude; 2]));
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
