//! Tests of the effects against closed-form results.

mod chain;
mod cogging;

use crate::machines::simulator::parts::Parts;
use crate::machines::simulator::*;
use crate::plant::Friction;

/// A plant with a = 10 1/s, K = 10 and an actuator of order 0.
fn plant(fc_plus: f64, fc_minus: f64) -> Plant {
    Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator: Actuator::Direct,
        friction: Friction::coulomb(fc_plus, fc_minus),
    }
}

const ZERO: Complex = Complex::new(0.0, 0.0);

fn cosine(magnitude: f64) -> Vec<Complex> {
    vec![ZERO, Complex::new(magnitude, 0.0)]
}

fn with(effects: &[Effect], plant: Plant, omega_rad_s: f64, input: &[Complex]) -> Vec<Complex> {
    let machine = Machine { plant, effects };
    respond(&machine, 0.0, omega_rad_s, input, 7, &Settings::default()).unwrap()
}

fn worst(left: &[Complex], right: &[Complex]) -> f64 {
    left.iter().zip(right).map(|(l, r)| (l - r).norm()).fold(0.0, f64::max)
}

/// Harmonics 0 to 7 of a linear machine with the transfer function `response`.
fn linear(response: impl Fn(Complex) -> Complex, omega: f64, input: &[Complex]) -> Vec<Complex> {
    let line = |k: usize| input.get(k).copied().unwrap_or_default();
    (0..8).map(|k| response(Complex::new(0.0, k as f64 * omega)) * line(k)).collect()
}

// The tolerance for transients is 1e-9 of each state.
#[test]
fn without_friction_linear_effects_are_their_transfer_functions() {
    let (a, constant) = (10.0, 10.0);
    let input = [ZERO, Complex::new(1.0, 0.5), Complex::new(-0.2, 0.1)];
    let mechanics = |s: Complex| constant / (s + a);
    for omega in [1.0, 20.0, 200.0] {
        let found = |effect: Effect| with(&[effect], plant(0.0, 0.0), omega, &input);
        let compare = |name: &str, found: &[Complex], expected: &[Complex]| {
            let difference = worst(found, expected);
            assert!(difference < 5e-9, "{name} at {omega} rad/s: {difference:e}");
        };

        let delay = 0.013;
        let expected = linear(|s| mechanics(s) * (-s * delay).exp(), omega, &input);
        compare("delay", &found(Effect::new("transport_delay", [("delay", delay)])), &expected);

        let time_constant = 0.03;
        let expected = linear(|s| mechanics(s) / (1.0 + s * time_constant), omega, &input);
        compare(
            "lag",
            &found(Effect::new("sensor_lag", [("time_constant", time_constant)])),
            &expected,
        );

        let stiffness = 0.8;
        let spring = |s: Complex| constant * s / (s * s + a * s + constant * stiffness);
        let expected = linear(spring, omega, &input);
        compare("spring", &found(Effect::new("spring", [("stiffness", stiffness)])), &expected);
        let cubic_stiffness = 0.0;
        let hardening = Effect::new(
            "hardening_spring",
            [("stiffness", stiffness), ("cubic_stiffness", cubic_stiffness)],
        );
        compare("hardening spring", &found(hardening), &expected);

        let (rho, k, c) = (0.3, 40.0, 0.05);
        let flexible = |s: Complex| {
            // Numerator and denominator are multiplied by s to avoid 0/0 at s = 0.
            let joint = k + c * s;
            let load = rho / constant * s * s + joint;
            let motor = (1.0 - rho) / constant * s + a / constant;
            load / (motor * load + rho / constant * s * joint)
        };
        let expected = linear(flexible, omega, &input);
        let effect = Effect::new(
            "flexible_mode",
            [("load_inertia_fraction", rho), ("stiffness", k), ("damping", c)],
        );
        compare("flexible mode", &found(effect), &expected);
    }
}

#[test]
fn drift_scales_every_level_by_the_place_in_the_run() {
    let effects = [
        Effect::new("friction_drift", [("delta", -0.4)]),
        Effect::new("static_friction", [("fs_plus", 0.8), ("fs_minus", 0.6)]),
    ];
    let drifted = Machine { plant: plant(0.5, 0.4), effects: &effects };
    let half = respond(&drifted, 0.5, 3.0, &cosine(1.0), 7, &Settings::default()).unwrap();
    let friction = Friction { fs_plus: 0.64, fs_minus: 0.48, ..Friction::coulomb(0.4, 0.32) };
    let scaled = with(&[], Plant { friction, ..plant(0.4, 0.32) }, 3.0, &cosine(1.0));
    assert!(worst(&half, &scaled) < 1e-12);
    assert!(worst(&half, &with(&effects, plant(0.5, 0.4), 3.0, &cosine(1.0))) > 1e-3);
}

// Well below breakaway the bristle is a spring of stiffness σ.
#[test]
fn a_bristle_moves_below_breakaway_as_a_spring() {
    let (sigma, omega) = (20.0, 5.0);
    let found = with(
        &[Effect::new("presliding", [("sigma", sigma)])],
        plant(0.5, 0.4),
        omega,
        &cosine(1e-4),
    );
    let spring = Complex::new(10.0 * sigma - omega * omega, 10.0 * omega);
    let expected = 1e-4 * 10.0 * Complex::new(0.0, omega) / spring;
    // The relative error of this linearisation is z·σ/Fc, about 2e-4.
    assert!((found[1] - expected).norm() < 5e-4 * expected.norm());
}

