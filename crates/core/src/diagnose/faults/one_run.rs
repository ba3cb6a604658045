//! Another gain or another delay of one experiment of several that are records.
//!
//! A range that was switched between two levels changes the gain from one to the next, and a trigger
//! that came at another time the delay, which looks like an effect that depends on the amplitude. No
//! effect of a machine changes every line of a velocity by one number, or its phase in proportion to the
//! frequency.

use std::ops::Range;

use crate::answers::{FaultKind, MeasurementFault};
use crate::measurement::Experiment;

use crate::diagnose::residuals::layout::Cell;

use super::beside::OneNumber;
use super::candidates::{self, Candidate, FAULT_COST, PHASE_DEVIATION, Place};
use super::fault;

/// What differs in an experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum What {
    /// The gain; the number is its logarithm.
    Gain,
    /// The phase, in proportion to the frequency; the number is that of the first line, rad.
    Phase,
}

/// Another gain or phase of one experiment.
pub(super) struct OneRun {
    what: What,
    /// Index of the experiment.
    experiment: usize,
    /// Number of experiments that it may be.
    among: usize,
}

impl OneRun {
    /// Another gain of every experiment of several. Of two, which is wrong cannot be told: the second.
    pub fn gains(experiments: &[Experiment]) -> Vec<Self> {
        match experiments.len() {
            0 | 1 => Vec::new(),
            2 => Self::among(What::Gain, 1..2),
            count => Self::among(What::Gain, 0..count),
        }
    }

    /// Another phase of every experiment of several. Which of two is late can be told, as a machine is late
    /// in both.
    pub fn phases(experiments: &[Experiment]) -> Vec<Self> {
        match experiments.len() {
            0 | 1 => Vec::new(),
            count => Self::among(What::Phase, 0..count),
        }
    }

    fn among(what: What, all: Range<usize>) -> Vec<Self> {
        let among = all.len();
        all.map(|experiment| Self { what, experiment, among }).collect()
    }
}

impl OneNumber for OneRun {
    fn candidate(&self, cells: &[&Cell]) -> Candidate {
        let own = cells.iter().filter(|cell| cell.experiment == self.experiment);
        let own: Vec<&Cell> = own.copied().collect();
        let place = Place::Run(self.experiment);
        let price = FAULT_COST + 2.0 * (self.among as f64).ln();
        match self.what {
            What::Gain => candidates::gain(FaultKind::RunGain, place, &own, price),
            What::Phase => {
                let excited = own.iter().filter(|cell| cell.excited);
                let fastest = excited.map(|cell| cell.order).max().unwrap_or(1).max(1);
                let phase = candidates::phase(FaultKind::RunPhase, place, &own, price);
                Candidate { deviation: Some(PHASE_DEVIATION / fastest as f64), ..phase }
            }
        }
    }

    fn fault(&self, number: f64, deviation: f64) -> MeasurementFault {
        let fault = match self.what {
            What::Gain => {
                fault::sized(FaultKind::RunGain, number.exp_m1(), number.exp() * deviation)
            }
            What::Phase => fault::sized(FaultKind::RunPhase, number, deviation),
        };
        MeasurementFault { experiment: Some(self.experiment), ..fault }
    }
}

#[cfg(test)]
mod tests {
    use crate::answers::{Diagnosis, FaultKind, Verdict};
    use crate::diagnose::fixtures::{multiplied, two_levels};
    use crate::identify::IdentifyRequest;
    use crate::machines::simulator::Effect;
    use crate::measurement::Complex;
    use crate::observer::Silent;

    fn answer(effects: &[Effect], gain: f64) -> Diagnosis {
        let gains = [1.0, gain];
        let measurement = multiplied(&two_levels(effects, 8), |level, _| gains[level].into());
        crate::diagnose::diagnose(&measurement, &IdentifyRequest::default(), &Silent).unwrap()
    }

    fn only_fault(answer: &Diagnosis, gain: f64) -> bool {
        let [fault] = answer.measurement.as_slice() else { return false };
        // Five standard deviations of the gain.
        let [low, high] = fault.interval95.unwrap();
        let near = (fault.value.unwrap() - gain).abs() < 5.0 / 3.92 * (high - low);
        fault.fault == FaultKind::RunGain && fault.experiment == Some(1) && near
    }

    #[test]
    fn another_gain_at_one_level_of_a_record_is_named_with_its_size() {
        // With the first, the base model is so far off that all lines are weighed alike first.
        for gain in [0.5, 0.8, 1.05] {
            let found = answer(&[], gain);
            assert_eq!(found.verdict, Verdict::Adequate, "{:?}", found.measurement);
            assert!(only_fault(&found, gain), "{:?}", found.measurement);
            let said = &found.measurement[0].sentence;
            assert!(said.starts_with("in experiment 2 the response is"), "{said}");
        }
    }

    // The phases of lines two apart turn by twice the angle of the first.
    #[test]
    fn another_delay_at_one_level_of_a_record_is_named_with_the_phase_of_its_first_line() {
        let sound = two_levels(&[], 8);
        let omega_rad_s = sound.experiments()[1].omega_rad_s;
        let measurement = multiplied(&sound, |level, omega| match level {
            1 => Complex::from_polar(1.0, 0.01 * omega / omega_rad_s),
            _ => Complex::ONE,
        });
        let request = IdentifyRequest::default();
        let found = crate::diagnose::diagnose(&measurement, &request, &Silent).unwrap();
        let [fault] = found.measurement.as_slice() else { panic!("{:?}", found.measurement) };
        assert_eq!((fault.fault, fault.experiment), (FaultKind::RunPhase, Some(1)));
        let [low, high] = fault.interval95.unwrap();
        // Five standard deviations of the angle.
        let off = fault.value.unwrap() - 0.01_f64.to_degrees();
        assert!(off.abs() < 5.0 / 3.92 * (high - low), "{fault:?}");
        assert_eq!(found.verdict, Verdict::Adequate);
    }

    #[test]
    fn an_effect_behind_another_gain_at_one_level_is_named() {
        let found = answer(&[Effect::new("gain_asymmetry", [("gamma", 0.15)])], 1.1);
        assert!(only_fault(&found, 1.1), "{:?}", found.measurement);
        assert_eq!(found.causes[0].effect, "gain_asymmetry");
    }

    #[test]
    fn an_effect_that_depends_on_the_amplitude_is_no_gain() {
        let found = answer(&[Effect::new("quadratic_drag", [("c", 0.5)])], 1.0);
        assert!(found.measurement.is_empty(), "{:?}", found.measurement);
        assert_eq!(found.causes[0].effect, "quadratic_drag");
    }
}
