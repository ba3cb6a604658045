use super::*;
use crate::effects::{ActiveEffect, enter_values, find};
use crate::plant::{Friction, Plant};
use crate::simulate::base::spectrum::weight;

fn bent(actuator: Actuator, omega: f64) -> BentCosine<f64> {
    let plant = Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator,
        friction: Friction::coulomb(0.5, 0.4),
    };
    let effects =
        [("actuator_dead_zone", 0.4), ("gain_asymmetry", 0.2), ("actuator_saturation", 1.5)];
    let active =
        effects.map(|(id, value)| ActiveEffect::new(find(id).unwrap(), vec![value]).unwrap());
    let axis = enter_values(plant, &active, 0.0);
    BentCosine::new(&axis, &Excitation::cosine(omega, 2.0))
}

fn actuators() -> Vec<Actuator> {
    let first = [7.0, 10.0, 10.0 * (1.0 + 1e-5), 700.0];
    let second = [(20.0, 0.1), (20.0, 1.0), (10.0, 1.0), (20.0, 4.0)];
    let second_order = |(natural_frequency_rad_s, damping_ratio)| Actuator::SecondOrder {
        natural_frequency_rad_s,
        damping_ratio,
    };
    std::iter::once(Actuator::Direct)
        .chain(first.map(|corner_rad_s| Actuator::FirstOrder { corner_rad_s }))
        .chain(second.map(second_order))
        .collect()
}

/// What two modes lose that are one: they are taken 2e-8 of their square apart.
fn apart(actuator: Actuator) -> f64 {
    match actuator {
        Actuator::SecondOrder { damping_ratio: 1.0, .. } => 1e-7,
        _ => 0.0,
    }
}

/// Harmonic k of a signal by Simpson's rule, piece by piece.
fn harmonic(bent: &BentCosine<f64>, k: usize, part: impl Fn(Signals<f64>) -> f64) -> Complex {
    let count = 2000;
    let mut sum = Complex::new(0.0, 0.0);
    for piece in &bent.pieces {
        let h = piece.length_s / count as f64;
        for n in 0..=count {
            let t = piece.from_s + n as f64 * h;
            let share = match n {
                0 => 1.0,
                n if n == count => 1.0,
                n if n % 2 == 1 => 4.0,
                _ => 2.0,
            };
            let turn = Complex::from_polar(1.0, -(k as f64) * bent.omega * t);
            sum += part(bent.at(piece, t)) * turn * (share * h / 3.0);
        }
    }
    sum * weight(k, bent.period_s())
}

#[test]
fn torque_and_steady_response_have_the_harmonics_of_the_filtered_input() {
    for actuator in actuators() {
        let bent = bent(actuator, 3.0);
        let apart = apart(actuator);
        assert_eq!(bent.pieces.len(), 8);
        let mut whole = vec![ComplexDual::real(0.0); 6];
        bent.add_integrals((0.0, bent.period_s()), &mut whole);
        for (k, line) in bent.lines(5).into_iter().enumerate() {
            let line = line.value();
            // Simpson's rule on steps of a thousandth of what changes fastest.
            let torque = harmonic(&bent, k, |signals| signals.torque);
            assert!((torque - line).norm() < 1e-8 + apart, "{actuator:?} {k}: {torque} {line}");
            let integral = whole[k].value() * weight(k, bent.period_s());
            assert!(
                (integral - line).norm() < 1e-12 + apart,
                "{actuator:?} {k}: {integral} {line}"
            );
            let steady = harmonic(&bent, k, |signals| signals.steady);
            let expected = line / Complex::new(10.0, 3.0 * k as f64);
            assert!(
                (steady - expected).norm() < 1e-9 + apart,
                "{actuator:?} {k}: {steady} {expected}"
            );
        }
    }
}

#[test]
fn pieces_meet_and_the_rate_is_that_of_the_torque() {
    for actuator in actuators() {
        let bent = bent(actuator, 11.0);
        let count = bent.pieces.len();
        for (i, piece) in bent.pieces.iter().enumerate() {
            let next = &bent.pieces[(i + 1) % count];
            let (end, start) = (bent.at(piece, piece.end_s()), bent.at(next, next.from_s));
            let apart = apart(actuator);
            assert!((end.torque - start.torque).abs() < 1e-12 + apart, "{actuator:?} {i}");
            assert!((end.steady - start.steady).abs() < 1e-13 + apart, "{actuator:?} {i}");
            let (middle, step) = (piece.from_s + 0.3 * piece.length_s, 1e-6);
            let by = |at: f64| bent.at(piece, middle + at).torque;
            // Central differences: rounding over the step, and its square.
            let slope = (by(step) - by(-step)) / (2.0 * step);
            let rate = bent.at(piece, middle).rate;
            assert!((slope - rate).abs() < 1e-6, "{actuator:?} {i}: {slope} {rate}");
        }
    }
}
