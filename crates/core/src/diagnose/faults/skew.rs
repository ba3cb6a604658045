//! A record whose response is ahead of its input.
//!
//! A logger that writes the input a sample late makes the response lead it, as no machine does. Where
//! the response is late instead, that is a delay of the machine.

use std::f64::consts::TAU;

use crate::answers::{FaultKind, MeasurementFault};
use crate::measurement::Complex;

use crate::diagnose::residuals::layout::Cell;

use super::beside::OneNumber;
use super::candidates::{Candidate, FAULT_COST, PHASE_DEVIATION, Place, column};
use super::fault;

/// A response that is ahead by a time, s.
pub(super) struct Skew;

impl OneNumber for Skew {
    fn candidate(&self, cells: &[&Cell]) -> Candidate {
        let excited = cells.iter().filter(|cell| cell.excited);
        let fastest = TAU * excited.map(|cell| cell.frequency_hz).fold(0.0, f64::max);
        // Each cell is one line, so that its frequency is that of the line.
        let turned = |cell: &Cell| Complex::new(0.0, TAU * cell.frequency_hz) * cell.simulated;
        Candidate {
            kind: FaultKind::ChannelSkew,
            place: Place::All,
            columns: vec![column(cells, turned)],
            deviation: Some(PHASE_DEVIATION / fastest),
            price: FAULT_COST,
            positive: true,
        }
    }

    fn fault(&self, seconds: f64, deviation: f64) -> MeasurementFault {
        fault::timed(seconds, deviation)
    }
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
