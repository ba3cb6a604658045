//! Several effects on one axis.

use super::*;

#[test]
fn maps_act_in_the_order_of_the_signal_chain() {
    let active = |id: &str, value: f64| ActiveEffect::new(find(id).unwrap(), vec![value]).unwrap();
    let effects = [
        active("actuator_saturation", 1.0),
        active("gain_asymmetry", 0.5),
        active("actuator_dead_zone", 0.25),
    ];
    let axis = enter_values(plant(), &effects, 0.0);
    let through = |u: f64| {
        axis.input_maps.iter().fold(u, |u, map| {
            let piece = map.breaks.iter().filter(|at| **at < u).count();
            let (offset, slope) = map.piece(piece);
            offset + slope * u
        })
    };
    // (0.75 − 0.25)·1.5 = 0.75, below the limit.
    assert!((through(0.75) - 0.75).abs() < 1e-15);
    assert_eq!((through(3.0), through(0.2)), (1.0, 0.0));
    // (−1.25 + 0.25)·0.5 = −0.5.
    assert!((through(-1.25) + 0.5).abs() < 1e-15);
}

#[test]
fn drift_scales_every_friction_level_whatever_the_order_of_the_effects() {
    let active =
        |id: &str, values: &[f64]| ActiveEffect::new(find(id).unwrap(), values.to_vec()).unwrap();
    let drift = active("friction_drift", &[-0.2]);
    let raised = active("static_friction", &[0.8, 0.3]);
    for effects in [[drift.clone(), raised.clone()], [raised, drift]] {
        let levels = enter_values(plant(), &effects, 0.5).levels();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-15, "{a} {b}");
        close(levels.fc_plus, 0.45);
        close(levels.fs_plus, 0.72);
        // A static level below the Coulomb level counts as the Coulomb level.
        close(levels.fs_minus, 0.36);
    }
}

#[test]
fn effects_are_nested_if_one_has_all_parameters_of_the_other() {
    let nested = |one: &str, other: &str| are_nested(find(one).unwrap(), find(other).unwrap());
    assert!(nested("backlash", "flexible_mode") && nested("flexible_mode", "backlash"));
    assert!(nested("hardening_spring", "spring"));
    // The stiffness of a joint is another parameter than the stiffness of a spring to the frame.
    assert!(!nested("spring", "flexible_mode"));
    assert!(!nested("spring", "spring"));
}

/// Largest number of parameters of a base model: a, K, Fc⁺, Fc⁻ and the two of an actuator of
/// order 2.
const BASE_PARAMETERS: usize = 6;

/// Largest number of parameters of `most` effects that can act together: `together` and some of
/// `list`.
fn most_parameters(list: &[&'static dyn Effect], together: &[&dyn Effect], most: usize) -> usize {
    let own: usize = together.iter().map(|effect| effect.parameters().len()).sum();
    if together.len() == most {
        return own;
    }
    let with = |effect: &&'static dyn Effect| -> Option<usize> {
        let more: Vec<&dyn Effect> = together.iter().copied().chain([*effect as _]).collect();
        check_slots(&more).is_ok().then(|| most_parameters(list, &more, most))
    };
    list.iter().filter_map(with).fold(own, usize::max)
}

#[test]
fn dual_numbers_have_lanes_enough_for_any_effects_that_a_diagnosis_may_combine() {
    let most = crate::answers::IdentifyOptions::default().most_effects;
    assert!(BASE_PARAMETERS + most_parameters(ALL, &[], most) <= WIDE_LANES);
}

#[test]
fn two_effects_in_one_slot_are_refused_by_name_and_torques_add_up() {
    let of = |ids: &[&str]| {
        let effects: Vec<&dyn Effect> = ids.iter().map(|id| find(id).unwrap() as _).collect();
        check_slots(&effects)
    };
    let both = of(&["stribeck", "backlash", "flexible_mode"]).unwrap_err();
    assert_eq!((both.first, both.second), ("backlash", "flexible_mode"));
    assert!(both.to_string().contains("`backlash` and `flexible_mode` cannot act together"));
    assert!(of(&["sensor_lag", "sensor_lag"]).is_err());
    assert_eq!(of(&["spring", "quadratic_drag", "cogging", "backlash", "stribeck"]), Ok(()));
}

// Two effects that may act together must not overwrite what the other sets: in either order they
// must make the same axis.
#[test]
fn two_effects_that_may_act_together_leave_each_other_alone() {
    let axis = |effects: [&'static dyn Effect; 2]| {
        let active = effects.map(|effect| {
            let scope = scope();
            let middle = |p: &Parameter| {
                let [low, high] = (p.range)(&scope).likely;
                0.5 * (low + high)
            };
            let values = effect.parameters().iter().map(middle).collect();
            ActiveEffect::new(effect, values).unwrap()
        });
        let mut axis = enter_values(plant(), &active, 0.5);
        axis.torques.sort_by_key(|torque| format!("{torque:?}"));
        format!("{axis:?}")
    };
    for (i, one) in ALL.iter().enumerate() {
        for other in &ALL[i + 1..] {
            if check_slots(&[*one as _, *other as _]).is_ok() {
                assert_eq!(axis([*one, *other]), axis([*other, *one]), "{one:?} {other:?}");
            } else {
                assert_ne!(axis([*one, *other]), axis([*other, *one]), "{one:?} {other:?}");
            }
        }
    }
}
