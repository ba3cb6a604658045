//! Whether a driven axis takes power, as one must.
//!
//! Friction takes power from the input, and inertia, springs and play take none on average. So the mean
//! of input times velocity is positive, unless an actuator delays most of the input by more than a
//! quarter of a period; with the wrong sign of the response it is negative. In a position loop this tells
//! where the size of the residual does not: there an effect with absurd parameters follows most of
//! a response of the wrong sign.

use crate::measurement::{Complex, Experiment, Measurement, ResponseKind};

/// Whether the input takes power from the axis, over all lines.
pub(super) fn is_negative(measurement: &Measurement) -> bool {
    let kind = measurement.metadata().response_kind;
    measurement.experiments().iter().map(|experiment| power(experiment, kind)).sum::<f64>() < 0.0
}

/// Mean of input times velocity, without their means: ½ Σ Re(U V*).
fn power(experiment: &Experiment, kind: ResponseKind) -> f64 {
    let lines = experiment.response.iter().filter(|harmonic| harmonic.order > 0);
    let of_line = lines.map(|harmonic| {
        let derivative = Complex::new(0.0, harmonic.order as f64 * experiment.omega_rad_s);
        let velocity = match kind {
            ResponseKind::Position => harmonic.value * derivative,
            ResponseKind::Velocity => harmonic.value,
            ResponseKind::Acceleration => harmonic.value / derivative,
        };
        let input = experiment.input.get(harmonic.order).copied().unwrap_or_default();
        0.5 * (input * velocity.conj()).re
    });
    of_line.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::fixtures::{multisine_record_of, plant};
    use crate::measurement::Harmonic;

    #[test]
    fn an_axis_takes_power_and_with_the_wrong_sign_it_would_give_some() {
        let kinds = [ResponseKind::Velocity, ResponseKind::Position, ResponseKind::Acceleration];
        for kind in kinds {
            let measurement = multisine_record_of(kind, plant(), &[], None, 3);
            assert!(!is_negative(&measurement), "{kind:?}");
            let reversed = |harmonic: &Harmonic| Harmonic { value: -harmonic.value, ..*harmonic };
            let mut experiments = measurement.experiments().to_vec();
            let response = &mut experiments[0].response;
            *response = response.iter().map(reversed).collect();
            let metadata = measurement.metadata().clone();
            let reversed =
                Measurement::new(metadata, experiments, Vec::new(), String::new()).unwrap();
            assert!(is_negative(&reversed), "{kind:?}");
        }
    }
}
