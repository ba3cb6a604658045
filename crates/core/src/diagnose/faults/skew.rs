//! A record whose response is ahead of its input.
//!
//! A logger that writes the input a sample late makes the response lead it, as no machine does. Where
//! the response is late instead, that is a delay of the machine.

use std::f64::consts::TAU;

use crate::answers::{FaultKind, MeasurementFault};
use crate::identify::{FitAccuracy, FitSession, Intervals, Model};
use crate::measurement::Complex;

use crate::diagnose::residuals::layout::Cell;
use crate::diagnose::residuals::residual::Residuals;

use super::candidates::{Candidate, FAULT_COST, PHASE_DEVIATION, Place, column};
use super::fault;
use super::mending;
use super::projection::Outside;
use super::suspects::Suspects;

/// Most fits of a model, each beside another time.
const MOST_ROUNDS: usize = 8;

/// A model beside a response that is ahead.
pub(super) struct Skewed<'a> {
    /// The data with the response delayed by what it is ahead, to a standard deviation.
    pub session: FitSession<'a>,
    /// The model, fitted to that.
    pub model: Model,
    /// The fault, with its time in seconds.
    pub fault: MeasurementFault,
    /// −2 ln of its prior probability, and the volume of the time.
    pub price: f64,
}

/// The time by which the response is ahead, fitted together with a model by Gauss–Newton steps, each
/// halved until the fit is better; the last is shorter than a standard deviation. `None` if the response
/// is not ahead, or if the first step promises less than half of what is needed for −2 ln likelihood to
/// fall below `least`: far from the best time it promises less than it brings.
pub(super) fn beside<'a>(suspects: &Suspects<'a>, start: &Model, least: f64) -> Option<Skewed<'a>> {
    let experiments = suspects.session.measurement().experiments();
    let at = |seconds: f64| {
        let faults = [fault::timed(seconds, 0.0)];
        suspects
            .session
            .changed(|experiment, order| mending::change(&faults, experiments, experiment, order))
    };
    let (mut session, mut model) = (at(0.0), start.clone());
    let (mut seconds, mut step) = (0.0, Step::of(&session, &model, suspects)?);
    let mut moved = step.seconds;
    for _ in 0..MOST_ROUNDS {
        let is_ahead = seconds + moved > 0.0;
        let is_enough = step.misfit + step.price - least <= 2.0 * step.gain;
        let is_last = seconds > 0.0 && moved.abs() < step.deviation;
        if is_last || !(is_ahead && is_enough) {
            break;
        }
        let trial = at(seconds + moved);
        let fitted = trial.refine(&model, FitAccuracy::Settle);
        match Step::of(&trial, &fitted, suspects) {
            Some(next) if next.misfit < step.misfit => {
                seconds += moved;
                moved = next.seconds;
                (session, model, step) = (trial, fitted, next);
            }
            _ => moved *= 0.5,
        }
    }
    let last = if moved.abs() < step.deviation { moved } else { 0.0 };
    let fault = fault::timed(seconds + last, step.deviation);
    (seconds > 0.0).then_some(Skewed { session, model, fault, price: step.price })
}

/// By how much the response is ahead of what a model predicts, to first order.
struct Step {
    seconds: f64,
    /// Standard deviation, s.
    deviation: f64,
    /// −2 ln likelihood before the step, and by how much the step lowers it.
    misfit: f64,
    gain: f64,
    price: f64,
}

