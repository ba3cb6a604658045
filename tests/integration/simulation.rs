//! The simulator against the reference responses.

use servoscope::effects::{Effect, StaticFriction};
use servoscope::plant::{Friction, Plant};
use servoscope::simulate::{Excitation, respond};

use crate::reference;

#[test]
fn the_simulation_agrees_with_the_reference_responses() {
    for name in ["g1.csv", "g2.csv", "g1_static_friction.csv"] {
        let deviation = reference::largest_deviation(name, |plant, point| {
            let Friction { fc_plus, fc_minus, fs_plus, fs_minus } = plant.friction;
            let base = Plant { friction: Friction::coulomb(fc_plus, fc_minus), ..*plant };
            let effects: Vec<Box<dyn Effect>> =
                vec![Box::new(StaticFriction { fs_plus, fs_minus })];
            let excitation = Excitation::cosine(point.omega_rad_s, point.magnitude);
            respond(&base, &effects, &excitation, point.harmonics.len() - 1).unwrap()
        });
        let Some(deviation) = deviation else { return };
        // The references are accurate to 1e-6 of it; the issue allows 2e-6.
        assert!(deviation < 2e-6, "{name}: {deviation:e}");
    }
}
