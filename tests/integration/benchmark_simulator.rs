//! The benchmark's simulator against the reference responses of the base model.

use servoscope::benchmark::simulator::{Machine, Settings, respond};
use servoscope::measurement::Complex;

use crate::reference;

// The references are accurate to 1e-6 of the largest component of their file.
#[test]
fn the_base_model_and_static_friction_agree_with_the_reference_to_2e_6() {
    for name in ["g1.csv", "g2.csv", "g1_static_friction.csv"] {
        let deviation = reference::largest_deviation(name, |plant, point| {
            let input = [Complex::new(0.0, 0.0), Complex::new(point.magnitude, 0.0)];
            let highest = point.harmonics.len() - 1;
            respond(
                &Machine::base(*plant),
                0.0,
                point.omega_rad_s,
                &input,
                highest,
                &Settings::default(),
            )
            .unwrap_or_else(|error| panic!("{name}: {error}"))
        });
        let Some(deviation) = deviation else { return };
        assert!(deviation <= 2e-6, "{name}: {deviation:e}");
    }
}
