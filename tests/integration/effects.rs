//! Every effect, alone and together, in both simulators.

mod derivatives;

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoscope_bench::machines::draw::{Draw, draw};
use servoscope_bench::machines::simulator::{Effect, Settings};
use servoscope_bench::naming::effect_draws::{draw_effect, ids};
use servoscope_core::effects::{self, ActiveEffect};
use servoscope_core::measurement::Complex;
use servoscope_core::plant::{Actuator, Friction, Plant};
use servoscope_core::simulate::{Counts, Excitation, NoResponse, respond, respond_if};

use crate::reference;
use crate::simulators::{Case, largest_difference};

/// Points of each effect and order where there is time.
const POINTS: u64 = 30;

/// A point of a machine's own design, with these effects, and about the largest response
/// of the whole design.
fn cosine(order: u8, ids: &[&str], seed: u64) -> (Case, f64) {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let drawn = draw(order, seed);
    let effects = ids.iter().map(|id| draw_effect(id, &drawn, rng)).collect();
    let (magnitude, omega_rad_s) = drawn.design[rng.random_range(0..drawn.design.len())];
    let input = vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)];
    let plant = drawn.plant;
    let level = 0.5 * (plant.friction.fc_plus + plant.friction.fc_minus);
    let response = |(m, omega): &(f64, f64)| {
        let torque = m * plant.actuator.response(*omega).norm() - level;
        torque * plant.mechanics_response(*omega).norm()
    };
    let largest = drawn.design.iter().map(response).fold(0.0, f64::max);
    (Case { plant, effects, run_share: rng.random(), omega_rad_s, input }, largest)
}

/// The same machine under six lines of random sizes and phases, with a mean.
fn general(order: u8, ids: &[&str], seed: u64) -> (Case, f64) {
    let rng = &mut ChaCha8Rng::seed_from_u64(1000 + seed);
    let (case, largest) = cosine(order, ids, seed);
    let magnitude = case.input[1].re;
    let line = |_| {
        let size = magnitude * rng.random_range(0.1..=0.6);
        Complex::from_polar(size, rng.random_range(0.0..TAU))
    };
    let mut input = vec![Complex::new(0.05 * magnitude, 0.0)];
    input.extend((0..6).map(line));
    let omega_rad_s = case.omega_rad_s.min(case.plant.viscous_rate_rad_s) / 3.0;
    (Case { input, omega_rad_s, ..case }, largest)
}

/// How far two simulators are apart, and how often either had no response.
#[derive(Debug, Default)]
struct Agreement {
    compared: usize,
    worst: f64,
    unanswered: [usize; 2],
}

/// Differences as shares of the largest response of the machine's design, as the contract
/// takes them of a file.
fn agreement(cases: impl ParallelIterator<Item = (Case, f64)>) -> Agreement {
    let settings = Settings::default();
    let one = |(case, largest): (Case, f64)| {
        let both = case.simulate(&settings);
        match (&both.exact, &both.stepped) {
            (Ok(exact), Ok(stepped)) => {
                let worst = largest_difference(exact, stepped) / largest;
                if worst > 1e-5 {
                    println!("{worst:.1e}: {case:?}");
                }
                Agreement { compared: 1, worst, unanswered: [0, 0] }
            }
            (exact, stepped) => {
                println!("{:?} {:?}: {case:?}", exact.as_ref().err(), stepped.as_ref().err());
                let missing = [exact.is_err(), stepped.is_err()].map(usize::from);
                Agreement { unanswered: missing, ..Agreement::default() }
            }
        }
    };
    cases.map(one).reduce(Agreement::default, |a, b| Agreement {
        compared: a.compared + b.compared,
        worst: a.worst.max(b.worst),
        unanswered: [0, 1].map(|i| a.unanswered[i] + b.unanswered[i]),
    })
}

