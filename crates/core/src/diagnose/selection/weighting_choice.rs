//! Choice between two weightings of the errors: by the noise, or all equal.
//!
//! With noise weights the harmonics that repeat best dominate the fit. If every model leaves many
//! times the noise, how well a harmonic repeats does not tell how well a model can follow it, and
//! the fit sacrifices most of the response for the part that was measured best. Then all errors get
//! equal weights.

use crate::answers::{Diagnosis, Identification, IdentifyOptions, Weighting};
use crate::identify::{FitSession, IdentifyRequest};

use super::order_selection::{self, Found};
use crate::diagnose::doubt::{Data, Halt};
use crate::diagnose::faults::{readings, wrong_gain};
use crate::diagnose::progress::{Part, Quiet};

/// Largest χ² per degree of freedom of a model that is limited by the noise. Above it the residuals
/// are more than four times as large as the noise. Tuned.
const NOISE_LIMITED_CHI2_PER_DOF: f64 = 20.0;

/// Equal weights are used only if their NRMSE is at most this share of the NRMSE with noise
/// weights. Tuned.
const WORTHWHILE_NRMSE_RATIO: f64 = 0.9;

/// χ² per datum of the base model above which equal weights are tried first: with noise weights the
/// harmonics that repeat best would alone decide which effects are tried. Tuned; one missing effect
/// at 60 dB gives some 100.
const EQUAL_WEIGHTS_FIRST_CHI2_PER_DATUM: f64 = 5e3;

/// Largest χ² per datum at which a model found with equal weights, fitted again with those of the noise,
/// is worth a search with these: effects that it lacks would have to take off nine tenths more. Set by
/// hand.
const WORTH_NOISE_WEIGHTS_CHI2_PER_DATUM: f64 = 10.0 * NOISE_LIMITED_CHI2_PER_DOF;

/// Shares of the progress: fitting the base model, the first weighting, and the second. If the
/// base model is limited by the noise already, there is no second; else there may be.
const BASE_FIT_SPAN: [f64; 2] = [0.0, 0.1];
/// Share of the progress of a weighting in which its own base model is fitted.
const OWN_BASE_FIT_SHARE: f64 = 0.15;
const ONLY_WEIGHTING_SPAN: [f64; 2] = [0.1, 1.0];
const FIRST_WEIGHTING_SPAN: [f64; 2] = [0.1, 0.6];
const SECOND_WEIGHTING_SPAN: [f64; 2] = [0.6, 1.0];
/// Shares of the progress where no noise is stated: the weights of the base model, those of the best
/// single effect, and those of the model found. Where the second follow, the first end with the single
/// effects, at 0.35 at most.
const WEIGHTS_LEFT_SPANS: [[f64; 2]; 3] = [[0.1, 0.6], [0.35, 0.8], [0.8, 1.0]];

/// Diagnoses with noise weights. If no model is limited by the noise, equal weights are tried too,
/// and win if they leave clearly less of the response. If the base model is very far from the
/// noise, equal weights come first, and noise weights only follow if the model found is not as far.
///
/// # Errors
/// See [`DiagnoseError`]; and the faults of the measurement, if it is doubted and has any.
pub(crate) fn diagnose(
    data: Data<'_>,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, Halt> {
    let answer = choose_weighting(data, request, part)?;
    // If one weighting sufficed, the share of the second was skipped.
    part.part([1.0, 1.0]).stage("finished", 1).step();
    Ok(answer)
}

