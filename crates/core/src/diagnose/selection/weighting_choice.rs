//! Which weights the errors get where no model comes down to the noise.
//!
//! Weighted by its noise, the harmonic that repeats best decides. Where a model leaves many times the
//! noise, how well a harmonic repeats says nothing about how well the model can follow it: the fit then
//! gives up most of the response for the part that is measured best. Then all errors get equal weights.

use crate::answers::{Diagnosis, Identification, IdentifyOptions, Weighting};
use crate::identify;
use crate::identify::{FitSession, IdentifyRequest};
use crate::measurement::Measurement;

use super::order_selection;
use crate::diagnose::error::DiagnoseError;
use crate::diagnose::holdout::gain;
use crate::diagnose::holdout::heldout_predictions::predicted;
use crate::diagnose::progress::Part;

/// χ² per degree of freedom beyond which noise does not limit a model: what is left is more
/// than four times as large.
const FAR: f64 = 20.0;

/// Share of the error that must go for other weights to be worth their while.
const WORTHWHILE: f64 = 0.9;

/// The same from which on the harmonics that repeat best would alone decide what is tried
/// beside a model. Where one effect is missing at 60 dB it is some hundred.
const HOPELESS: f64 = 5e3;

/// Shares of the whole: the base model, one weighting, and another where that was not all.
const FITTING: [f64; 2] = [0.0, 0.1];
const STUDYING: [f64; 2] = [0.1, 0.95];
const AGAIN: [f64; 2] = [0.95, 1.0];

/// A diagnosis weighed by the noise or, where no model comes down to it, with all harmonics
/// alike if that leaves less of the response. Where the base model is far from the noise it
/// comes second, and only if what equal weights find is not as far.
///
/// # Errors
/// See [`DiagnoseError`].
pub(crate) fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let answer = weighed(measurement, request, part)?;
    // Where one weighting was all that it took, what was set aside for another was not used.
    part.part([1.0, 1.0]).stage("diagnosis", 1).step();
    Ok(answer)
}

fn weighed(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let options = IdentifyOptions { weights: Weighting::Response, ..request.options };
    let all_alike = IdentifyRequest { options, ..*request };
    let fitting = part.part(FITTING);
    let first = FitSession::new(measurement, request, &fitting)?;
    let by_noise = |span| order_selection::diagnose(measurement, request, &first, part.part(span));
    let alike = |span| {
        let part = part.part(span);
        let fitting = part.part(FITTING);
        let first = FitSession::new(measurement, &all_alike, &fitting)?;
        order_selection::diagnose(measurement, &all_alike, &first, part.part([FITTING[1], 1.0]))
    };
    let chi2_per_dof = first.base().cost / first.data() as f64;
    if !first.noise_known() || chi2_per_dof <= HOPELESS {
        let by_noise = by_noise(STUDYING)?;
        return match noise_limits(&by_noise) {
            true => Ok(by_noise),
            false => Ok(better(Some(by_noise), alike(AGAIN)?)),
        };
    }
    let alike = alike(STUDYING)?;
    let is_near = chi2_of(measurement, request, &alike)? <= HOPELESS;
    let by_noise = if is_near { Some(by_noise(AGAIN)?) } else { None };
    Ok(match by_noise {
        Some(by_noise) if noise_limits(&by_noise) => by_noise,
        by_noise => better(by_noise, alike),
    })
}

/// Whether a model comes down to the noise, or nothing is known of the noise.
fn noise_limits(answer: &Diagnosis) -> bool {
    best(answer).fit.chi2_per_dof.is_none_or(|ratio| ratio <= FAR)
}

/// χ² per datum, by the noise, of a model that was fitted with other weights.
fn chi2_of(
    measurement: &Measurement,
    request: &IdentifyRequest,
    alike: &Diagnosis,
) -> Result<f64, DiagnoseError> {
    let mut model = best(alike).clone();
    model.provenance.options = request.options;
    let comparison = identify::compare(measurement, &model)?;
    Ok(gain::summary(&predicted(&comparison), true).chi2_per_dof.unwrap_or(f64::INFINITY))
}

/// What leaves less of the response, and where that is what was weighed alike, why.
fn better(by_noise: Option<Diagnosis>, mut alike: Diagnosis) -> Diagnosis {
    let left = |answer: &Diagnosis| best(answer).fit.nrmse;
    let than = match by_noise {
        Some(answer) if left(&alike) > WORTHWHILE * left(&answer) => return answer,
        Some(answer) => format!(" instead of {:.3} %", 100.0 * left(&answer)),
        None => String::new(),
    };
    alike.limitations.insert(
        0,
        format!(
            "no model reaches the noise, so how well a harmonic repeats says nothing of how well \
             a model can follow it: here all harmonics weigh alike, which leaves {:.3} % of the \
             response{than}; intervals are as wide as what is left demands",
            100.0 * left(&alike),
        ),
    );
    alike
}

/// The model with the causes, where there are any.
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
    use crate::measurement::{Complex, Experiment, Metadata};
    use crate::observer::{Observer, Silent};

    /// An axis whose sensor reads at the lowest magnitude by turns a tenth too much and too
    /// little; noise as a share of the largest response there and elsewhere.
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

    fn diagnosed(experiments: Vec<Experiment>) -> Diagnosis {
        let measurement =
            Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap();
        let options = IdentifyOptions { most_effects: 1, ..request().options };
        let request = IdentifyRequest { options, ..request() };
        diagnose(&measurement, &request, Part { whole: &Silent, span: [0.0, 1.0] }).unwrap()
    }

    // Noise 90 dB below the largest harmonic, and a delay of 5 ms.
    #[test]
    fn what_explains_very_quiet_data_is_weighed_by_the_noise_however_wrong_the_base_model() {
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
        assert!(answer.base.fit.chi2_per_dof.unwrap() > HOPELESS, "{:?}", answer.base.fit);
        assert_eq!(answer.verdict, Verdict::Explained, "{:?}", answer.limitations);
        assert_eq!(answer.causes[0].effect, "transport_delay");
    }

    /// How far it is.
    #[derive(Default)]
    struct Latest(Mutex<f64>);

    impl Observer for Latest {
        fn progress(&self, progress: Progress) {
            *self.0.lock().unwrap() = progress.fraction;
        }
    }

    #[test]
    fn a_diagnosis_that_ends_has_come_to_its_end() {
        let measurement = noisy(&exact(), NoiseStatement::Std, 1);
        let latest = Latest::default();
        let part = Part { whole: &latest, span: [0.0, 1.0] };
        diagnose(&measurement, &request(), part).unwrap();
        assert_eq!(*latest.0.lock().unwrap(), 1.0);
    }

    #[test]
    fn where_no_model_reaches_the_noise_harmonics_weigh_alike() {
        let answer = answer(3e-6, 3e-3);
        assert_eq!(answer.base.provenance.options.weights, Weighting::Response);
        assert_eq!(answer.base.fit.chi2, None);
        assert!(answer.limitations[0].starts_with("no model reaches the noise"));
    }

    #[test]
    fn where_noise_is_what_is_left_it_weighs() {
        let answer = answer(0.03, 0.03);
        assert_eq!(answer.base.provenance.options.weights, Weighting::Noise);
        assert!(answer.base.fit.chi2.is_some());
    }
}
