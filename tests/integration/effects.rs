//! Every effect, alone and together, in both simulators.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoscope::benchmark::draw::draw;
use servoscope::benchmark::hidden::{IDS, draw_effect};
use servoscope::benchmark::simulator::{Effect, Settings};
use servoscope::measurement::Complex;
use servoscope::plant::Actuator;

use crate::simulators::{Case, largest_difference};

/// Points of each effect and order.
const POINTS: u64 = 30;

/// A point of a machine's own design, with these effects.
fn cosine(order: u8, ids: &[&str], seed: u64) -> Case {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let drawn = draw(order, seed);
    let effects = ids.iter().map(|id| draw_effect(id, &drawn, rng)).collect();
    let (magnitude, omega_rad_s) = drawn.design[rng.random_range(0..drawn.design.len())];
    let input = vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)];
    Case { plant: drawn.plant, effects, run_share: rng.random(), omega_rad_s, input }
}

/// The same machine under six lines of random sizes and phases, with a mean.
fn general(order: u8, ids: &[&str], seed: u64) -> Case {
    let rng = &mut ChaCha8Rng::seed_from_u64(1000 + seed);
    let case = cosine(order, ids, seed);
    let magnitude = case.input[1].re;
    let line = |_| {
        let size = magnitude * rng.random_range(0.1..=0.6);
        Complex::from_polar(size, rng.random_range(0.0..TAU))
    };
    let mut input = vec![Complex::new(0.05 * magnitude, 0.0)];
    input.extend((0..6).map(line));
    let omega_rad_s = case.omega_rad_s.min(case.plant.viscous_rate_rad_s) / 3.0;
    Case { input, omega_rad_s, ..case }
}

/// How far two simulators are apart, and how often either had no response.
#[derive(Debug, Default)]
struct Agreement {
    compared: usize,
    worst: f64,
    unanswered: [usize; 2],
}

/// Differences as shares of the response that the torques alone would give: near
/// breakaway the response is the small difference of large torques.
fn agreement(cases: impl ParallelIterator<Item = Case>) -> Agreement {
    let settings = Settings::default();
    let one = |case: Case| {
        let both = case.simulate(&settings);
        match (&both.exact, &both.stepped) {
            (Ok(exact), Ok(stepped)) => {
                let lines = case.input.iter().enumerate().skip(1);
                let free = lines.map(|(l, u)| {
                    let s = l as f64 * case.omega_rad_s;
                    (u * case.plant.actuator.response(s) * case.plant.mechanics_response(s)).norm()
                });
                let scale = free.fold(0.0, f64::max);
                let worst = largest_difference(exact, stepped) / scale;
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

fn points(points: u64) -> impl ParallelIterator<Item = (u8, u64)> {
    (0..3 * points).into_par_iter().map(|i| ((i % 3) as u8, i / 3))
}

#[test]
fn every_effect_acts_alike_in_both_simulators_on_cosines() {
    let apart = IDS.map(|id| {
        let found = agreement(points(POINTS).map(|(order, seed)| cosine(order, &[id], seed)));
        println!("{id}: {found:?}");
        (id, found)
    });
    for (id, found) in apart {
        assert!(found.worst < 1e-5, "{id}: {found:?}");
        assert!(found.compared >= 3 * POINTS as usize * 9 / 10, "{id}: {found:?}");
    }
}

#[test]
fn every_effect_acts_alike_in_both_simulators_on_general_inputs() {
    let apart = IDS.map(|id| {
        let found = agreement(points(6).map(|(order, seed)| general(order, &[id], seed)));
        println!("{id}: {found:?}");
        (id, found)
    });
    for (id, found) in apart {
        assert!(found.worst < 1e-5, "{id}: {found:?}");
        assert!(found.compared >= 16, "{id}: {found:?}");
    }
}

/// Three effects that can be in one machine.
fn some_ids(seed: u64) -> Vec<&'static str> {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let mut ids: Vec<&str> = Vec::new();
    while ids.len() < 3 {
        let id = IDS[rng.random_range(0..IDS.len())];
        let two_joints = ["backlash", "flexible_mode"].contains(&id)
            && ids.iter().any(|other| ["backlash", "flexible_mode"].contains(other));
        if !ids.contains(&id) && !two_joints {
            ids.push(id);
        }
    }
    ids
}

#[test]
fn any_three_effects_act_together_in_the_order_of_the_signal_chain() {
    let found = agreement(points(60).map(|(order, seed)| cosine(order, &some_ids(seed), seed)));
    println!("{found:?}");
    assert!(found.worst < 1e-5, "{found:?}");
    assert!(found.compared >= 160, "{found:?}");
}

#[test]
fn an_axis_held_by_what_is_hidden_in_it_answers_with_nothing() {
    let mut case = cosine(0, &[], 1);
    assert_eq!(case.plant.actuator, Actuator::Direct);
    let level = case.plant.friction.fc_plus.max(case.plant.friction.fc_minus);
    case.effects = vec![Effect::StaticFriction { fs_plus: 9.0 * level, fs_minus: 9.0 * level }];
    case.input[1] = Complex::new(8.0 * level, 0.0);
    let both = case.simulate(&Settings::default());
    for response in [both.exact.unwrap(), both.stepped.unwrap()] {
        assert!(response.iter().all(|v| v.norm() == 0.0));
    }
}