fn choose_weighting(
    data: Data<'_>,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, Halt> {
    let measurement = data.measurement;
    let options = IdentifyOptions { weights: Weighting::Response, ..request.options };
    let equal_request = IdentifyRequest { options, ..*request };
    let fitting = part.part(BASE_FIT_SPAN);
    let first = FitSession::new(measurement, request, &fitting)?;
    if data.doubted
        && let Some(halt) = readings::misread(&first, measurement, request, &fitting)
    {
        return Err(halt);
    }
    let by_noise = |span| order_selection::diagnose(data, request, &first, part.part(span));
    let equal_weights = |span| {
        let part = part.part(span);
        let fitting = part.part([0.0, OWN_BASE_FIT_SHARE]);
        let session = first.weighted_as(&equal_request, &fitting)?;
        let undoubted = Data { doubted: false, ..data };
        order_selection::diagnose(
            undoubted,
            &equal_request,
            &session,
            part.part([OWN_BASE_FIT_SHARE, 1.0]),
        )
    };
    let chi2_per_dof = first.base().cost / first.data() as f64;
    if !first.noise_known() || chi2_per_dof <= EQUAL_WEIGHTS_FIRST_CHI2_PER_DATUM {
        if !first.noise_known() {
            return by_what_is_left(data, request, &first, part);
        }
        let needs_one = chi2_per_dof <= NOISE_LIMITED_CHI2_PER_DOF;
        let by_noise =
            by_noise(if needs_one { ONLY_WEIGHTING_SPAN } else { FIRST_WEIGHTING_SPAN })?;
        return match noise_limits(&by_noise) {
            true => Ok(by_noise),
            false => Ok(smaller_residual(Some(by_noise), equal_weights(SECOND_WEIGHTING_SPAN)?)),
        };
    }
    if data.doubted
        && let Some(halt) = wrong_gain::alone(&first, request.options.seed)
    {
        return Err(halt);
    }
    let equal_weights = equal_weights(FIRST_WEIGHTING_SPAN)?;
    let again = first.fitted_again(best(&equal_weights), &Quiet(&part))?;
    let most = WORTH_NOISE_WEIGHTS_CHI2_PER_DATUM * first.data() as f64;
    let is_near = again.is_some_and(|model| model.cost <= most);
    let by_noise = if is_near { Some(by_noise(SECOND_WEIGHTING_SPAN)?) } else { None };
    Ok(match by_noise {
        Some(by_noise) if noise_limits(&by_noise) => by_noise,
        by_noise => smaller_residual(by_noise, equal_weights),
    })
}

/// Diagnoses data of which no noise is stated. Weights follow from what the base model leaves, then from
/// what the best single effect leaves, before effects are combined: what a model lacks is easily taken for
/// noise. If those that follow from the model found are others again, the diagnosis is repeated with them,
/// once.
fn by_what_is_left(
    data: Data<'_>,
    request: &IdentifyRequest,
    first: &FitSession<'_>,
    part: Part<'_>,
) -> Result<Diagnosis, Halt> {
    let [by_base, by_one_effect, by_all] = WEIGHTS_LEFT_SPANS.map(|span| part.part(span));
    let diagnose =
        |session: &FitSession<'_>, part| order_selection::diagnose(data, request, session, part);
    let mut reweighted = None;
    let answer = match order_selection::unless_reweighted(data, request, first, by_base)? {
        Found::Answer(answer) => *answer,
        Found::OtherWeights(model) => {
            let session = reweighted.insert(first.weighted_by(&model, &part)?);
            diagnose(session, by_one_effect)?
        }
    };
    let session = reweighted.as_ref().unwrap_or(first);
    let found = best(&answer);
    match session.has_weights_of(found)? {
        true => Ok(answer),
        false => diagnose(&session.weighted_by(found, &part)?, by_all),
    }
}

/// Whether the best model is limited by the noise, or the noise is unknown.
fn noise_limits(answer: &Diagnosis) -> bool {
    best(answer).fit.chi2_per_dof.is_none_or(|ratio| ratio <= NOISE_LIMITED_CHI2_PER_DOF)
}

/// The answer that leaves less of the response. If that is the one with equal weights, its first
/// limitation says why they were used.
fn smaller_residual(by_noise: Option<Diagnosis>, mut equal_weights: Diagnosis) -> Diagnosis {
    let left = |answer: &Diagnosis| best(answer).fit.nrmse;
    let per_cent = |answer: &Diagnosis| format!("{:.3} %", 100.0 * left(answer));
    let effect = match by_noise {
        Some(answer) if left(&equal_weights) > WORTHWHILE_NRMSE_RATIO * left(&answer) => {
            return answer;
        }
        Some(answer) => format!("lowers the residual from {}", per_cent(&answer)),
        None => "brings the residual".to_owned(),
    };
    equal_weights.limitations.insert(
        0,
        format!(
            "no model fits to within the noise; all harmonics were therefore given the same weight, \
             which {effect} to {} of the response; the intervals were widened to match the residual",
            per_cent(&equal_weights),
        ),
    );
    equal_weights
}

