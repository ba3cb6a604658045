//! Tests of the effects against closed-form results.

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
        compare("delay", &found(Effect::TransportDelay { delay }), &expected);

        let time_constant = 0.03;
        let expected = linear(|s| mechanics(s) / (1.0 + s * time_constant), omega, &input);
        compare("lag", &found(Effect::SensorLag { time_constant }), &expected);

        let stiffness = 0.8;
        let spring = |s: Complex| constant * s / (s * s + a * s + constant * stiffness);
        let expected = linear(spring, omega, &input);
        compare("spring", &found(Effect::Spring { stiffness }), &expected);
        let cubic_stiffness = 0.0;
        let hardening = Effect::HardeningSpring { stiffness, cubic_stiffness };
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
        let effect = Effect::FlexibleMode { load_inertia_fraction: rho, stiffness: k, damping: c };
        compare("flexible mode", &found(effect), &expected);
    }
}

// The fundamental of a clipped cosine is m/π·(2φ + sin 2φ) with φ = arcsin(limit/m) (describing
// function of a saturation). Its third harmonic is integrated by the midpoint rule.
#[test]
fn without_friction_a_saturated_input_drives_the_mechanics_by_its_harmonics() {
    let (magnitude, limit, omega) = (2.0, 1.2, 7.0);
    let effects = [Effect::ActuatorSaturation { limit }];
    let found = with(&effects, plant(0.0, 0.0), omega, &cosine(magnitude));
    let angle = (limit / magnitude).asin();
    let first = magnitude / std::f64::consts::PI * (2.0 * angle + (2.0 * angle).sin());
    let count = 100_000;
    let third: f64 = (0..count)
        .map(|i| {
            let x = TAU * (f64::from(i) + 0.5) / f64::from(count);
            (magnitude * x.cos()).clamp(-limit, limit) * (3.0 * x).cos()
        })
        .sum::<f64>()
        * 2.0
        / f64::from(count);
    for (k, line) in [(1, first), (2, 0.0), (3, third)] {
        let expected = plant(0.0, 0.0).mechanics_response(k as f64 * omega) * line;
        assert!((found[k] - expected).norm() < 3e-9, "harmonic {k}");
    }
}

#[test]
fn a_dead_zone_an_asymmetric_gain_and_a_limit_act_in_this_order() {
    let (half_width, gamma, limit, omega, magnitude) = (0.2, 0.3, 0.8, 5.0, 1.0);
    let effects = [
        Effect::ActuatorSaturation { limit },
        Effect::GainAsymmetry { gamma },
        Effect::ActuatorDeadZone { half_width },
    ];
    let found = with(&effects, plant(0.0, 0.0), omega, &cosine(magnitude));
    let shaped = |u: f64| {
        let beyond = u - u.clamp(-half_width, half_width);
        let gain = if beyond > 0.0 { 1.0 + gamma } else { 1.0 - gamma };
        (gain * beyond).clamp(-limit, limit)
    };
    let count = 100_000;
    for (k, found) in found.iter().enumerate().take(4) {
        let integrand = |i: i32| {
            let x = TAU * (f64::from(i) + 0.5) / f64::from(count);
            shaped(magnitude * x.cos()) * Complex::from_polar(1.0, -(k as f64) * x)
        };
        let factor = if k == 0 { 1.0 } else { 2.0 };
        let line = (0..count).map(integrand).sum::<Complex>() * factor / f64::from(count);
        let expected = plant(0.0, 0.0).mechanics_response(k as f64 * omega) * line;
        // The midpoint rule has an error of (2π/count)² at each kink.
        assert!((found - expected).norm() < 5e-9, "harmonic {k}");
    }
}

#[test]
fn a_slew_limit_never_met_makes_a_triangle_whatever_the_magnitude() {
    let (rate, omega) = (1.0, 10.0);
    let amplitude = rate * TAU / omega / 4.0;
    for magnitude in [1.0, 30.0] {
        let effects = [Effect::SlewLimit { rate }];
        let found = with(&effects, plant(0.0, 0.0), omega, &cosine(magnitude));
        for k in [0, 1, 2, 3, 5] {
            let line = if k % 2 == 1 {
                8.0 * amplitude / (std::f64::consts::PI * k as f64).powi(2)
            } else {
                0.0
            };
            let expected = plant(0.0, 0.0).mechanics_response(k as f64 * omega).norm() * line;
            assert!((found[k].norm() - expected).abs() < 3e-9, "harmonic {k} at {magnitude}");
        }
    }
}

