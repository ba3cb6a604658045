//! Whether an estimated initial state is plausible, beside what the first samples show.

use crate::identify::transient_prediction::Model;
use crate::identify::transient_prediction::first_samples::at_first;
use crate::measurement::{ResponseKind, Transient};
use crate::simulate::{Quantity, Unknown};

/// An estimated initial velocity is implausible if it differs from that of the first samples by
/// more than this share of the rms velocity (tuned) and [`VELOCITY_ERRORS`].
const VELOCITY_TOLERANCE: f64 = 0.1;

/// Standard errors of the velocity of the first samples that are tolerated besides: normal noise
/// exceeds them in 6 of 100 000 motions.
const VELOCITY_ERRORS: f64 = 4.0;

/// The velocity that the first samples show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FirstVelocity {
    /// Its value at the first sample.
    pub(super) value: f64,
    /// Its standard error.
    std: f64,
    /// The rms velocity of the whole motion.
    usual: f64,
}

impl Model<'_> {
    /// The velocity with which the motion begins; `None` for an acceleration, from which it cannot
    /// be read.
    pub(super) fn first_velocity(&self, count: usize) -> Option<FirstVelocity> {
        let Transient { output, step_s, .. } = self.transient;
        let early = &output[..(count / 20).clamp(4, 50).min(output.len())];
        let rms = |squares: f64, count: usize| (squares / count.max(1) as f64).sqrt();
        match self.kind {
            ResponseKind::Velocity => {
                let [value, std] = at_first(early, 0);
                let usual = rms(output.iter().map(|v| v * v).sum(), output.len());
                Some(FirstVelocity { value, std, usual })
            }
            ResponseKind::Position => {
                // Take differences over the same span as the slope, so that noise does not dominate
                // them.
                let apart = early.len() - 1;
                let steps = output.iter().zip(&output[apart..]);
                let squares = steps.map(|(a, b)| ((b - a) / (apart as f64 * step_s)).powi(2));
                let usual = rms(squares.sum(), output.len() - apart);
                let [value, std] = at_first(early, 1).map(|per_step| per_step / step_s);
                Some(FirstVelocity { value, std, usual })
            }
            ResponseKind::Acceleration => None,
        }
    }

    /// Why this initial value of an unknown is implausible; `None` if it is plausible.
    pub(super) fn implausible(
        &self,
        unknown: &Unknown,
        value: f64,
        shown: Option<FirstVelocity>,
    ) -> Option<String> {
        let Unknown { quantity, at_rest, size } = *unknown;
        if (value - at_rest).abs() > size {
            return Some(format!(
                "it is larger than {size:.4}, the most that the largest input can \
                                 cause"
            ));
        }
        let shown = shown.filter(|_| quantity == Quantity::Velocity)?;
        let FirstVelocity { value: first, std, usual } = shown;
        let tolerance = VELOCITY_TOLERANCE * usual + VELOCITY_ERRORS * std;
        ((value - first).abs() > tolerance).then(|| {
            format!("the first samples show {first:.4}, with {usual:.4} rms over the motion")
        })
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::identify::fixtures::{ACTUATORS, axis};

    // A velocity of 0.1 for 200 samples, sampled every 0.01 s.
    #[test]
    fn a_beginning_is_implausible_beyond_the_reach_of_the_input_or_far_from_the_first_samples() {
        let transient = Transient {
            step_s: 0.01,
            input: vec![1.0; 200],
            output: vec![0.1; 200],
            ..Transient::default()
        };
        let plant = axis(ACTUATORS[0]);
        let kind = ResponseKind::Velocity;
        let model =
            Model { plant: &plant, effects: &[], run_share: 0.0, kind, transient: &transient };
        let shown = model.first_velocity(100);
        let is_steady = |shown: FirstVelocity| {
            (shown.value - 0.1).abs() + (shown.usual - 0.1).abs() + shown.std < 1e-12
        };
        assert!(is_steady(shown.unwrap()), "{shown:?}");
        let velocity = Unknown { quantity: Quantity::Velocity, at_rest: 0.0, size: 1.0 };
        assert_eq!(model.implausible(&velocity, 0.105, shown), None);
        assert!(model.implausible(&velocity, 0.2, shown).unwrap().contains("show 0.1000"));
        assert!(model.implausible(&velocity, -1.2, shown).unwrap().contains("larger than 1.0000"));
        let torque = Unknown { quantity: Quantity::Torque, at_rest: 1.0, size: 2.0 };
        assert_eq!(model.implausible(&torque, 2.9, shown), None);
        assert!(model.implausible(&torque, 3.1, shown).is_some());

        // The same motion as a position, which rises by 0.001 per step.
        let output = (0..200).map(|n| 0.001 * f64::from(n)).collect();
        let transient = Transient { output, ..transient.clone() };
        let position = Model { kind: ResponseKind::Position, transient: &transient, ..model };
        let shown = position.first_velocity(100).unwrap();
        assert!(is_steady(shown), "{shown:?}");
    }

    // v = sin(8t + 0.4), sampled every 2 ms: it begins at 0.389, and 50 samples have a mean of 0.70.
    #[test]
    fn an_axis_that_accelerates_begins_with_the_velocity_of_its_first_sample() {
        let angle = |n: i32| 0.016 * f64::from(n) + 0.4;
        let noise = |n: i32| 1e-3 * f64::from((n * 7919) % 101 - 50) / 50.0;
        let plant = axis(ACTUATORS[0]);
        let velocities = (0..1500).map(|n| angle(n).sin() + 10.0 * noise(n)).collect();
        let positions = (0..1500).map(|n| 0.1 * noise(n) - angle(n).cos() / 8.0).collect();
        for (kind, output) in
            [(ResponseKind::Velocity, velocities), (ResponseKind::Position, positions)]
        {
            let transient =
                Transient { step_s: 0.002, input: vec![1.0; 1500], output, ..Transient::default() };
            let model =
                Model { plant: &plant, effects: &[], run_share: 0.0, kind, transient: &transient };
            let shown = model.first_velocity(1500);
            let velocity = Unknown { quantity: Quantity::Velocity, at_rest: 0.0, size: 2.0 };
            assert_eq!(model.implausible(&velocity, 0.389, shown), None, "{shown:?}");
            assert!(model.implausible(&velocity, 0.7, shown).is_some(), "{shown:?}");
        }
    }
}
