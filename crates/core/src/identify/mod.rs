//! Identifies the base model: from a measurement to parameters with confidence intervals.
//!
//! A method (`methods`) is a sequence of stages, run by `pipeline`: a closed form (`closed_form`),
//! a neural network (`network`, `proposal`), a population search (`bee_colony` and others), and
//! Levenberg–Marquardt refinement (`refine`). Search and refinement minimise one misfit
//! (`objective`), weighted by the noise (`noise`). The best point gives parameters, intervals and
//! correlations (`summary`). Where the request does not state the order of the actuator, `order`
//! chooses it from the data.
//!
//! `fit_session` keeps a fitted measurement, so that a diagnosis can fit further models to it.

pub mod bee_colony;
mod closed_form;
mod corrected;
mod correlated;
mod direction;
mod effect_coordinates;
mod eliminated;
mod estimated_input;
mod estimated_noise;
mod estimates;
mod features;
mod fit_session;
#[cfg(test)]
mod fixtures;
mod history;
mod levenberg_marquardt;
mod limitations;
mod linear_least_squares;
mod local_scatter;
mod methods;
mod minima;
mod model_fit;
pub mod network;
mod noise;
mod noise_law;
mod objective;
mod observed_motion;
pub mod optimiser;
mod order;
mod parameter_names;
mod parameters;
mod pipeline;
mod prediction;
mod problem;
mod profile;
mod proposal;
mod refine;
mod reported_noise;
mod request;
mod saturated;
mod search_settings;
mod solve;
mod summary;
mod transient_prediction;
mod uncertainty;
mod unit_compatibility;
mod unit_cube_objective;
mod units;
mod variance_law;
mod variance_shrinkage;

use crate::answers::Identification;
use crate::measurement::Measurement;
use crate::observer::{Observer, Steady};

pub use fit_session::{DatumChange, FitAccuracy, FitSession, LeavingOut, Linear, Model};
pub use methods::{Methods, Steps};
pub use model_fit::{Component, ModelFit, fit_base};
pub use noise_law::NoiseLaw;
pub use prediction::compare;
pub use request::{IdentifyError, IdentifyRequest};
pub(crate) use request::{no_response, unless_cancelled};
pub use search_settings::{SearchBreadth, SearchSettings};
pub use summary::Intervals;
pub use transient_prediction::{Begun, Followed, follow, unscored_s};
pub use unit_compatibility::UnitCompatibility;
pub(crate) use units::Units;

use objective::Misfit;
use problem::Problem;
use solve::{Solved, answer, solve};

/// Fits the base model to a measurement.
///
/// # Errors
/// See [`IdentifyError`].
pub fn identify(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Identification, IdentifyError> {
    let observer = &Steady::new(observer);
    observer.rest_is_certain();
    let measurement = &*measurement.repeated();
    let problem = Problem::new(measurement)?;
    let Solved { chosen, order_choice, .. } =
        solve(measurement, &problem, request, (None, &[]), observer)?;
    let (coordinates, weights) = (&chosen.coordinates, &chosen.weights);
    let misfit = Misfit::new(&problem, coordinates, weights, observer);
    let evaluation = misfit.evaluate(&chosen.point).map_err(|_| no_response());
    let answer = |evaluation| {
        let fitted = (&chosen, &evaluation);
        answer(measurement, (&misfit, None), request, fitted, order_choice, Intervals::Profile)
    };
    unless_cancelled(observer, evaluation.map(answer))
}
