//! Time of the simulation with each effect: microseconds a point on one core, the
//! median over machines and parameters drawn at random, 48 points of 8 harmonics each.
//!
//! `cargo bench --bench effects`, or of some: `cargo bench --bench effects -- spring cogging`

use std::hint::black_box;
use std::time::Instant;

use servoscope_bench::naming::effect_draws::ids;
use servoscope_bench::workloads::axes::AxisWithEffect;
use servoscope_core::simulate::Excitation;

/// Machines of each actuator order.
const MACHINES: u64 = 15;

/// Runs of which the quickest counts.
const RUNS: usize = 3;

/// Microseconds a point.
fn time(axis: &AxisWithEffect, mut run: impl FnMut(&Excitation)) -> f64 {
    let once = || {
        let begin = Instant::now();
        axis.points.iter().for_each(&mut run);
        begin.elapsed().as_secs_f64() * 1e6 / axis.points.len() as f64
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
        let axes: Vec<AxisWithEffect> =
            (0..3 * MACHINES).map(|i| AxisWithEffect::draw(id, (i % 3) as u8, i / 3)).collect();
        let mut unanswered = 0;
        let response = axes.iter().map(|axis| {
            time(axis, |point| {
                unanswered += usize::from(black_box(axis.respond(black_box(point))).is_err());
            })
        });
        let response = median(response.collect());
        let gradient = axes.iter().map(|axis| {
            time(axis, |point| {
                let _ = black_box(axis.respond_with_gradient(black_box(point)));
            })
        });
        let gradient = median(gradient.collect());
        println!("{id:20} {response:9.1} {gradient:14.1}  {:10}", unanswered / RUNS);
    }
}
