//! Whether a driven axis takes power and its velocity lags, as they must.
//!
//! Friction takes power from the input, and inertia, springs and play take none on average. So the mean
//! of input times velocity is positive, unless an actuator delays most of the input by more than a
//! quarter of a period, and then the velocity lags the more. With the wrong sign of the response the mean
//! is negative, and inertia makes the velocity lead. In a position loop this tells where the size of the
//! residual does not: there an effect with absurd parameters follows most of a response of the wrong
//! sign.

use crate::measurement::{Complex, Experiment, Measurement, ResponseKind};

/// Whether, over all lines, the axis gives power and its velocity leads.
pub(super) fn is_reversed(measurement: &Measurement) -> bool {
    let kind = measurement.metadata().response_kind;
    let experiments = measurement.experiments().iter();
    let power: Complex = experiments.map(|experiment| power(experiment, kind)).sum();
    power.re < 0.0 && power.im > 0.0
}

/// Complex power that the input brings in, without the means: ½ Σ V U*, whose argument is that of the
/// velocity.
fn power(experiment: &Experiment, kind: ResponseKind) -> Complex {
    let lines = experiment.response.iter().filter(|harmonic| harmonic.order > 0);
    let of_line = lines.map(|harmonic| {
        let derivative = Complex::new(0.0, harmonic.order as f64 * experiment.omega_rad_s);
        let velocity = match kind {
            ResponseKind::Position => harmonic.value * derivative,
            ResponseKind::Velocity => harmonic.value,
            ResponseKind::Acceleration => harmonic.value / derivative,
        };
        let input = experiment.input.get(harmonic.order).copied().unwrap_or_default();
        0.5 * velocity * input.conj()
    });
    of_line.sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::fixtures::{multiplied, multisine_record_of, plant};
    use crate::plant::{Actuator, Friction, Plant};

    #[test]
    fn an_axis_takes_power_and_lags_and_with_the_wrong_sign_it_would_give_some_and_lead() {
        for kind in [ResponseKind::Velocity, ResponseKind::Position] {
            let measurement = multisine_record_of(kind, plant(), &[], None, 3);
            assert!(!is_reversed(&measurement), "{kind:?}");
            let reversed = multiplied(&measurement, |_, _| -Complex::ONE);
            assert!(is_reversed(&reversed), "{kind:?}");
        }
    }

    #[test]
    fn a_slow_actuator_makes_no_wrong_sign() {
        let actuator = Actuator::SecondOrder { natural_frequency_rad_s: 3.0, damping_ratio: 0.3 };
        let slow = Plant { actuator, friction: Friction::coulomb(0.01, 0.01), ..plant() };
        let measurement = multisine_record_of(ResponseKind::Velocity, slow, &[], None, 3);
        let power = power(&measurement.experiments()[0], ResponseKind::Velocity);
        assert!(power.re < 0.0 && !is_reversed(&measurement), "{power}");
    }
}