impl Step {
    fn of(session: &FitSession<'_>, model: &Model, suspects: &Suspects<'_>) -> Option<Self> {
        if !model.cost.is_finite() {
            return None;
        }
        let fit = session.judge(model, Intervals::Curvature).ok()?;
        let residuals = Residuals::of(&fit);
        let cells: Vec<&Cell> = residuals.layout.cells.iter().collect();
        let excited = cells.iter().filter(|cell| cell.excited);
        let fastest = excited.map(|cell| cell.frequency_hz).fold(0.0, f64::max);
        // Each cell is one line, so that its frequency is that of the line.
        let turned = |cell: &Cell| Complex::new(0.0, cell.frequency_hz / fastest) * cell.simulated;
        let candidate = Candidate {
            kind: FaultKind::ChannelSkew,
            place: Place::All,
            columns: vec![column(&cells, turned)],
            deviation: Some(PHASE_DEVIATION),
            price: FAULT_COST,
            positive: false,
        };
        let outside = Outside::of(&candidate, &residuals.fitted)?;
        let left = residuals.fitted.complement(&residuals.values);
        let (decrease, values) = outside.best(&left);
        let all = left.norm_squared();
        let scale = if suspects.size_known() { 1.0 } else { all / residuals.dof() };
        let per_angle = 1.0 / (TAU * fastest);
        let misfit = suspects.misfit_of_noise(model.cost);
        Some(Self {
            seconds: per_angle * values[0],
            deviation: per_angle * scale.sqrt() * outside.deviations()[0],
            misfit,
            gain: misfit - suspects.misfit_of_noise(model.cost * (1.0 - decrease / all)),
            price: FAULT_COST + outside.volume(decrease / scale),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{Diagnosis, Verdict};
    use crate::diagnose::fixtures::{multisine_record, plant};
    use crate::identify::IdentifyRequest;
    use crate::machines::simulator::Effect;
    use crate::measurement::Measurement;
    use crate::observer::Silent;

    /// The answer to a record whose response is ahead of its input by a time (s).
    fn answer(effects: &[Effect], seconds: f64) -> Diagnosis {
        let sound = multisine_record(plant(), effects, None, 5);
        let mut experiments = sound.experiments().to_vec();
        for experiment in &mut experiments {
            let turn = |order: usize| {
                Complex::from_polar(1.0, order as f64 * experiment.omega_rad_s * seconds)
            };
            let orders: Vec<usize> = experiment.response.iter().map(|h| h.order).collect();
            experiment.response.iter_mut().for_each(|h| h.value *= turn(h.order));
            for repeat in &mut experiment.repeats {
                let values = repeat.response.iter_mut().zip(&orders);
                values.for_each(|(value, order)| *value *= turn(*order));
            }
        }
        let (metadata, hash) = (sound.metadata().clone(), sound.sha256().to_owned());
        let skewed = Measurement::new(metadata, experiments, Vec::new(), hash).unwrap();
        crate::diagnose::diagnose(&skewed, &IdentifyRequest::default(), &Silent).unwrap()
    }

    fn only_fault(answer: &Diagnosis, seconds: f64) -> bool {
        let [fault] = answer.measurement.as_slice() else { return false };
        // Five standard deviations of the time.
        let [low, high] = fault.interval95.unwrap();
        let near = (fault.value.unwrap() - seconds).abs() < 5.0 / 3.92 * (high - low);
        fault.fault == FaultKind::ChannelSkew && near
    }

    #[test]
    fn a_response_ahead_of_the_input_of_a_record_is_named_with_its_time() {
        for seconds in [1e-3, 1e-2] {
            let found = answer(&[], seconds);
            assert_eq!(found.verdict, Verdict::Adequate, "{:?}", found.measurement);
            assert!(only_fault(&found, seconds), "{:?}", found.measurement);
        }
    }

    #[test]
    fn an_effect_behind_a_response_that_is_ahead_is_named() {
        let found = answer(&[Effect::new("gain_asymmetry", [("gamma", 0.15)])], 3e-3);
        assert!(only_fault(&found, 3e-3), "{:?}", found.measurement);
        assert_eq!(found.causes[0].effect, "gain_asymmetry");
    }

    // That is a delay of the machine.
    #[test]
    fn a_response_that_is_late_is_no_fault() {
        let found = answer(&[], -1e-2);
        assert!(found.measurement.is_empty(), "{:?}", found.measurement);
        assert_eq!(found.causes[0].effect, "transport_delay");
    }
}
