//! A fault of a record that one number describes, fitted together with a model.

use crate::answers::MeasurementFault;
use crate::identify::{FitAccuracy, FitSession, Intervals, Model};

use crate::diagnose::residuals::layout::Cell;
use crate::diagnose::residuals::residual::Residuals;

use super::candidates::Candidate;
use super::mending;
use super::projection::Outside;
use super::suspects::Suspects;

/// Most fits of a model, each beside another value of the number.
const MOST_ROUNDS: usize = 8;

/// A fault that one number describes.
pub(super) trait OneNumber {
    /// How the data change with the number, to first order, given what is measured at each line.
    fn candidate(&self, cells: &[&Cell]) -> Candidate;
    /// The fault, with its number and the standard deviation of that. Numbers add up.
    fn fault(&self, number: f64, deviation: f64) -> MeasurementFault;
    /// What the number is larger than.
    fn least(&self) -> f64 {
        f64::NEG_INFINITY
    }
}

/// A model beside a fault.
pub(super) struct Beside<'a> {
    /// The data with the fault mended, by the number of the last fit.
    pub session: FitSession<'a>,
    /// The model, fitted to that.
    pub model: Model,
    /// The fault.
    pub fault: MeasurementFault,
    /// −2 ln of its prior probability, and the volume of its number.
    pub price: f64,
}

/// The one of these faults that explains most beside a model, its number fitted together with the model
/// by Gauss–Newton steps, each halved until the fit is better, until one is shorter than a standard
/// deviation or [`MOST_ROUNDS`] fits are made. `None` if the first step promises less than half of what is
/// needed for −2 ln likelihood to fall below `least`: far from the best number it promises less than it
/// brings.
pub(super) fn best<'a>(
    suspects: &Suspects<'a>,
    start: &Model,
    least: f64,
    faults: &[impl OneNumber],
) -> Option<Beside<'a>> {
    let experiments = suspects.session.measurement().experiments();
    let whole = Linearised::of(suspects.session, start, suspects)?;
    let steps = faults.iter().filter_map(|fault| Some((fault, whole.step(fault)?)));
    let (of, mut step) = steps.max_by(|a, b| a.1.gain.total_cmp(&b.1.gain))?;
    let mended = |number: f64| {
        let faults = [of.fault(number, 0.0)];
        let session = suspects.session;
        session.changed(|experiment, k| mending::change(&faults, experiments, experiment, k))
    };
    let (mut session, mut model) = (None, start.clone());
    let (mut number, mut moved) = (0.0, step.number);
    for _ in 0..MOST_ROUNDS {
        let is_possible = number + moved > of.least();
        let is_enough = step.misfit + step.price - least <= 2.0 * step.gain;
        let is_last = session.is_some() && moved.abs() < step.deviation;
        if is_last || !(is_possible && is_enough) {
            break;
        }
        let trial = mended(number + moved);
        let fitted = trial.refine(&model, FitAccuracy::Settle);
        let next = Linearised::of(&trial, &fitted, suspects).and_then(|here| here.step(of));
        match next {
            Some(next) if next.misfit < step.misfit => {
                number += moved;
                moved = next.number;
                (session, model, step) = (Some(trial), fitted, next);
            }
            _ => moved *= 0.5,
        }
    }
    let last = if moved.abs() < step.deviation { moved } else { 0.0 };
    let fault = of.fault(number + last, step.deviation);
    Some(Beside { session: session?, model, fault, price: step.price })
}

/// A model linearised in its parameters.
struct Linearised<'s> {
    suspects: &'s Suspects<'s>,
    residuals: Residuals,
    /// −2 ln likelihood, and the cost it is of.
    misfit: f64,
    cost: f64,
}

/// A step of the number of a fault beside a model.
struct Step {
    number: f64,
    /// Standard deviation of the number.
    deviation: f64,
    /// −2 ln likelihood before the step, and by how much the step lowers it.
    misfit: f64,
    gain: f64,
    price: f64,
}

impl<'s> Linearised<'s> {
    fn of(session: &FitSession<'_>, model: &Model, suspects: &'s Suspects<'_>) -> Option<Self> {
        if !model.cost.is_finite() {
            return None;
        }
        let fit = session.judge(model, Intervals::Curvature).ok()?;
        let (residuals, cost) = (Residuals::of(&fit), model.cost);
        Some(Self { suspects, residuals, misfit: suspects.misfit_of_noise(cost), cost })
    }

    fn step(&self, of: &impl OneNumber) -> Option<Step> {
        let Self { suspects, residuals, misfit, cost } = self;
        let cells: Vec<&Cell> = residuals.layout.cells.iter().collect();
        let candidate = of.candidate(&cells);
        let outside = Outside::of(&candidate, &residuals.fitted)?;
        let left = residuals.fitted.complement(&residuals.values);
        let (decrease, values) = outside.best(&left);
        let all = left.norm_squared();
        let scale = if suspects.size_known() { 1.0 } else { all / residuals.dof() };
        Some(Step {
            number: values[0],
            deviation: scale.sqrt() * outside.deviations()[0],
            misfit: *misfit,
            gain: misfit - suspects.misfit_of_noise(cost * (1.0 - decrease / all)),
            price: candidate.price + outside.volume(decrease / scale),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::PlantRequest;
    use crate::diagnose::faults::skew::Skew;
    use crate::diagnose::fixtures::{multiplied, multisine_record, plant};
    use crate::diagnose::selection::evidence::NoiseScale;
    use crate::diagnose::selection::models::Models;
    use crate::identify::IdentifyRequest;
    use crate::measurement::Complex;
    use crate::observer::Silent;

    /// The lead that is found beside the base model of a healthy axis whose response is ahead by a
    /// time, s, after another was mended.
    fn lead(seconds: f64, mended_s: f64) -> Option<f64> {
        let sound = multisine_record(plant(), &[], None, 5);
        let turn = |_, omega_rad_s| Complex::from_polar(1.0, omega_rad_s * seconds);
        let measurement = multiplied(&sound, turn);
        let plant = Some(PlantRequest { actuator_order: 1 });
        let request = IdentifyRequest { plant, ..IdentifyRequest::default() };
        let session = &FitSession::new(&measurement, &request, &Silent).unwrap();
        let base = &session.judge(session.base(), Intervals::Curvature).unwrap();
        let models = &Models::new(session.base().clone(), NoiseScale::of(session));
        let suspects =
            Suspects { session, base, models, combined: false, seed: 1, lead_s: mended_s };
        let found = best(&suspects, session.base(), suspects.best_without(), &[Skew { mended_s }])?;
        found.fault.value
    }

    // A single search need not come to the end: the mended measurement is diagnosed again.
    #[test]
    fn a_response_that_is_ahead_has_a_lead_and_one_that_is_late_none() {
        assert!(lead(1e-2, 0.0).is_some_and(|seconds| seconds > 0.0));
        assert_eq!(lead(-1e-2, 0.0), None);
    }

    #[test]
    fn a_lead_that_was_mended_too_much_is_corrected_but_not_beyond_all_of_it() {
        assert!(lead(-1e-2, 5e-2).is_some_and(|seconds| seconds < 0.0));
        assert!(lead(-1e-2, 1e-3).is_none_or(|seconds| seconds > -1e-3));
    }
}