#[test]
fn a_slew_limit_above_every_slope_and_a_limit_above_every_value_change_nothing() {
    let input = [Complex::new(0.1, 0.0), Complex::new(1.0, 0.3), Complex::new(0.2, -0.4)];
    let base = with(&[], plant(0.3, 0.2), 6.0, &input);
    for effect in [
        Effect::SlewLimit { rate: 100.0 },
        Effect::ActuatorSaturation { limit: 10.0 },
        Effect::Backlash { load_inertia_fraction: 1e-9, stiffness: 1e-9, damping: 0.0, gap: 1.0 },
        Effect::Stribeck { fs_over_fc: 1.0, stribeck_velocity: 0.1 },
    ] {
        let found = with(&[effect], plant(0.3, 0.2), 6.0, &input);
        // The tolerance for transients, and a load of a billionth of the inertia.
        assert!(worst(&base, &found) < 3e-9, "{effect:?}: {:e}", worst(&base, &found));
    }
}

#[test]
fn a_general_input_and_its_cosine_agree_through_the_chain() {
    let effects = [
        Effect::TransportDelay { delay: 0.01 },
        Effect::ActuatorDeadZone { half_width: 0.1 },
        Effect::SlewLimit { rate: 25.0 },
    ];
    let omega = 12.0;
    let plain = with(&effects, plant(0.5, 0.4), omega, &cosine(3.0));
    // The same cosine, as the second line of half the fundamental and a quarter period earlier.
    let input = [ZERO, ZERO, Complex::new(0.0, 3.0)];
    let doubled = with(&effects, plant(0.5, 0.4), omega / 2.0, &input);
    for k in 0..4 {
        let turned = plain[k] * Complex::from_polar(1.0, k as f64 * TAU / 4.0);
        assert!((doubled[2 * k] - turned).norm() < 1e-8, "harmonic {k}");
    }
}

#[test]
fn drift_scales_every_level_by_the_place_in_the_run() {
    let effects = [
        Effect::FrictionDrift { delta: -0.4 },
        Effect::StaticFriction { fs_plus: 0.8, fs_minus: 0.6 },
    ];
    let drifted = Machine { plant: plant(0.5, 0.4), effects: &effects };
    let half = respond(&drifted, 0.5, 3.0, &cosine(1.0), 7, &Settings::default()).unwrap();
    let friction = Friction { fs_plus: 0.64, fs_minus: 0.48, ..Friction::coulomb(0.4, 0.32) };
    let scaled = with(&[], Plant { friction, ..plant(0.4, 0.32) }, 3.0, &cosine(1.0));
    assert!(worst(&half, &scaled) < 1e-12);
    assert!(worst(&half, &with(&effects, plant(0.5, 0.4), 3.0, &cosine(1.0))) > 1e-3);
}

#[test]
fn cogging_holds_the_means_of_velocity_and_position_at_zero() {
    let cogging = [
        Effect::Cogging { amplitude: 0.2, cycles_per_unit: 9.0, phase: 0.7 },
        Effect::Stribeck { fs_over_fc: 1.3, stribeck_velocity: 0.1 },
    ];
    let (plant, omega, settings) = (plant(0.5, 0.4), 4.0, Settings::default());
    let mechanics = Mechanics::of(&plant, &cogging, 0.0);
    let command = Command::periodic(&cogging, omega, &cosine(1.5));
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
    let cogging = [Effect::Cogging { amplitude, cycles_per_unit, phase }];
    let found = with(&cogging, plant(0.0, 0.0), omega, &cosine(1e-5));
    let spring = [Effect::Spring { stiffness: amplitude * cycles_per_unit * phase.cos() }];
    let expected = with(&spring, plant(0.0, 0.0), omega, &cosine(1e-5));
    // θ is about 1e-6, and the next term of the sine is Nθ/2 times that of the spring.
    assert!(worst(&found, &expected) < 1e-5 * expected[1].norm());
}

