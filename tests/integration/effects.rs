//! Every effect, alone and together, in both simulators.

mod contacts;
mod derivatives;
mod rest;

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoscope_bench::machines::draw::{Draw, draw};
use servoscope_bench::machines::simulator::{Effect, Settings};
use servoscope_bench::naming::effect_draws::{draw_effect, ids};
use servoscope_core::measurement::Complex;

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
