use super::*;
use crate::plant::{Actuator, Friction, Plant};

fn plant() -> Plant {
    Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator: Actuator::Direct,
        friction: Friction::coulomb(0.5, 0.4),
    }
}

fn scope() -> Scope {
    Scope {
        plant: plant(),
        omega_low: 1.0,
        omega_high: 100.0,
        moving_level: 1.0,
        largest_level: 4.0,
        largest_velocity: 3.5,
        largest_travel: 3.5,
    }
}

#[test]
fn every_effect_of_the_contract_is_listed_once() {
    let mut ids: Vec<&str> = ALL.iter().map(|effect| effect.id()).collect();
    ids.sort_unstable();
    assert_eq!(
        ids,
        [
            "actuator_dead_zone",
            "actuator_saturation",
            "backlash",
            "cogging",
            "flexible_mode",
            "friction_drift",
            "gain_asymmetry",
            "hardening_spring",
            "presliding",
            "quadratic_drag",
            "sensor_lag",
            "slew_limit",
            "spring",
            "static_friction",
            "stribeck",
            "transport_delay",
            "viscous_asymmetry",
        ]
    );
    let imitators = ALL.iter().flat_map(|effect| effect.descriptor().imitators);
    for imitator in imitators {
        assert!(find(imitator).is_some(), "{imitator} is no effect");
    }
}

#[test]
fn the_prior_density_of_a_gap_or_a_stribeck_velocity_falls_in_proportion_below_the_likely_range() {
    for (id, name) in [("backlash", "gap"), ("stribeck", "stribeck_velocity")] {
        let effect = find(id).unwrap();
        let parameter = &effect.parameters()[effect.search().rare_when_small.unwrap()];
        assert_eq!(parameter.name, name);
        let range = (parameter.range)(&scope());
        let share = |times: f64| range.share_of_small(times * range.likely[0]);
        assert_eq!([share(0.25), share(1.0), share(50.0)], [0.25, 1.0, 1.0], "{id}");
    }
}

#[test]
fn the_likely_range_of_every_parameter_lies_within_its_bounds() {
    for effect in ALL {
        for parameter in effect.parameters() {
            let Range { bounds, likely, absent } = (parameter.range)(&scope());
            let name = format!("{} {}", effect.id(), parameter.name);
            assert!(bounds[0] < bounds[1] && likely[0] < likely[1], "{name}");
            assert!(bounds[0] <= likely[0] && likely[1] <= bounds[1], "{name}");
            let logarithmic = parameter.coordinate == Coordinate::Logarithmic;
            let reached = |value: f64| bounds[0] <= value && value <= bounds[1];
            let approached = |value: f64| logarithmic && (value == 0.0 || value.is_infinite());
            assert!(absent.is_none_or(|value| reached(value) || approached(value)), "{name}");
            let positive = parameter.coordinate != Coordinate::Logarithmic || bounds[0] > 0.0;
            assert!(positive, "{name}: the logarithm of a bound");
        }
    }
}

#[test]
fn start_points_lie_within_the_bounds() {
    for effect in ALL {
        for point in effect.start_points(&scope()) {
            assert_eq!(point.len(), effect.parameters().len(), "{}", effect.id());
            for (parameter, value) in effect.parameters().iter().zip(point) {
                let [low, high] = (parameter.range)(&scope()).bounds;
                let name = format!("{} {}", effect.id(), parameter.name);
                assert!(low <= value && value <= high, "{name}: {value}");
            }
        }
    }
}

// With steps of a factor of 2, a quarter of the fits of a joint beside an actuator of order 2 end
// in another local minimum; with 1.25, two of 76 do, both lightly damped.
#[test]
fn starts_of_a_flexible_mode_cover_the_band_in_smaller_steps_for_lighter_damping() {
    let scope = scope();
    let points = find("flexible_mode").unwrap().start_points(&scope);
    let frequency = |point: &[f64]| (point[1] * scope.plant.constant / point[0]).sqrt();
    let ratio = |point: &[f64]| 0.5 * point[2] * frequency(point) / point[1];
    for (damping_ratio, next) in [(0.02, 1.12), (0.07, 1.2), (0.25, 1.4), (0.8, 2.0)] {
        let is_so = |point: &&Vec<f64>| (ratio(point) / damping_ratio - 1.0).abs() < 1e-9;
        let found: Vec<f64> = points.iter().filter(is_so).map(|point| frequency(point)).collect();
        assert!((found[0] / scope.omega_low - 1.0).abs() < 1e-9);
        assert!(found[found.len() - 1] > 1.5 * scope.omega_high);
        assert!(found.windows(2).all(|pair| pair[1] < next * pair[0]), "{found:?}");
    }
}