// Of 1000 draws the least and the largest lie within 1 % of the ends of their range, seldom
// further: no reference stands so near one.
#[test]
fn the_benchmark_draws_effects_such_as_those_of_the_references() {
    for name in reference::names() {
        let Some((id, parameters)) = reference::effect(&name) else { continue };
        let plant = reference::plant(&name);
        let machine = Draw { plant, ..reference::g_draw(plant.actuator.order()) };
        let rng = &mut ChaCha8Rng::seed_from_u64(1);
        let drawn: Vec<_> =
            (0..1000).map(|_| draw_effect(&id, &machine, rng).parameters()).collect();
        for (i, (parameter, _)) in drawn[0].iter().enumerate() {
            let of_this = drawn.iter().map(|parameters| parameters[i].1);
            let least = of_this.clone().fold(f64::INFINITY, f64::min);
            let most = of_this.fold(f64::NEG_INFINITY, f64::max);
            let value = parameters[*parameter];
            assert!((least..=most).contains(&value), "{name}: {parameter} {least} {value} {most}");
        }
    }
}

/// What the contract allows against the reference, of the file's largest component.
fn allowed(id: &str) -> f64 {
    if id == "backlash" { 5e-5 } else { 1e-5 }
}

fn points(points: u64) -> impl ParallelIterator<Item = (u8, u64)> {
    (0..3 * points).into_par_iter().map(|i| ((i % 3) as u8, i / 3))
}

#[test]
#[ignore = "slow: thousands of points stepped through time"]
fn every_effect_acts_alike_in_both_simulators_on_cosines() {
    let apart = ids().into_iter().map(|id| {
        let found = agreement(points(POINTS).map(|(order, seed)| cosine(order, &[id], seed)));
        println!("{id}: {found:?}");
        (id, found)
    });
    for (id, found) in apart {
        assert!(found.worst < allowed(id), "{id}: {found:?}");
        assert!(found.compared >= 3 * POINTS as usize * 9 / 10, "{id}: {found:?}");
    }
}

#[test]
#[ignore = "slow: thousands of points stepped through time"]
fn every_effect_acts_alike_in_both_simulators_on_general_inputs() {
    let apart = ids().into_iter().map(|id| {
        let found = agreement(points(6).map(|(order, seed)| general(order, &[id], seed)));
        println!("{id}: {found:?}");
        (id, found)
    });
    for (id, found) in apart {
        assert!(found.worst < allowed(id), "{id}: {found:?}");
        assert!(found.compared >= 16, "{id}: {found:?}");
    }
}

#[test]
fn every_effect_acts_alike_in_both_simulators_on_a_few_points() {
    for id in ids() {
        let found = agreement((0..2_u64).into_par_iter().map(|seed| cosine(1, &[id], seed)));
        assert!(found.compared == 2 && found.worst < allowed(id), "{id}: {found:?}");
    }
}

// Every point of some designs: such an instant is met by one in a hundred. Across the largest
// gaps impacts may never come to repeat.
#[test]
fn contacts_that_come_the_instant_a_step_begins_leave_a_response_in_numbers() {
    let backlash = effects::find("backlash").unwrap();
    let answered = (0..21_u64).into_par_iter().map(|i| {
        let drawn = draw((i % 3) as u8, i / 3);
        let effect = draw_effect("backlash", &drawn, &mut ChaCha8Rng::seed_from_u64(i / 3));
        let values = effect.parameters().iter().map(|(_, value)| *value).collect();
        let effects = [ActiveEffect::new(backlash, values).unwrap()];
        let velocity = |(magnitude, omega): &(f64, f64)| {
            respond(&drawn.plant, &effects, &Excitation::cosine(*omega, *magnitude), 7).ok()
        };
        let velocities: Vec<_> = drawn.design.iter().filter_map(velocity).collect();
        assert!(velocities.iter().flatten().all(|v| v.is_finite()), "{i}: {velocities:?}");
        velocities.len()
    });
    let answered: usize = answered.sum();
    assert!(answered > 21 * 48 * 9 / 10, "{answered}");
}

/// Every point of a machine's own design, with this effect.
fn design(order: u8, id: &str, seed: u64) -> Vec<Case> {
    let drawn = draw(order, seed);
    let effect = draw_effect(id, &drawn, &mut ChaCha8Rng::seed_from_u64(seed));
    let last = (drawn.design.len() - 1) as f64;
    let point = |(i, &(magnitude, omega_rad_s)): (usize, &(f64, f64))| Case {
        plant: drawn.plant,
        effects: vec![effect],
        run_share: i as f64 / last,
        omega_rad_s,
        input: vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)],
    };
    drawn.design.iter().enumerate().map(point).collect()
}

