//! The benchmark's simulator against the reference responses.

use servoscope_bench::machines::simulator::{Effect, Machine, Settings, respond};
use servoscope_core::measurement::Complex;

use crate::reference;

/// Largest deviation from a reference file, as a share of its largest component.
fn deviation(name: &str) -> f64 {
    let last_run = reference::points(name).iter().map(|point| point.run).max().expect("points");
    let effects: Vec<Effect> = reference::effect(name)
        .map(|(id, parameters)| {
            Effect::new(&id, parameters.iter().map(|(name, value)| (name.as_str(), *value)))
        })
        .into_iter()
        .collect();
    reference::largest_deviation(name, |plant, point| {
        let machine = Machine { plant: *plant, effects: &effects };
        let share = point.run as f64 / last_run as f64;
        let input = [Complex::new(0.0, 0.0), Complex::new(point.magnitude, 0.0)];
        let highest = point.harmonics.len() - 1;
        let found =
            respond(&machine, share, point.omega_rad_s, &input, highest, &Settings::default())
                .unwrap_or_else(|error| panic!("{name} at run {}: {error}", point.run));
        let zero = Complex::new(0.0, 0.0);
        if point.harmonics.iter().all(|expected| *expected == zero) {
            assert_eq!(found, point.harmonics, "{name} at run {}", point.run);
        }
        found
    })
}

// The references are accurate to 1e-6 of the largest component of their file.
#[test]
fn the_base_model_and_every_effect_agree_with_the_reference_to_2e_6() {
    for name in [
        "g1.csv",
        "g1_actuator_dead_zone.csv",
        "g1_actuator_saturation.csv",
        "g1_flexible_mode.csv",
        "g1_friction_drift.csv",
        "g1_gain_asymmetry.csv",
        "g1_hardening_spring.csv",
        "g1_presliding.csv",
        "g1_quadratic_drag.csv",
        "g1_sensor_lag.csv",
        "g1_slew_limit.csv",
        "g1_spring.csv",
        "g1_static_friction.csv",
        "g1_stribeck.csv",
        "g1_transport_delay.csv",
        "g1_viscous_asymmetry.csv",
        "g2.csv",
        "g2_actuator_saturation.csv",
        "g2_stribeck.csv",
        "g2_transport_delay.csv",
    ] {
        let deviation = deviation(name);
        println!("{name}: {deviation:.1e}");
        assert!(deviation <= 2e-6, "{name}: {deviation:e}");
    }
}

// Accurate to 1e-5 of its largest component.
#[test]
fn backlash_agrees_with_the_reference_to_2e_5() {
    let deviation = deviation("g1_backlash.csv");
    println!("g1_backlash.csv: {deviation:.1e}");
    assert!(deviation <= 2e-5, "{deviation:e}");
}
