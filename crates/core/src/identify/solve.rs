//! Fits a measurement as requested, and assembles the answer.

use crate::answers::{Identification, InvalidOptions, OrderChoice, PlantRequest, Provenance};
use crate::measurement::Measurement;
use crate::observer::Observer;

use super::corrected::Corrected;
use super::history::History;
use super::noise::Weights;
use super::objective::{Evaluation, Misfit};
use super::pipeline::{Fitted, Run};
use super::problem::Problem;
use super::request::{IdentifyError, IdentifyRequest};
use super::summary::Intervals;
use super::{limitations, order, summary};

/// Interpolation error of the inputs while network and colony look for the best base model, as a
/// share of their rms (tuned). Behind an actuator with a sharp resonance a hundred times this is too
/// coarse.
const SEARCH_INTERPOLATION_ERROR: f64 = 1e-5;

/// The chosen fit, and how it was chosen.
pub(super) struct Solved {
    pub(super) chosen: Fitted,
    pub(super) order_choice: Option<OrderChoice>,
    /// The fits of all orders that were tried.
    pub(super) fits: Vec<Fitted>,
}

/// Fits the requested order of the actuator, or all three and chooses among them, with the given
/// weights or, without any, with those that the request asks for. Where an order is among the
/// `known` fits, which may have other weights, it is refined from there.
pub(super) fn solve(
    measurement: &Measurement,
    problem: &Problem,
    request: &IdentifyRequest,
    (weights, known): (Option<&Weights>, &[Fitted]),
    observer: &dyn Observer,
) -> Result<Solved, IdentifyError> {
    let IdentifyRequest { plant, method, options, methods, .. } = request;
    options.validate()?;
    let steps = methods.steps(*method)?;
    let orders: Vec<u8> = match plant {
        Some(PlantRequest { actuator_order: order @ 0..=2 }) => vec![*order],
        Some(PlantRequest { actuator_order }) => {
            let reason = format!("{actuator_order} is not 0, 1 or 2");
            return Err(InvalidOptions { option: "plant.actuator_order", reason }.into());
        }
        None => vec![0, 1, 2],
    };
    let coarse = problem.coarser(SEARCH_INTERPOLATION_ERROR);
    let coarse = coarse.as_ref();
    let mut fits: Vec<Fitted> = Vec::new();
    for (before, order) in orders.iter().enumerate() {
        let history = History { observer, order: *order, orders: (before, orders.len()) };
        let known = known.iter().find(|known| known.order == *order);
        let lower = fits.last();
        let run =
            Run { steps, measurement, problem, coarse, options, weights, known, lower, history };
        fits.push(run.fit()?);
    }
    let order_choice = (fits.len() > 1).then(|| order::choose(problem, &fits, observer));
    let wanted = order_choice.as_ref().map_or(orders[0], |choice| choice.actuator_order);
    let stages = fits.iter().flat_map(|fit| fit.stages.clone()).collect();
    let chosen = fits.iter().find(|fit| fit.order == wanted);
    let chosen = chosen.expect("a fitted order is chosen").clone();
    Ok(Solved { chosen: Fitted { stages, ..chosen }, order_choice, fits })
}

/// The answer that reports a fit, of whose point this is the evaluation.
pub(super) fn answer(
    measurement: &Measurement,
    misfits @ (misfit, _): (&Misfit<'_>, Option<Corrected<'_>>),
    request: &IdentifyRequest,
    (fitted, evaluation): (&Fitted, &Evaluation),
    order_choice: Option<OrderChoice>,
    intervals: Intervals,
) -> Identification {
    let IdentifyRequest { plant, method, options, search, .. } = request;
    let Misfit { problem, weights, .. } = misfit;
    let summary = summary::summarise(measurement, misfits, (fitted, evaluation), intervals, search);
    let limitations = limitations::of(measurement, problem, *method, options, fitted, &summary);
    let stop_reason = fitted.stages.last().map_or("nothing to do", |stage| &stage.stop_reason);
    Identification {
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
        doubts: measurement.doubts(),
        limitations,
        provenance: Provenance {
            software_version: env!("CARGO_PKG_VERSION").to_owned(),
            data_sha256: measurement.sha256().to_owned(),
            options: *options,
            actuator_order: plant.map(|plant| plant.actuator_order),
        },
    }
}