#[test]
fn no_point_of_an_axis_with_a_restoring_or_a_balancing_torque_goes_unanswered() {
    for id in ["spring", "hardening_spring", "cogging"] {
        (0..45_u64).into_par_iter().for_each(|i| {
            for case in design((i % 3) as u8, id, i / 3) {
                case.respond(7).unwrap_or_else(|error| panic!("{error}: {case:?}"));
            }
        });
    }
}

// A curve a thousandth as wide as the motion is fast ends in the last instants before a stop,
// which a step that goes on beyond it need not meet.
#[test]
fn friction_that_falls_just_before_a_stop_acts_alike_in_both_simulators() {
    let sharp = |case: Case, fastest: f64| {
        let stribeck_velocity = 1e-3 * fastest;
        Case {
            effects: vec![Effect::new(
                "stribeck",
                [("fs_over_fc", 1.3), ("stribeck_velocity", stribeck_velocity)],
            )],
            ..case
        }
    };
    let cases = (0..6_u64).into_par_iter().map(|seed| {
        let (case, fastest) = cosine((seed % 3) as u8, &[], seed);
        (sharp(case, fastest), fastest)
    });
    let found = agreement(cases);
    assert!(found.compared == 6 && found.worst < allowed("stribeck"), "{found:?}");
}

// A tenth of what the contract allows, of the largest response of the design; the two
// simulators are 4e-7 apart in such points.
#[test]
fn points_where_newtons_method_takes_long_are_those_of_the_other_simulator() {
    let points = [
        ("spring", 1, 2, 12),
        ("hardening_spring", 1, 1, 12),
        ("hardening_spring", 1, 5, 29),
        ("hardening_spring", 1, 6, 12),
        ("hardening_spring", 1, 6, 31),
        ("cogging", 0, 2, 0),
        ("cogging", 0, 2, 16),
        ("cogging", 0, 2, 33),
        ("cogging", 1, 2, 28),
        ("cogging", 2, 11, 13),
        ("cogging", 2, 14, 16),
    ];
    points.into_par_iter().for_each(|(id, order, seed, point)| {
        let cases = design(order, id, seed);
        let sizes = cases.iter().flat_map(|case| case.respond(7).unwrap()).map(|v| v.norm());
        let largest = sizes.fold(0.0, f64::max);
        let both = cases[point].simulate(&Settings::default());
        let apart = largest_difference(&both.exact.unwrap(), &both.stepped.unwrap()) / largest;
        assert!(apart < 1e-6, "{id} {order} {seed} {point}: {apart:e}");
    });
}

/// An axis with play (ρ, k, c and gap) in a point of its own.
fn with_play(
    plant: Plant,
    [load_inertia_fraction, stiffness, damping, gap]: [f64; 4],
    magnitude: f64,
    omega_rad_s: f64,
) -> Case {
    let effects = vec![Effect::new(
        "backlash",
        [
            ("load_inertia_fraction", load_inertia_fraction),
            ("stiffness", stiffness),
            ("damping", damping),
            ("gap", gap),
        ],
    )];
    let input = vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)];
    Case { plant, effects, run_share: 0.0, omega_rad_s, input }
}

/// One whose impacts depend on the joint's damping and on the point.
fn rattling(damping: f64, magnitude: f64, omega_rad_s: f64) -> Case {
    let actuator =
        Actuator::SecondOrder { natural_frequency_rad_s: 6.245474, damping_ratio: 0.5944140 };
    let friction = Friction::coulomb(0.2888457, 0.3872526);
    let plant = Plant { constant: 1.660596, viscous_rate_rad_s: 3.042747, actuator, friction };
    with_play(plant, [0.182259, 59.97234, damping, 0.004244359], magnitude, omega_rad_s)
}