#[test]
fn a_load_that_floats_in_a_wide_gap_leaves_the_motor_alone() {
    let (rho, omega) = (0.4, 46.0);
    let backlash = [Effect::new(
        "backlash",
        [("load_inertia_fraction", rho), ("stiffness", 60.0), ("damping", 1.2), ("gap", 0.01)],
    )];
    let found = with(&backlash, plant(0.5, 0.4), omega, &cosine(1.0));
    let alone = Plant {
        viscous_rate_rad_s: 10.0 / (1.0 - rho),
        constant: 10.0 / (1.0 - rho),
        ..plant(0.5, 0.4)
    };
    assert!(worst(&found, &with(&[], alone, omega, &cosine(1.0))) < 1e-9);
}

#[test]
fn half_the_step_leaves_a_sixteenth_of_the_error_with_every_kind_of_effect() {
    let sets: [(&[Effect], f64); 3] = [
        (
            &[
                Effect::new("stribeck", [("fs_over_fc", 1.5), ("stribeck_velocity", 0.2)]),
                Effect::new("quadratic_drag", [("c", 0.06)]),
                Effect::new("actuator_dead_zone", [("half_width", 0.15)]),
                Effect::new("slew_limit", [("rate", 8.0)]),
            ],
            5.0,
        ),
        (
            &[
                Effect::new(
                    "backlash",
                    [
                        ("load_inertia_fraction", 0.4),
                        ("stiffness", 20.0),
                        ("damping", 0.6),
                        ("gap", 0.02),
                    ],
                ),
                Effect::new("viscous_asymmetry", [("alpha", 0.1)]),
                Effect::new("actuator_saturation", [("limit", 2.0)]),
            ],
            6.0,
        ),
        (
            &[
                Effect::new("presliding", [("sigma", 3.0)]),
                Effect::new("hardening_spring", [("stiffness", 0.4), ("cubic_stiffness", 0.3)]),
                Effect::new("gain_asymmetry", [("gamma", 0.1)]),
            ],
            5.0,
        ),
    ];
    for (effects, omega) in sets {
        let machine = Machine { plant: plant(0.5, 0.4), effects };
        let with_steps = |steps_per_period| {
            let settings = Settings {
                steps_per_period,
                steps_per_time_constant: 0.0,
                tolerance: 1e-12,
                ..Settings::default()
            };
            respond(&machine, 0.0, omega, &cosine(2.5), 5, &settings).unwrap()
        };
        let exact = with_steps(16_384);
        let errors = [256, 512, 1024].map(|steps| worst(&with_steps(steps), &exact));
        // Two halvings, each with a factor between 2³ and 2⁵: the error of a fourth-order method
        // varies with the position of events and kinks within their steps.
        let gain = errors[0] / errors[2];
        assert!((8.0 * 8.0..32.0 * 32.0).contains(&gain), "{effects:?}: {errors:?}");
    }
}

#[test]
fn sets_of_effects_that_make_no_machine_are_refused() {
    let refused = |effects: &[Effect], share: f64| {
        let machine = Machine { plant: plant(0.5, 0.4), effects };
        let settings = Settings::default();
        respond(&machine, share, 1.0, &cosine(1.0), 1, &settings).unwrap_err().to_string()
    };
    let spring = Effect::new("spring", [("stiffness", 1.0)]);
    assert_eq!(refused(&[spring, spring], 0.0), "`spring` is given more than once");
    assert!(
        refused(&[Effect::new("slew_limit", [("rate", 0.0)])], 0.0)
            .starts_with("`rate` of `slew_limit`")
    );
    let (load_inertia_fraction, stiffness, damping, gap) = (0.3, 40.0, 0.1, 0.01);
    let joints = [
        Effect::new(
            "backlash",
            [
                ("load_inertia_fraction", load_inertia_fraction),
                ("stiffness", stiffness),
                ("damping", damping),
                ("gap", gap),
            ],
        ),
        Effect::new(
            "flexible_mode",
            [
                ("load_inertia_fraction", load_inertia_fraction),
                ("stiffness", stiffness),
                ("damping", damping),
            ],
        ),
    ];
    assert!(refused(&joints, 0.0).contains("the same joint"));
    let low = Effect::new("static_friction", [("fs_plus", 0.4), ("fs_minus", 0.6)]);
    assert!(refused(&[low], 0.0).starts_with("Fs+ is 0.4"));
    assert!(refused(&[], 1.5).starts_with("the share of the run is 1.5"));
}

// A load on a joint with little damping rattles in its gap for ever.
#[test]
fn a_load_that_rattles_has_no_periodic_response() {
    let rattling = [Effect::new(
        "backlash",
        [("load_inertia_fraction", 0.5), ("stiffness", 200.0), ("damping", 0.1), ("gap", 0.01)],
    )];
    let machine = Machine { plant: plant(0.5, 0.4), effects: &rattling };
    let result = respond(&machine, 0.0, 20.0, &cosine(1.0), 1, &Settings::default());
    assert!(matches!(result, Err(SimulatorError::NotPeriodic { .. })), "{result:?}");
}

// The torque hardly exceeds the friction level on one side. Each period winds the spring up by
// less, in proportion to the square of the remaining distance.
#[test]
fn an_axis_that_creeps_against_its_spring_comes_to_rest() {
    let spring = [Effect::new("spring", [("stiffness", 0.8)])];
    let found = with(&spring, plant(0.5, 0.4), 30.0, &cosine(0.45));
    assert_eq!(found, vec![ZERO; 8]);
    assert!(with(&spring, plant(0.5, 0.4), 30.0, &cosine(0.46))[1].norm() > 1e-6);
}
