//! Time of the simulation with each effect: microseconds a point on one core, the
//! median over machines and parameters drawn at random, 48 points of 8 harmonics each.
//!
//! `cargo bench --bench effects`, or of some: `cargo bench --bench effects -- spring cogging`

use std::hint::black_box;
use std::time::Instant;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use servoscope_bench::machines::draw::{Draw, draw};
use servoscope_bench::naming::effect_draws::{draw_effect, ids};
use servoscope_core::effects::{ActiveEffect, Wide, find};
use servoscope_core::plant::{Friction, Plant};
use servoscope_core::simulate::{Counts, Excitation, respond, respond_with_sensitivities};

/// Machines of each actuator order.
const MACHINES: u64 = 15;

/// Harmonics 0 to 7.
const HIGHEST: usize = 7;

/// Runs of which the quickest counts.
const RUNS: usize = 3;

struct Case {
    plant: Plant,
    effects: Vec<ActiveEffect>,
    points: Vec<Excitation>,
}

fn case(id: &str, order: u8, seed: u64) -> Case {
    let drawn = draw(order, seed);
    let effect = draw_effect(id, &drawn, &mut ChaCha8Rng::seed_from_u64(seed));
    let values = effect.parameters().iter().map(|(_, value)| *value).collect();
    let known = find(id).expect("an effect of the library");
    let Draw { plant, design, .. } = drawn;
    let last = (design.len() - 1) as f64;
    let point = |(i, (m, omega)): (usize, &(f64, f64))| {
        Excitation::cosine(*omega, *m).at_run_share(i as f64 / last)
    };
    Case {
        plant,
        effects: vec![ActiveEffect::new(known, values).expect("its parameters")],
        points: design.iter().enumerate().map(point).collect(),
    }
}

/// A plant whose every number is a variable, static levels tied to Coulomb levels, and how
/// many there are.
fn variable(plant: &Plant) -> (Plant<Wide>, usize) {
    let mut count = 0;
    let mut next = |value: f64| {
        count += 1;
        Wide::variable(value, count - 1)
    };
    let Friction { fc_plus, fc_minus, .. } = plant.friction;
    let friction = Friction::coulomb(next(fc_plus), next(fc_minus));
    let actuator = plant.actuator.map(&mut next);
    let viscous_rate_rad_s = next(plant.viscous_rate_rad_s);
    let constant = next(plant.constant);
    (Plant { viscous_rate_rad_s, constant, actuator, friction }, count)
}

/// Microseconds a point.
fn time(case: &Case, mut run: impl FnMut(&Excitation)) -> f64 {
    let once = || {
        let begin = Instant::now();
        case.points.iter().for_each(&mut run);
        begin.elapsed().as_secs_f64() * 1e6 / case.points.len() as f64
    };
    std::iter::repeat_with(once).take(RUNS).fold(f64::INFINITY, f64::min)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    // `cargo test --benches` asks for no measurement.
    if !arguments.iter().any(|argument| argument == "--bench") {
        return;
    }
    let asked = |id: &&str| {
        let mut named = arguments.iter().filter(|argument| !argument.starts_with("--")).peekable();
        named.peek().is_none() || named.any(|argument| argument == id)
    };
    println!("microseconds a point: median over {} machines", 3 * MACHINES);
    println!("{:20} {:>9} {:>14}  unanswered", "effect", "response", "with gradient");
    for id in ids().into_iter().filter(|id| asked(id)) {
        let cases: Vec<Case> = (0..3 * MACHINES).map(|i| case(id, (i % 3) as u8, i / 3)).collect();
        let mut unanswered = 0;
        let response = cases.iter().map(|case| {
            time(case, |point| {
                let found = respond(black_box(&case.plant), &case.effects, point, HIGHEST);
                unanswered += usize::from(black_box(found).is_err());
            })
        });
        let response = median(response.collect());
        let gradient = cases.iter().map(|case| {
            let (plant, count) = variable(&case.plant);
            time(case, |point| {
                let effects = &case.effects;
                let found = respond_with_sensitivities(
                    Counts::EvenUnstable,
                    &plant,
                    count,
                    effects,
                    point,
                    HIGHEST,
                );
                let _ = black_box(found);
            })
        });
        let gradient = median(gradient.collect());
        println!("{id:20} {response:9.1} {gradient:14.1}  {:10}", unanswered / RUNS);
    }
}
