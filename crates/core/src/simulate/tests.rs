use super::*;
use crate::plant::{Actuator, Friction};

mod sensitivities;
mod with_effects;

fn plant(actuator: Actuator, friction: Friction) -> Plant {
    Plant { viscous_rate_rad_s: 10.0, constant: 10.0, actuator, friction }
}

const RESONANT: Actuator =
    Actuator::SecondOrder { natural_frequency_rad_s: 31.6, damping_ratio: 0.08 };

/// A cosine with a tiny mean, which sends it through the code for general inputs.
fn as_general(omega: f64, magnitude: f64) -> Excitation {
    let tiny = Complex::new(f64::MIN_POSITIVE, 0.0);
    Excitation::new(omega, vec![tiny, Complex::new(magnitude, 0.0)])
}

fn largest_difference(left: &[Complex], right: &[Complex]) -> f64 {
    left.iter().zip(right).map(|(l, r)| (l - r).norm()).fold(0.0, f64::max)
}

#[test]
fn the_two_paths_agree_on_a_cosine() {
    let frictions = [
        Friction::coulomb(0.5, 0.4),
        Friction::coulomb(0.0, 0.0),
        Friction::coulomb(0.9, 0.2),
        Friction { fc_plus: 0.5, fc_minus: 0.4, fs_plus: 0.8, fs_minus: 0.6 },
    ];
    for friction in frictions {
        for actuator in [Actuator::Direct, RESONANT] {
            for omega in [0.5, 3.0, 17.0, 60.0] {
                for magnitude in [0.7, 1.0, 1.7, 4.0] {
                    let plant = plant(actuator, friction);
                    let exact =
                        respond(&plant, &[], &Excitation::cosine(omega, magnitude), 9).unwrap();
                    let general = respond(&plant, &[], &as_general(omega, magnitude), 9).unwrap();
                    // The general code interpolates w on 1024 samples: error (2π/1024)⁶/46080 of w.
                    let difference = largest_difference(&exact, &general);
                    assert!(
                        difference < 1e-9,
                        "{friction:?} {actuator:?} ω {omega} m {magnitude}: {difference:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn an_axis_below_its_static_level_rests() {
    let plant = plant(Actuator::Direct, Friction::coulomb(0.5, 0.4));
    let response = respond(&plant, &[], &Excitation::cosine(3.0, 0.4), 5).unwrap();
    assert!(response.iter().all(|v| v.norm() == 0.0));
}

#[test]
fn a_torque_above_one_level_only_moves_the_axis_one_way() {
    let plant = plant(Actuator::Direct, Friction::coulomb(0.5, 0.4));
    let orbit = orbit(&plant, &Excitation::cosine(3.0, 0.45)).unwrap();
    let motions: Vec<Motion> = orbit.phases.iter().map(|phase| phase.motion).collect();
    assert_eq!(motions, [Motion::Backward, Motion::Stuck]);
}

#[test]
fn a_large_mean_torque_keeps_the_axis_moving() {
    let plant = plant(Actuator::Direct, Friction::coulomb(0.5, 0.4));
    let excitation = Excitation::new(3.0, vec![Complex::new(3.0, 0.0), Complex::new(1.0, 0.0)]);
    let velocity = respond(&plant, &[], &excitation, 3).unwrap();
    // The axis never reverses: it is linear, with its mean torque reduced by Fc⁺.
    let expected = plant.mechanics_response(3.0);
    assert!((velocity[0].re - 2.5).abs() < 1e-12);
    assert!((velocity[1] - expected).norm() < 1e-12);
    assert!(velocity[2].norm() < 1e-12);
}

#[test]
fn without_friction_the_response_is_the_transfer_function() {
    let plant = plant(RESONANT, Friction::coulomb(0.0, 0.0));
    let velocity = respond(&plant, &[], &Excitation::cosine(20.0, 2.0), 3).unwrap();
    let expected = 2.0 * plant.mechanics_response(20.0) * RESONANT.response(20.0);
    assert!((velocity[1] - expected).norm() < 1e-12);
    assert!(velocity[3].norm() < 1e-12);
}