// At low frequencies the axis rests for long, and the load drifts from end to end of its gap,
// its twist a straight line. The tolerance is half of the contract's, of the largest response here.
#[test]
fn a_load_that_drifts_in_its_gap_while_the_axis_rests_touches_alike_in_both_simulators() {
    let plant = Plant {
        constant: 7.448064,
        viscous_rate_rad_s: 4.496167,
        actuator: Actuator::FirstOrder { corner_rad_s: 10.42757 },
        friction: Friction::coulomb(0.1064672, 0.1157884),
    };
    let joint = [0.2376795, 680.8241, 0.94244, 1.4817e-4];
    let slow = [0.67, 0.89, 1.18, 1.56, 2.07, 2.74, 3.62];
    (0..3 * slow.len()).into_par_iter().for_each(|i| {
        let (magnitude, omega_rad_s) = (0.2219 * [1.0, 2.0, 4.0][i % 3], slow[i / 3]);
        let both = with_play(plant, joint, magnitude, omega_rad_s).simulate(&Settings::default());
        let apart = largest_difference(&both.exact.unwrap(), &both.stepped.unwrap());
        assert!(apart < 1e-5, "{magnitude} {omega_rad_s}: {apart:e}");
    });
}

// Multipliers of the motions that Newton's method comes to first: −3.7 and 3.6. The tolerance
// is the contract's, of the largest response of a design that has both points.
#[test]
fn a_periodic_motion_in_which_no_axis_stays_is_not_the_response() {
    for (magnitude, omega_rad_s) in [(0.865747, 3.003098), (1.731494, 12.337548)] {
        let case = rattling(0.3670977, magnitude, omega_rad_s);
        let both = case.simulate(&Settings::default());
        let apart = largest_difference(&both.exact.unwrap(), &both.stepped.unwrap());
        assert!(apart < 5e-5 * 0.4, "{magnitude} {omega_rad_s}: {apart:e}");
    }
}

// Newton's method from the end of the first period ends in another motion. The tolerance is the
// contract's, of the response itself.
#[test]
fn of_several_motions_that_repeat_the_one_reached_from_rest_is_the_response() {
    let plant = Plant {
        constant: 3.493069,
        viscous_rate_rad_s: 12.23117,
        actuator: Actuator::FirstOrder { corner_rad_s: 68.11610 },
        friction: Friction::coulomb(0.7032706, 0.6551141),
    };
    let joint = [0.03779108, 23.32777, 0.3579927, 0.009293163];
    let apart = with_play(plant, joint, 1.5987, 22.798).difference();
    assert!(apart < 5e-5, "{apart:e}");
}

#[test]
fn where_impacts_never_come_to_repeat_there_is_no_response_but_something_to_go_on_from() {
    for (magnitude, omega_rad_s) in [(1.7315, 3.359038), (0.8657, 3.412783)] {
        let case = rattling(0.1, magnitude, omega_rad_s);
        let both = case.simulate(&Settings::default());
        assert!(both.stepped.is_err(), "{magnitude} {omega_rad_s}");
        let exact = both.exact.unwrap_err();
        assert!(matches!(exact, NoResponse::NotPeriodic { .. }), "{exact}");
        let (effects, excitation) = (case.active(), case.excitation());
        let unstable =
            respond_if(Counts::EvenUnstable, &case.plant, &effects, &excitation, 7).unwrap();
        assert!(unstable[1].norm() > 0.0 && unstable.iter().all(|v| v.is_finite()));
    }
}

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

/// Three effects that can be in one machine.
fn some_ids(seed: u64) -> Vec<&'static str> {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let (known, mut ids) = (ids(), Vec::<&str>::new());
    while ids.len() < 3 {
        let id = known[rng.random_range(0..known.len())];
        let two_joints = ["backlash", "flexible_mode"].contains(&id)
            && ids.iter().any(|other| ["backlash", "flexible_mode"].contains(other));
        if !ids.contains(&id) && !two_joints {
            ids.push(id);
        }
    }
    ids
}

#[test]
#[ignore = "slow: thousands of points stepped through time"]
fn any_three_effects_act_together_in_the_order_of_the_signal_chain() {
    let found = agreement(points(60).map(|(order, seed)| cosine(order, &some_ids(seed), seed)));
    println!("{found:?}");
    assert!(found.worst < 5e-5, "{found:?}");
    assert!(found.compared >= 160, "{found:?}");
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