#[test]
fn cogging_leaves_an_axis_stuck_whose_torque_spans_less_than_its_static_levels() {
    let cogging = [Effect::Cogging { amplitude: 0.2, cycles_per_unit: 9.0, phase: 0.0 }];
    let found = with(&cogging, plant(0.5, 0.4), 2.0, &cosine(0.4499));
    assert_eq!(found, vec![ZERO; 8]);
    assert!(with(&cogging, plant(0.5, 0.4), 2.0, &cosine(0.46))[1].norm() > 1e-6);
}

// Well below breakaway the bristle is a spring of stiffness σ.
#[test]
fn a_bristle_moves_below_breakaway_as_a_spring() {
    let (sigma, omega) = (20.0, 5.0);
    let found = with(&[Effect::Presliding { sigma }], plant(0.5, 0.4), omega, &cosine(1e-4));
    let spring = Complex::new(10.0 * sigma - omega * omega, 10.0 * omega);
    let expected = 1e-4 * 10.0 * Complex::new(0.0, omega) / spring;
    // The relative error of this linearisation is z·σ/Fc, about 2e-4.
    assert!((found[1] - expected).norm() < 5e-4 * expected.norm());
}

#[test]
fn a_load_that_floats_in_a_wide_gap_leaves_the_motor_alone() {
    let (rho, omega) = (0.4, 46.0);
    let backlash =
        [Effect::Backlash { load_inertia_fraction: rho, stiffness: 60.0, damping: 1.2, gap: 0.01 }];
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
                Effect::Stribeck { fs_over_fc: 1.5, stribeck_velocity: 0.2 },
                Effect::QuadraticDrag { c: 0.06 },
                Effect::ActuatorDeadZone { half_width: 0.15 },
                Effect::SlewLimit { rate: 8.0 },
            ],
            5.0,
        ),
        (
            &[
                Effect::Backlash {
                    load_inertia_fraction: 0.4,
                    stiffness: 20.0,
                    damping: 0.6,
                    gap: 0.02,
                },
                Effect::ViscousAsymmetry { alpha: 0.1 },
                Effect::ActuatorSaturation { limit: 2.0 },
            ],
            6.0,
        ),
        (
            &[
                Effect::Presliding { sigma: 3.0 },
                Effect::HardeningSpring { stiffness: 0.4, cubic_stiffness: 0.3 },
                Effect::GainAsymmetry { gamma: 0.1 },
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
    let spring = Effect::Spring { stiffness: 1.0 };
    assert_eq!(refused(&[spring, spring], 0.0), "`spring` is given more than once");
    assert!(refused(&[Effect::SlewLimit { rate: 0.0 }], 0.0).starts_with("`rate` of `slew_limit`"));
    let (load_inertia_fraction, stiffness, damping, gap) = (0.3, 40.0, 0.1, 0.01);
    let joints = [
        Effect::Backlash { load_inertia_fraction, stiffness, damping, gap },
        Effect::FlexibleMode { load_inertia_fraction, stiffness, damping },
    ];
    assert!(refused(&joints, 0.0).contains("the same joint"));
    let low = Effect::StaticFriction { fs_plus: 0.4, fs_minus: 0.6 };
    assert!(refused(&[low], 0.0).starts_with("Fs+ is 0.4"));
    assert!(refused(&[], 1.5).starts_with("the share of the run is 1.5"));
}

// A load on a joint with little damping rattles in its gap for ever.
#[test]
fn a_load_that_rattles_has_no_periodic_response() {
    let rattling = [Effect::Backlash {
        load_inertia_fraction: 0.5,
        stiffness: 200.0,
        damping: 0.1,
        gap: 0.01,
    }];
    let machine = Machine { plant: plant(0.5, 0.4), effects: &rattling };
    let result = respond(&machine, 0.0, 20.0, &cosine(1.0), 1, &Settings::default());
    assert!(matches!(result, Err(SimulatorError::NotPeriodic { .. })), "{result:?}");
}

// The torque hardly exceeds the friction level on one side. Each period winds the spring up by
// less, in proportion to the square of the remaining distance.
#[test]
fn an_axis_that_creeps_against_its_spring_comes_to_rest() {
    let spring = [Effect::Spring { stiffness: 0.8 }];
    let found = with(&spring, plant(0.5, 0.4), 30.0, &cosine(0.45));
    assert_eq!(found, vec![ZERO; 8]);
    assert!(with(&spring, plant(0.5, 0.4), 30.0, &cosine(0.46))[1].norm() > 1e-6);
}
