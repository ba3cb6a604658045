use super::*;
use crate::effects::{ActiveEffect, enter_values, find};
use crate::plant::Friction;
use crate::simulate::piecewise_linear::stick_slip_periodic;

const EFFECTS: [(&str, f64); 3] =
    [("actuator_dead_zone", 0.3), ("gain_asymmetry", 0.15), ("actuator_saturation", 1.4)];

fn plants() -> Vec<Plant> {
    let actuators = [
        Actuator::Direct,
        Actuator::FirstOrder { corner_rad_s: 10.0 },
        Actuator::SecondOrder { natural_frequency_rad_s: 31.6, damping_ratio: 0.1 },
        Actuator::SecondOrder { natural_frequency_rad_s: 40.0, damping_ratio: 1.3 },
    ];
    let frictions = [
        Friction::coulomb(0.5, 0.4),
        Friction { fc_plus: 0.5, fc_minus: 0.4, fs_plus: 0.7, fs_minus: 0.6 },
    ];
    let plant = |actuator| {
        frictions.map(|friction| Plant {
            viscous_rate_rad_s: 10.0,
            constant: 10.0,
            actuator,
            friction,
        })
    };
    actuators.into_iter().flat_map(plant).collect()
}

fn active() -> Vec<ActiveEffect> {
    let effect =
        |(id, value): (&str, f64)| ActiveEffect::new(find(id).unwrap(), vec![value]).unwrap();
    EFFECTS.map(effect).to_vec()
}

/// Inputs of any phase, from an axis that hardly moves to one that hardly rests.
fn inputs() -> impl Iterator<Item = Excitation> {
    let magnitudes = [0.6, 1.1, 2.5];
    magnitudes.into_iter().flat_map(|magnitude| {
        [0.8, 6.0, 45.0].map(|omega| {
            let line = Complex::from_polar(magnitude, magnitude * omega);
            Excitation::new(omega, vec![Complex::new(0.0, 0.0), line])
        })
    })
}

#[test]
fn the_closed_form_agrees_with_a_wave_of_quintics() {
    let mut moving = 0;
    for plant in plants() {
        let axis = enter_values(plant, &active(), 0.0);
        for excitation in inputs() {
            assert!(applies(&axis, &excitation));
            let found = respond(&axis, &excitation, 7).unwrap();
            let wave = stick_slip_periodic::respond(&axis, &excitation, 7).unwrap();
            moving += usize::from(found[1].norm() > 0.0);
            for (k, (closed, quintics)) in found.iter().zip(&wave).enumerate() {
                // The quintics follow what a kink excites to 1e-5 of it, and v
                // is of the size of u.
                let error = (closed - quintics).norm();
                assert!(error < 2e-5, "{plant:?} {excitation:?} {k}: {error:e}");
            }
        }
    }
    assert!(moving > 40, "{moving}");
}

#[test]
fn derivatives_agree_with_finite_differences() {
    for plant in plants() {
        for excitation in inputs() {
            let mut values: Vec<f64> = Vec::new();
            let mut variable = |value: f64| {
                values.push(value);
                Wide::variable(value, values.len() - 1)
            };
            let wide = plant.map(&mut variable);
            let first_effect = values.len();
            values.extend(EFFECTS.map(|(_, value)| value));
            let rows = values.len();
            let axis = crate::effects::enter(wide, &active(), 0.0, first_effect);
            let base = axis.map(Scalar::value);
            let (velocity, sensitivities) =
                differentiate(&axis, &base, &excitation, 5, rows).unwrap();
            for (row, derivatives) in sensitivities.iter().enumerate() {
                let step = 1e-6 * values[row].abs();
                let moved = |by: f64| {
                    let along = |x: Wide| x.value() + by * x.lane(row);
                    respond(&axis.map(along), &excitation, 5).unwrap()
                };
                let (up, down) = (moved(step), moved(-step));
                for k in 0..=5 {
                    let numeric = (up[k] - down[k]) / (2.0 * step);
                    let size = 1.0 + derivatives[k].norm() + velocity[1].norm();
                    // Central differences: rounding over the step.
                    let error = (numeric - derivatives[k]).norm();
                    assert!(error < 1e-5 * size, "{plant:?} {excitation:?} {row} {k}: {error:e}");
                }
            }
        }
    }
}
