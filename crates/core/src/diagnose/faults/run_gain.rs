//! Another gain of one experiment of several that are records.
//!
//! A range that was switched between two levels changes the gain from one to the next, which looks like
//! an effect that depends on the amplitude. No effect of a machine changes every line of a velocity by
//! one number.

use crate::answers::{FaultKind, MeasurementFault};
use crate::measurement::Experiment;

use crate::diagnose::residuals::layout::Cell;

use super::beside::OneNumber;
use super::candidates::{self, Candidate, FAULT_COST, Place};
use super::fault;

/// Another gain of one experiment; the number is its logarithm.
pub(super) struct RunGain {
    /// Index of the experiment.
    experiment: usize,
    /// Number of experiments that it may be.
    among: usize,
}

impl RunGain {
    /// That of every experiment of several. Of two, which is wrong cannot be told: the second.
    pub fn each(experiments: &[Experiment]) -> Vec<Self> {
        let all = match experiments.len() {
            0 | 1 => 0..0,
            2 => 1..2,
            count => 0..count,
        };
        let among = all.len();
        all.map(|experiment| Self { experiment, among }).collect()
    }
}

impl OneNumber for RunGain {
    fn candidate(&self, cells: &[&Cell]) -> Candidate {
        let own = cells.iter().filter(|cell| cell.experiment == self.experiment);
        let own: Vec<&Cell> = own.copied().collect();
        let price = FAULT_COST + 2.0 * (self.among as f64).ln();
        candidates::gain(FaultKind::RunGain, Place::Run(self.experiment), &own, price)
    }

    fn fault(&self, log_gain: f64, deviation: f64) -> MeasurementFault {
        let fault = fault::sized(FaultKind::RunGain, log_gain.exp_m1(), log_gain.exp() * deviation);
        MeasurementFault { experiment: Some(self.experiment), ..fault }
    }
}

#[cfg(test)]
mod tests {
    use crate::answers::{Diagnosis, FaultKind, Verdict};
    use crate::diagnose::fixtures::{multiplied, two_levels};
    use crate::identify::IdentifyRequest;
    use crate::machines::simulator::Effect;
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
