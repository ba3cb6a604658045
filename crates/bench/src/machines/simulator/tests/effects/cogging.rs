//! Tests of cogging.

use super::*;

#[test]
fn cogging_holds_the_means_of_velocity_and_position_at_zero() {
    let cogging = [
        Effect::new("cogging", [("amplitude", 0.2), ("cycles_per_unit", 9.0), ("phase", 0.7)]),
        Effect::new("stribeck", [("fs_over_fc", 1.3), ("stribeck_velocity", 0.1)]),
    ];
    let (plant, omega, settings) = (plant(0.5, 0.4), 4.0, Settings::default());
    let mechanics = Mechanics::of(&plant, &Parts::of(&cogging), 0.0);
    let command = Command::periodic(&Parts::of(&cogging), omega, &cosine(1.5));
    let drive = Drive::periodic(&plant.actuator, &command, command.period_s() / 2048.0);
    let found = cogging_state::<2>(&mechanics, &drive, &settings).unwrap().unwrap();
    let mechanics = mechanics.with_cogging(found.constant_torque, 1.0);
    let mut series = [FourierSeries::new(1, omega), FourierSeries::new(1, omega)];
    let mut axis = Axis::new(&mechanics, &drive, found.state);
    axis.run_period(&mut |piece| {
        series[0].add(piece, 0, |v| v);
        series[1].add(piece, 1, |v| v);
    });
    let [velocity, position] = series.map(|series| series.harmonics());
    // A few times the tolerance for transients.
    assert!(worst(&[axis.state()[0].into()], &[found.state[0].into()]) < 1e-8);
    assert!(velocity[0].norm() < 1e-8 && position[0].norm() < 1e-8);
    assert!((velocity[1] - position[1] * Complex::new(0.0, omega)).norm() < 1e-8);
    assert!(velocity[1].norm() > 0.1 && found.constant_torque.abs() > 1e-3);
}

// For small θ, T·sin(Nθ + φ) ≈ T·sin φ + T·N·cos φ·θ. The constant torque b balances the first
// term, and the second is a spring.
#[test]
fn without_friction_cogging_of_a_small_motion_is_a_spring() {
    let (amplitude, cycles_per_unit, phase, omega) = (0.5, 4.0, 0.6_f64, 5.0);
    let cogging = [Effect::new(
        "cogging",
        [("amplitude", amplitude), ("cycles_per_unit", cycles_per_unit), ("phase", phase)],
    )];
    let found = with(&cogging, plant(0.0, 0.0), omega, &cosine(1e-5));
    let spring =
        [Effect::new("spring", [("stiffness", amplitude * cycles_per_unit * phase.cos())])];
    let expected = with(&spring, plant(0.0, 0.0), omega, &cosine(1e-5));
    // θ is about 1e-6, and the next term of the sine is Nθ/2 times that of the spring.
    assert!(worst(&found, &expected) < 1e-5 * expected[1].norm());
}

#[test]
fn cogging_leaves_an_axis_stuck_whose_torque_spans_less_than_its_static_levels() {
    let cogging =
        [Effect::new("cogging", [("amplitude", 0.2), ("cycles_per_unit", 9.0), ("phase", 0.0)])];
    let found = with(&cogging, plant(0.5, 0.4), 2.0, &cosine(0.4499));
    assert_eq!(found, vec![ZERO; 8]);
    assert!(with(&cogging, plant(0.5, 0.4), 2.0, &cosine(0.46))[1].norm() > 1e-6);
}
