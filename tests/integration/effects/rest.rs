//! Axes that do not move.

use servoscope_bench::machines::simulator::{Effect, Settings};
use servoscope_core::measurement::Complex;
use servoscope_core::plant::{Actuator, Friction, Plant};

use super::cosine;
use crate::simulators::Case;

// Friction of 0.5 forward and 0.4 backward holds an axis that a torque of less than 0.45
// each way drives, once the spring is bent by as much as the levels differ: from rest it
// creeps there backward, and ever more slowly. A little above, a little motion is left.
#[test]
fn an_axis_that_creeps_to_where_it_sticks_against_a_spring_answers_with_nothing() {
    let plant = Plant {
        constant: 10.0,
        viscous_rate_rad_s: 10.0,
        actuator: Actuator::Direct,
        friction: Friction::coulomb(0.5, 0.4),
    };
    let largest = |effect: Effect, magnitude: f64| {
        let input = vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)];
        let case = Case { plant, effects: vec![effect], run_share: 0.0, omega_rad_s: 20.0, input };
        case.respond(7).unwrap().iter().map(|v| v.norm()).fold(0.0, f64::max)
    };
    let spring = Effect::new("spring", [("stiffness", 1.0)]);
    let hardening =
        Effect::new("hardening_spring", [("stiffness", 0.5), ("cubic_stiffness", 50.0)]);
    for effect in [spring, hardening] {
        assert_eq!(largest(effect, 0.4499), 0.0);
        let above = [0.4501, 0.46, 0.5].map(|magnitude| largest(effect, magnitude));
        assert!(0.0 < above[0] && above[0] < above[1] && above[1] < above[2], "{above:?}");
        assert!(above[0] < 1e-3 * above[2], "{above:?}");
    }
}

#[test]
fn an_axis_held_by_what_is_hidden_in_it_answers_with_nothing() {
    let (mut case, _) = cosine(0, &[], 1);
    assert_eq!(case.plant.actuator, Actuator::Direct);
    let level = case.plant.friction.fc_plus.max(case.plant.friction.fc_minus);
    case.effects =
        vec![Effect::new("static_friction", [("fs_plus", 9.0 * level), ("fs_minus", 9.0 * level)])];
    case.input[1] = Complex::new(8.0 * level, 0.0);
    let both = case.simulate(&Settings::default());
    for response in [both.exact.unwrap(), both.stepped.unwrap()] {
        assert!(response.iter().all(|v| v.norm() == 0.0));
    }
}
