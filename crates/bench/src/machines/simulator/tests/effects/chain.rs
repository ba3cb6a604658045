//! Tests of saturation, dead zone, gain asymmetry, slew limit and delay.

use super::*;

// The fundamental of a clipped cosine is m/π·(2φ + sin 2φ) with φ = arcsin(limit/m) (describing
// function of a saturation). Its third harmonic is integrated by the midpoint rule.
#[test]
fn without_friction_a_saturated_input_drives_the_mechanics_by_its_harmonics() {
    let (magnitude, limit, omega) = (2.0, 1.2, 7.0);
    let effects = [Effect::new("actuator_saturation", [("limit", limit)])];
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
        Effect::new("actuator_saturation", [("limit", limit)]),
        Effect::new("gain_asymmetry", [("gamma", gamma)]),
        Effect::new("actuator_dead_zone", [("half_width", half_width)]),
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
        let effects = [Effect::new("slew_limit", [("rate", rate)])];
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
        Effect::new("slew_limit", [("rate", 100.0)]),
        Effect::new("actuator_saturation", [("limit", 10.0)]),
        Effect::new(
            "backlash",
            [("load_inertia_fraction", 1e-9), ("stiffness", 1e-9), ("damping", 0.0), ("gap", 1.0)],
        ),
        Effect::new("stribeck", [("fs_over_fc", 1.0), ("stribeck_velocity", 0.1)]),
    ] {
        let found = with(&[effect], plant(0.3, 0.2), 6.0, &input);
        // The tolerance for transients, and a load of a billionth of the inertia.
        assert!(worst(&base, &found) < 3e-9, "{effect:?}: {:e}", worst(&base, &found));
    }
}

#[test]
fn a_general_input_and_its_cosine_agree_through_the_chain() {
    let effects = [
        Effect::new("transport_delay", [("delay", 0.01)]),
        Effect::new("actuator_dead_zone", [("half_width", 0.1)]),
        Effect::new("slew_limit", [("rate", 25.0)]),
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
