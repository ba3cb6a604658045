//! A record whose response is ahead of its input.
//!
//! A logger that writes the input a sample late makes the response lead it, as no machine does. Where
//! the response is late instead, that is a delay of the machine.

use std::f64::consts::TAU;

use crate::answers::{FaultKind, MeasurementFault, PlantRequest};
use crate::identify::{FitSession, IdentifyRequest, Intervals};
use crate::measurement::{Complex, Measurement};
use crate::observer::Observer;

use crate::diagnose::residuals::layout::Cell;
use crate::diagnose::selection::evidence::NoiseScale;
use crate::diagnose::selection::models::Models;

use super::beside::{self, OneNumber};
use super::candidates::{Candidate, FAULT_COST, PHASE_DEVIATION, Place, column};
use super::fault;
use super::suspects::Suspects;

/// −2 ln evidence that a correction of a lead costs, whose prior odds and volume are paid for: one by less
/// than two standard deviations is none.
const CORRECTION_COST: f64 = 4.0;

/// A response that is ahead by a time, s.
pub(super) struct Skew {
    /// By how much more it was ahead before that was mended, s.
    pub mended_s: f64,
}

impl OneNumber for Skew {
    fn candidate(&self, cells: &[&Cell]) -> Candidate {
        let excited = cells.iter().filter(|cell| cell.excited);
        let fastest = TAU * excited.map(|cell| cell.frequency_hz).fold(0.0, f64::max);
        // Each cell is one line, so that its frequency is that of the line.
        let turned = |cell: &Cell| Complex::new(0.0, TAU * cell.frequency_hz) * cell.simulated;
        let is_new = self.mended_s == 0.0;
        Candidate {
            kind: FaultKind::ChannelSkew,
            place: Place::All,
            columns: vec![column(cells, turned)],
            deviation: is_new.then_some(PHASE_DEVIATION / fastest),
            price: if is_new { FAULT_COST } else { CORRECTION_COST },
            // What was mended may have been too much.
            positive: is_new,
        }
    }

    fn fault(&self, seconds: f64, deviation: f64) -> MeasurementFault {
        fault::timed(seconds, deviation)
    }

    fn least(&self) -> f64 {
        -self.mended_s
    }
}

/// The lead that these faults have, s; 0 without any.
pub(super) fn lead_s(faults: &[MeasurementFault]) -> f64 {
    let leads = faults.iter().filter(|fault| fault.fault == FaultKind::ChannelSkew);
    leads.filter_map(|fault| fault.value).sum()
}

/// The lead beside the base model with an actuator of this order, if it explains more of a record than all
/// that is left of it beyond noise. Effects that belong beside it may never have been fitted well: without
/// it they have other values.
pub(super) fn beside_the_base_model(
    measurement: &Measurement,
    actuator_order: u8,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Option<MeasurementFault> {
    if !measurement.experiments().iter().all(|experiment| experiment.from_record) {
        return None;
    }
    let plant = Some(PlantRequest { actuator_order });
    let request = IdentifyRequest { plant, ..*request };
    let session = FitSession::new(measurement, &request, observer).ok()?;
    if !session.noise_known() {
        return None;
    }
    let alone = session.base();
    let base = session.judge(alone, Intervals::Curvature).ok()?;
    let models = Models::new(alone.clone(), NoiseScale::of(&session));
    let seed = request.options.seed;
    let (session, base, models) = (&session, &base, &models);
    let suspects = Suspects { session, base, models, combined: false, seed, lead_s: 0.0 };
    let least = suspects.misfit_of_noise(alone.cost);
    let found = beside::best(&suspects, alone, least, &[Skew { mended_s: 0.0 }])?;
    let beyond_noise = found.model.cost - suspects.dof();
    (beyond_noise < alone.cost - found.model.cost).then_some(found.fault)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{Diagnosis, Verdict};
    use crate::diagnose::fixtures::{multiplied, multisine_record, plant};
    use crate::identify::IdentifyRequest;
    use crate::machines::simulator::Effect;
    use crate::observer::Silent;
    use crate::plant::Actuator;

    /// The answer to a record whose response is ahead of its input by a time (s).
    fn answer(effects: &[Effect], seconds: f64) -> Diagnosis {
        let sound = multisine_record(plant(), effects, None, 5);
        let skewed =
            multiplied(&sound, |_, omega_rad_s| Complex::from_polar(1.0, omega_rad_s * seconds));
        crate::diagnose::diagnose(&skewed, &IdentifyRequest::default(), &Silent).unwrap()
    }

    /// Whether the lead is the only fault. Of a lead and the lag of the actuator the data show little
    /// more than the difference.
    fn only_fault(answer: &Diagnosis, seconds: f64) -> bool {
        let [fault] = answer.measurement.as_slice() else { return false };
        let model = answer.extended.as_ref().unwrap_or(&answer.base);
        let lag = |[re, im]: [f64; 2]| -re / (re * re + im * im);
        let Actuator::FirstOrder { corner_rad_s } = plant().actuator else { unreachable!() };
        let true_lag = 1.0 / corner_rad_s;
        let of_axis = lag([model.parameters["pole"].value.unwrap(), 0.0]);
        let of_both: f64 = model.transfer_function.poles.iter().copied().map(lag).sum();
        let lead = fault.value.unwrap() - (of_both - of_axis - true_lag);
        // Five standard deviations of the time.
        let [low, high] = fault.interval95.unwrap();
        let near = (lead - seconds).abs() < 5.0 / 3.92 * (high - low);
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
