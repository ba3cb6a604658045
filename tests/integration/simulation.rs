//! The simulator against the reference responses.

use servoscope_core::effects::{self, ActiveEffect};
use servoscope_core::plant::{Friction, Plant};
use servoscope_core::simulate::{Excitation, respond};

use crate::reference;

/// The effect of a reference file, as the library knows it.
fn active(name: &str) -> Vec<ActiveEffect> {
    let active = |(id, parameters): (String, std::collections::BTreeMap<String, f64>)| {
        let effect = effects::find(&id).expect("an effect of the library");
        let values = effect.parameters().iter().map(|p| parameters[p.name]).collect();
        ActiveEffect::new(effect, values).expect("its parameters")
    };
    reference::effect(name).map(active).into_iter().collect()
}

// The references are accurate to 1e-6 of the largest component of their file, the one with
// backlash to 1e-5; the contract allows ten and five times that.
#[test]
fn the_base_model_and_every_effect_agree_with_the_reference_responses() {
    for name in reference::names() {
        let effects = active(&name);
        let last_run = reference::points(&name).iter().map(|p| p.run).max().unwrap();
        let deviation = reference::largest_deviation(&name, |plant, point| {
            // The index gives breakaway levels too, which an effect raises by itself.
            let Friction { fc_plus, fc_minus, .. } = plant.friction;
            let base = Plant { friction: Friction::coulomb(fc_plus, fc_minus), ..*plant };
            let excitation = Excitation::cosine(point.omega_rad_s, point.magnitude)
                .at_run_share(point.run as f64 / last_run as f64);
            respond(&base, &effects, &excitation, point.harmonics.len() - 1)
                .unwrap_or_else(|error| panic!("{name} at run {}: {error}", point.run))
        });
        println!("{name}: {deviation:.1e}");
        let allowed = if name == "g1_backlash.csv" { 5e-5 } else { 1e-5 };
        assert!(deviation <= allowed, "{name}: {deviation:e}");
    }
}