// With a resonance above ten times the band a contact is an impact, whatever its stiffness. A light
// load can look like a heavier one with another gap.
#[test]
fn starts_of_backlash_range_from_resonances_in_the_band_to_impacts_for_light_and_heavy_loads() {
    let scope = scope();
    let points = find("backlash").unwrap().start_points(&scope);
    for (heavy, gap) in [(false, 1e-3), (true, 1e-3), (false, 1e-2), (true, 1e-2)] {
        let is_so = |point: &&Vec<f64>| {
            (point[0] > 0.2) == heavy && (point[3] / scope.largest_travel > gap) == (gap > 5e-3)
        };
        let frequency = |point: &Vec<f64>| {
            let inertia = point[0] * (1.0 - point[0]) / scope.plant.constant;
            (point[1] / inertia).sqrt()
        };
        let mut found: Vec<f64> = points.iter().filter(is_so).map(frequency).collect();
        found.sort_by(f64::total_cmp);
        assert!(found[0] < 3.0 * scope.omega_low, "{found:?}");
        assert!(found[found.len() - 1] > 3.3 * scope.omega_high, "{found:?}");
        assert!(found.windows(2).all(|pair| pair[1] < 3.01 * pair[0]), "{found:?}");
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

#[test]
fn ranges_follow_the_units_of_the_upload() {
    let Scope { plant, .. } = scope();
    let (input, velocity, second) = (1e3, 1e-2, 7.0);
    let other = Scope {
        plant: Plant {
            viscous_rate_rad_s: plant.viscous_rate_rad_s / second,
            constant: plant.constant * velocity / (input * second),
            friction: Friction::coulomb(0.5 * input, 0.4 * input),
            ..plant
        },
        omega_low: 1.0 / second,
        omega_high: 100.0 / second,
        moving_level: input,
        largest_level: 4.0 * input,
        largest_velocity: 3.5 * velocity,
        largest_travel: 3.5 * velocity * second,
    };
    for effect in ALL {
        for parameter in effect.parameters() {
            let (here, there) = ((parameter.range)(&scope()), (parameter.range)(&other));
            let factor = parameter.dimension.factor(input, velocity, second);
            for (a, b) in here.bounds.iter().zip(there.bounds) {
                let close = (a * factor - b).abs() <= 1e-12 * b.abs();
                assert!(close, "{} {}: {a} {b}", effect.id(), parameter.name);
            }
        }
    }
}

#[test]
fn derivatives_of_every_law_are_those_of_its_values() {
    let base = plant().map(Wide::constant);
    for effect in ALL {
        let values: Vec<f64> =
            (0..effect.parameters().len()).map(|i| 0.6 + 0.2 * i as f64).collect();
        let active = ActiveEffect::new(*effect, values.clone()).unwrap();
        let axis = enter(base, &[active], 0.5, 0);
        let at = |values: &[f64], v: f64, x: f64| -> Option<f64> {
            let active = ActiveEffect::new(*effect, values.to_vec()).unwrap();
            let axis = enter_values(plant(), &[active], 0.5);
            let law = axis.friction_curve.or(axis.torques.first().copied())?;
            Some(law.at(v, x))
        };
        let Some(law) = axis.friction_curve.or(axis.torques.first().copied()) else { continue };
        let lanes = values.len();
        let (v, x) = (0.3, -0.7);
        let exact = law.at(Wide::variable(v, lanes), Wide::variable(x, lanes + 1));
        let h = 1e-5;
        let numeric = |lane: usize| {
            let shifted = |sign: f64| {
                let mut values = values.clone();
                if lane < lanes {
                    values[lane] += sign * h;
                }
                let step = |l: usize| if lane == l { sign * h } else { 0.0 };
                at(&values, v + step(lanes), x + step(lanes + 1)).unwrap()
            };
            (shifted(1.0) - shifted(-1.0)) / (2.0 * h)
        };
        for lane in 0..lanes + 2 {
            // Error of a central difference: h² times the third derivative.
            let error = (exact.lane(lane) - numeric(lane)).abs();
            assert!(error < 1e-8, "{} lane {lane}: {error:e}", effect.id());
        }
    }
}

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
fn an_effect_refuses_another_number_of_parameters() {
    let error = ActiveEffect::new(find("backlash").unwrap(), vec![0.4]).unwrap_err();
    assert_eq!(error.to_string(), "`backlash` takes 4 parameters, not 1");
}

#[test]
fn the_taylor_series_of_a_law_sums_to_the_law_along_the_motion() {
    type Number = crate::plant::Dual<4>;
    let mut tried = 0;
    for effect in ALL {
        let ranges = effect.parameters().iter().map(|p| (p.range)(&scope()));
        let values: Vec<f64> = ranges.map(|r| 0.7 * r.likely[0] + 0.3 * r.likely[1]).collect();
        let active = ActiveEffect::new(*effect, values).unwrap();
        for law in enter_values(plant(), &[active], 0.0).torques {
            if !law.form().has_series() {
                continue;
            }
            tried += 1;
            let lane = std::cell::Cell::new(0);
            let law =
                law.map(|parameter| Number::variable(parameter, lane.replace(lane.get() + 1)));
            // x = 0.3 + 0.02·t − 0.01·t². Lane 3 is the derivative by the initial value 0.3.
            let x = [Number::variable(0.3, 3), Number::constant(0.02), Number::constant(-0.01)];
            let term = |m: usize| x.get(m).copied().unwrap_or(Number::constant(0.0));
            let (mut series, mut sum) = (TaylorSeries::new(true), Number::constant(0.0));
            series.direction = 1.0;
            let t = 0.8_f64;
            for m in 0..MOST_TERMS {
                let value = law.term(&mut series, term(m).value(), m);
                sum += (law.term_derivative(&series, term, m) + value) * t.powi(m as i32);
            }
            let there = x[0] + x[1] * t + x[2] * (t * t);
            let exact = law.at(there, there);
            let size = 1.0 + exact.value().abs();
            // The first omitted term of a ripple is of order (N·0.01)¹³; N is 26 here.
            let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * size.max(b.abs());
            assert!(close(sum.value(), exact.value()), "{}: {sum:?} {exact:?}", effect.id());
            for lane in 0..4 {
                assert!(close(sum.lane(lane), exact.lane(lane)), "{} {lane}", effect.id());
            }
        }
    }
    assert_eq!(tried, 3);
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
