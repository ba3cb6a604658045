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
    let ratio = best(&by_noise).fit.chi2_per_dof;
    let Some(ratio) = ratio.filter(|ratio| *ratio > FAR) else { return Ok(by_noise) };
    let options = IdentifyOptions { weights: Weighting::Response, ..request.options };
    let request = IdentifyRequest { options, ..*request };
    let mut alike = orders::diagnose(measurement, &request, part.part(SPANS[1]))?;
    let left = [&by_noise, &alike].map(|answer| best(answer).fit.nrmse);
    if left[1] > WORTHWHILE * left[0] {
        return Ok(by_noise);
    }
    alike.limitations.insert(
        0,
        format!(
            "no model reaches the noise: the best leaves {ratio:.0} times its χ². Weighed by the \
             noise it leaves {:.3} % of the response, with all harmonics alike {:.3} %, so here \
             they weigh alike; intervals are as wide as what is left demands",
            100.0 * left[0],
            100.0 * left[1],
        ),
    );
    Ok(alike)
}

/// The model with the causes, where there are any.
fn best(answer: &Diagnosis) -> &Identification {
    answer.extended.as_ref().unwrap_or(&answer.base)
}