/// The model with the causes, or the base model where no cause is named.
fn best(answer: &Diagnosis) -> &Identification {
    answer.extended.as_ref().unwrap_or(&answer.base)
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    use super::*;
    use crate::answers::{Progress, Verdict};
    use crate::diagnose::tests::{exact, noisy, request};
    use crate::machines::draw::NoiseStatement;
    use crate::measurement::{Complex, Experiment, Measurement, Metadata};
    use crate::observer::{Observer, Silent};

    /// The diagnosis of an axis whose sensor, at the lowest magnitude, reads alternately 10 % too
    /// much and too little; the noise there and elsewhere is a share of the largest response.
    fn answer(low: f64, elsewhere: f64) -> Diagnosis {
        let mut experiments = exact();
        let lowest = experiments.iter().map(|e| e.magnitude).fold(f64::INFINITY, f64::min);
        let largest = experiments
            .iter()
            .flat_map(|e| &e.response)
            .map(|h| h.value.norm())
            .fold(0.0, f64::max);
        for (index, experiment) in experiments.iter_mut().enumerate() {
            let wrong = if index % 2 == 0 { 1.1 } else { 0.9 };
            let is_low = experiment.magnitude == lowest;
            for harmonic in &mut experiment.response {
                harmonic.value *= if is_low { wrong } else { 1.0 };
                harmonic.std = Some(largest * if is_low { low } else { elsewhere });
            }
        }
        diagnosed(experiments)
    }

    fn undoubted(
        measurement: &Measurement,
        request: &IdentifyRequest,
        part: Part<'_>,
    ) -> Diagnosis {
        diagnose(Data { measurement, doubted: false, lead_s: 0.0 }, request, part).unwrap()
    }

    fn diagnosed(experiments: Vec<Experiment>) -> Diagnosis {
        let measurement =
            Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap();
        let options = IdentifyOptions { most_effects: 1, ..request().options };
        let request = IdentifyRequest { options, ..request() };
        undoubted(&measurement, &request, Part::of(&Silent))
    }

    // The noise is 90 dB below the largest harmonic; the hidden effect is a delay of 5 ms.
    #[test]
    fn a_model_that_explains_very_quiet_data_is_weighted_by_noise_however_wrong_the_base_model() {
        let mut experiments = exact();
        let responses = || experiments.iter().flat_map(|e| &e.response);
        let std = 3e-5 * responses().map(|h| h.value.norm()).fold(0.0, f64::max);
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for experiment in &mut experiments {
            for harmonic in &mut experiment.response {
                let turned = harmonic.order as f64 * experiment.omega_rad_s * 5e-3;
                let mut drawn = || std * rng.sample::<f64, _>(StandardNormal);
                let noise = Complex::new(drawn(), if harmonic.order > 0 { drawn() } else { 0.0 });
                harmonic.value = harmonic.value * Complex::from_polar(1.0, -turned) + noise;
                harmonic.std = Some(std);
            }
        }
        let answer = diagnosed(experiments);
        assert!(
            answer.base.fit.chi2_per_dof.unwrap() > EQUAL_WEIGHTS_FIRST_CHI2_PER_DATUM,
            "{:?}",
            answer.base.fit
        );
        assert_eq!(answer.verdict, Verdict::Explained, "{:?}", answer.limitations);
        assert_eq!(answer.causes[0].effect, "transport_delay");
    }

    /// The latest progress fraction.
    #[derive(Default)]
    struct Latest(Mutex<f64>);

    impl Observer for Latest {
        fn progress(&self, progress: Progress) {
            *self.0.lock().unwrap() = progress.fraction;
        }
    }

    #[test]
    fn a_finished_diagnosis_reports_its_progress_as_complete() {
        let measurement = noisy(&exact(), NoiseStatement::Std, 1);
        let latest = Latest::default();
        let part = Part::of(&latest);
        undoubted(&measurement, &request(), part);
        assert_eq!(*latest.0.lock().unwrap(), 1.0);
    }

    #[test]
    fn where_no_model_reaches_the_noise_all_harmonics_get_equal_weights() {
        let answer = answer(3e-6, 3e-3);
        assert_eq!(answer.base.provenance.options.weights, Weighting::Response);
        assert_eq!(answer.base.fit.chi2, None);
        assert!(answer.limitations[0].starts_with("no model fits to within the noise"));
    }

    #[test]
    fn where_a_model_is_limited_by_the_noise_errors_are_weighted_by_it() {
        let answer = answer(0.03, 0.03);
        assert_eq!(answer.base.provenance.options.weights, Weighting::Noise);
        assert!(answer.base.fit.chi2.is_some());
    }
}
