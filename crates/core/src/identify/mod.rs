//! From a measurement to the parameters of the base model.

mod agreement;
pub mod bee_colony;
mod closed_form;
mod compare;
mod effect_coordinates;
mod estimates;
mod features;
#[cfg(test)]
mod fixtures;
mod followed;
mod history;
mod limitations;
mod linear_least_squares;
mod methods;
mod model_fit;
mod moderation;
mod naming;
pub mod network;
mod noise;
mod noise_law;
mod objective;
mod optimiser;
mod order;
mod over_cube;
mod parameters;
mod pipeline;
mod problem;
mod profile;
mod proposal;
mod refine;
mod summary;
mod uncertainty;
mod workbench;

use crate::answers::{
    Identification, IdentifyOptions, InvalidOptions, Method, OrderChoice, PlantRequest, Provenance,
};
use crate::measurement::Measurement;
use crate::observer::Observer;

pub use agreement::UnitAgreement;
pub use compare::compare;
pub use followed::{Begun, Followed, follow, unscored_s};
pub use model_fit::{Component, ModelFit, fit_base};
pub use noise_law::NoiseLaw;
pub use summary::Intervals;
pub use workbench::{Effort, Linear, Model, Workbench};

use history::History;
use objective::Misfit;
use pipeline::{Fitted, Run};
use problem::Problem;

/// Why an identification gave no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// The observer asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// An option no computation can use.
    #[error(transparent)]
    Options(#[from] InvalidOptions),
    /// The data cannot determine any model.
    #[error("the measurement cannot be fitted: {reason}")]
    Unusable {
        /// What is missing and what would help.
        reason: String,
    },
}

/// What is asked of an identification.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct IdentifyRequest {
    /// What is known of the plant; `None`: the order is chosen from the data.
    pub plant: Option<PlantRequest>,
    /// The method.
    pub method: Method,
    /// Its options.
    pub options: IdentifyOptions,
}

/// Fits the base model to a measurement.
///
/// # Errors
/// See [`IdentifyError`].
pub fn identify(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Identification, IdentifyError> {
    let problem = Problem::new(measurement)?;
    let Solved { chosen, order_choice } = solve(measurement, &problem, request, observer)?;
    let (coordinates, weights) = (&chosen.coordinates, &chosen.weights);
    let misfit = Misfit::new(&problem, coordinates, weights, observer);
    answer(measurement, &misfit, request, &chosen, order_choice, Intervals::Profile)
}

/// The chosen fit.
struct Solved {
    chosen: Fitted,
    order_choice: Option<OrderChoice>,
}

fn solve(
    measurement: &Measurement,
    problem: &Problem,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Solved, IdentifyError> {
    let IdentifyRequest { plant, method, options } = request;
    options.validate()?;
    let orders: Vec<u8> = match plant {
        Some(PlantRequest { actuator_order: order @ 0..=2 }) => vec![*order],
        Some(PlantRequest { actuator_order }) => {
            let reason = format!("{actuator_order} is not 0, 1 or 2");
            return Err(InvalidOptions { option: "plant.actuator_order", reason }.into());
        }
        None => vec![0, 1, 2],
    };
    let mut fits: Vec<Fitted> = Vec::new();
    for (before, order) in orders.iter().enumerate() {
        let history = History { observer, order: *order, orders: (before, orders.len()) };
        let lower = fits.last();
        let run = Run { method: *method, measurement, problem, options, lower, history };
        fits.push(run.fit()?);
    }
    let order_choice = (fits.len() > 1).then(|| order::choose(problem, &fits, observer));
    let wanted = order_choice.as_ref().map_or(orders[0], |choice| choice.actuator_order);
    let stages = fits.iter().flat_map(|fit| fit.stages.clone()).collect();
    let chosen = fits.into_iter().find(|fit| fit.order == wanted);
    let chosen = chosen.expect("a fitted order is chosen");
    Ok(Solved { chosen: Fitted { stages, ..chosen }, order_choice })
}

/// What is said of a fit.
fn answer(
    measurement: &Measurement,
    misfit: &Misfit<'_>,
    request: &IdentifyRequest,
    fitted: &Fitted,
    order_choice: Option<OrderChoice>,
    intervals: Intervals,
) -> Result<Identification, IdentifyError> {
    let IdentifyRequest { plant, method, options } = request;
    let Misfit { problem, weights, .. } = misfit;
    let summary =
        summary::summarise(measurement, misfit, fitted, intervals).ok_or_else(no_response)?;
    let limitations = limitations::of(measurement, problem, *method, options, fitted, &summary);
    let stop_reason = fitted.stages.last().map_or("nothing to do", |stage| &stage.stop_reason);
    Ok(Identification {
        method: *method,
        seed: options.seed,
        noise: weights.source,
        parameters: summary.parameters,
        transfer_function: summary.transfer_function,
        fit: summary.fit,
        correlations: summary.correlations,
        stop_reason: stop_reason.to_owned(),
        stages: fitted.stages.clone(),
        order_choice,
        limitations,
        provenance: Provenance {
            software_version: env!("CARGO_PKG_VERSION").to_owned(),
            data_sha256: measurement.sha256().to_owned(),
            options: *options,
            actuator_order: plant.map(|plant| plant.actuator_order),
        },
    })
}

fn no_response() -> IdentifyError {
    IdentifyError::Unusable { reason: "the fitted plant has no periodic response".into() }
}
