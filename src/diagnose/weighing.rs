//! What to weigh errors with where no model comes down to the noise.
//!
//! Weighed by its noise, the harmonic that repeats best decides. Where what a model leaves is
//! many times the noise, how well a harmonic repeats says nothing about how well a model could
//! follow it: the fit then trades most of the response for the part that is measured best.

use crate::answers::{Diagnosis, Identification, IdentifyOptions, Weighting};
use crate::identify::IdentifyRequest;
use crate::measurement::Measurement;

use super::progress::Part;
use super::{DiagnoseError, orders};

/// χ² per degree of freedom beyond which noise does not limit a model: what is left is more
/// than four times as large.
const FAR: f64 = 20.0;

/// Share of the error that must go for other weights to be worth their while.
const WORTHWHILE: f64 = 0.9;

/// Shares of the whole: by noise, and all alike.
const SPANS: [[f64; 2]; 2] = [[0.0, 0.95], [0.95, 1.0]];

/// A diagnosis weighed by the noise or, where no model comes down to it, with all harmonics
/// alike if that leaves less of the response.
///
/// # Errors
/// See [`DiagnoseError`].
pub(super) fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    part: Part<'_>,
) -> Result<Diagnosis, DiagnoseError> {
    let by_noise = orders::diagnose(measurement, request, part.part(SPANS[0]))?;
    let left = |answer: &Diagnosis| best(answer).fit.nrmse;
    let noise_limits =
        |answer: &Diagnosis| best(answer).fit.chi2_per_dof.is_none_or(|ratio| ratio <= FAR);
    let by_noise = match by_noise {
        Some(answer) if noise_limits(&answer) => return Ok(answer),
        answer => answer,
    };
    let options = IdentifyOptions { weights: Weighting::Response, ..request.options };
    let request = IdentifyRequest { options, ..*request };
    let alike = orders::diagnose(measurement, &request, part.part(SPANS[1]))?;
    let mut alike = alike.expect("the noise is not taken for known");
    let than = match by_noise {
        Some(answer) if left(&alike) > WORTHWHILE * left(&answer) => return Ok(answer),
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
    Ok(alike)
}

/// The model with the causes, where there are any.
fn best(answer: &Diagnosis) -> &Identification {
    answer.extended.as_ref().unwrap_or(&answer.base)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{exact, request};
    use super::*;
    use crate::measurement::Metadata;
    use crate::observer::Silent;

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
        let measurement =
            Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap();
        let options = IdentifyOptions { most_effects: 1, ..request().options };
        let request = IdentifyRequest { options, ..request() };
        diagnose(&measurement, &request, Part { whole: &Silent, span: [0.0, 1.0] }).unwrap()
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
