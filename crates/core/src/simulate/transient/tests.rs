use nalgebra::{Matrix3, Vector3};

use super::*;
use crate::measurement::Intersample;
use crate::plant::Friction;

fn plant(actuator: Actuator, fc_plus: f64, fc_minus: f64) -> Plant {
    let friction = Friction::coulomb(fc_plus, fc_minus);
    Plant { viscous_rate_rad_s: 10.0, constant: 10.0, actuator, friction }
}

/// A motion without effects.
fn moved(
    plant: &Plant,
    values: &[f64],
    between: Intersample,
    initial: &InitialState,
) -> Trajectory {
    follow(plant, &[], 0.0, &SampledInput { step_s: 1e-2, values, between }, initial).unwrap()
}

fn worst(values: &[f64], expected: impl Fn(f64) -> f64) -> f64 {
    let apart = |(n, x): (usize, &f64)| (x - expected(n as f64 * 1e-2)).abs();
    values.iter().enumerate().map(apart).fold(0.0, f64::max)
}

// v = (K/a)(u − Fc)(1 − e^(−at)) and its integral and derivative.
#[test]
fn a_step_from_rest_is_that_of_the_formula() {
    let values = vec![1.5; 200];
    let rest = InitialState::default();
    for between in [Intersample::Linear, Intersample::Hold] {
        let motion = moved(&plant(Actuator::Direct, 0.5, 0.4), &values, between, &rest);
        assert!(worst(&motion.velocity, |t| 1.0 - (-10.0 * t).exp()) < 1e-12);
        assert!(worst(&motion.acceleration, |t| 10.0 * (-10.0 * t).exp()) < 1e-11);
        // v is a quintic over each step of a tenth of the time constant.
        let position = |t: f64| t - 0.1 * (1.0 - (-10.0 * t).exp());
        assert!(worst(&motion.position, position) < 1e-11);
    }
}

// Released at v = 1 without torque, the axis stops after ln(1 + a·v/(K·Fc))/a and stays at rest.
#[test]
fn an_axis_that_coasts_stops_and_stays() {
    let initial = InitialState { velocity: 1.0, ..InitialState::default() };
    let motion =
        moved(&plant(Actuator::Direct, 0.5, 0.4), &[0.0; 60], Intersample::Linear, &initial);
    let expected = |t: f64| (1.5 * (-10.0 * t).exp() - 0.5).max(0.0);
    assert!(worst(&motion.velocity, expected) < 1e-12, "{motion:?}");
    let stop_s = 3.0_f64.ln() / 10.0;
    let travel = 0.15 * (1.0 - (-10.0 * stop_s).exp()) - 0.5 * stop_s;
    assert!((motion.position[59] - travel).abs() < 1e-9);
}

// Without friction τ and v follow from their own linear equations: p/(s + p), then K/(s + a).
#[test]
fn behind_an_actuator_the_torque_starts_from_its_own_state() {
    let actuator = Actuator::FirstOrder { corner_rad_s: 30.0 };
    let initial = InitialState { torque: Some(-1.0), ..InitialState::default() };
    let values = vec![1.0; 100];
    let motion = moved(&plant(actuator, 0.0, 0.0), &values, Intersample::Hold, &initial);
    // τ = 1 − 2e^(−30t); v = 1 − e^(−10t) − 2·10/(10 − 30)·(e^(−30t) − e^(−10t)).
    let v = |t: f64| {
        let (slow, fast) = ((-10.0 * t).exp(), (-30.0 * t).exp());
        1.0 - slow + (fast - slow)
    };
    // Error of quintics over 0.3 time constants: (0.3)⁶/46080 of τ.
    assert!(worst(&motion.velocity, v) < 1e-7, "{}", worst(&motion.velocity, v));
}

// Without friction, the deviation of (τ, τ', v) from its final value is exp(At) times its initial
// value.
#[test]
fn behind_an_actuator_of_order_2_the_torque_starts_with_its_rate() {
    let natural_frequency_rad_s: f64 = 30.0;
    for damping_ratio in [0.3, 1.1] {
        let actuator = Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio };
        let (torque, torque_rate) = (Some(-1.0), Some(40.0));
        let initial = InitialState { torque, torque_rate, ..InitialState::default() };
        let motion = moved(&plant(actuator, 0.0, 0.0), &[1.0; 100], Intersample::Hold, &initial);
        let (stiffness, damping) =
            (natural_frequency_rad_s.powi(2), 2.0 * damping_ratio * natural_frequency_rad_s);
        let matrix = Matrix3::new(0.0, 1.0, 0.0, -stiffness, -damping, 0.0, 10.0, 0.0, -10.0);
        let begin = Vector3::new(-1.0, 40.0, 0.0);
        let end = Vector3::new(1.0, 0.0, 1.0);
        let v = |t: f64| ((matrix * t).exp() * (begin - end) + end)[2];
        // Error of quintics over half a time constant: (0.47)⁶/46080 of τ − 1, of which a tenth
        // enters v in a step.
        let apart = worst(&motion.velocity, v);
        assert!(apart < 1e-7, "{damping_ratio}: {apart:e}");
    }
}

#[test]
fn an_actuator_too_quick_to_see_is_a_delay() {
    let values: Vec<f64> = (0..200).map(|n| (0.05 * f64::from(n)).sin() * 2.0).collect();
    let rest = InitialState::default();
    let follow = |wn: f64| {
        let actuator = Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: 0.5 };
        moved(&plant(actuator, 0.5, 0.4), &values, Intersample::Linear, &rest)
    };
    // Just below and just above the frequency at which the actuator becomes a delay of
    // 2·0.5/ωₙ = 4e-4 s.
    let (below, above) = (follow(2390.0), follow(2410.0));
    let apart = below.velocity.iter().zip(&above.velocity).map(|(a, b)| (a - b).abs());
    // Each kink at a sample changes the slope by 0.005 and excites an oscillation of 1/ωₙ² of that.
    assert!(apart.fold(0.0, f64::max) < 1e-4);
}
