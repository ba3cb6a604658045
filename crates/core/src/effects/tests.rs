use super::*;
use crate::plant::{Actuator, Friction, Plant};

mod combinations;
mod laws;
mod start_points;

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
        has_spectra: false,
        moving_level: 1.0,
        largest_level: 4.0,
        steepest_input: 400.0,
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
        has_spectra: false,
        moving_level: input,
        largest_level: 4.0 * input,
        steepest_input: 400.0 * input / second,
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
fn an_effect_refuses_another_number_of_parameters() {
    let error = ActiveEffect::new(find("backlash").unwrap(), vec![0.4]).unwrap_err();
    assert_eq!(error.to_string(), "`backlash` takes 4 parameters, not 1");
}
