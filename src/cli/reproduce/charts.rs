//! The figures, each named after the paper's.
//!
//! The paper's figures were not to be had but for their captions: what each shows is what its
//! caption and the text say.

mod convergence;
mod over_time;

use servoscope_bench::machines::simulator::SimulatorError;
use servoscope_bench::reproduction::figure_of_merit::{ANSWER, each, median};
use servoscope_bench::reproduction::published::{COLUMNS, seconds};
use servoscope_bench::reproduction::system::System;
use servoscope_bench::reproduction::{Chart, Outcome, Reproduction, Run};
use servoscope_core::answers::Method;
use servoscope_core::measurement::Complex;

use crate::report::figures::Theme;
use crate::report::figures::chart::{self, Bar, Line, Plot, Stroke};

use convergence::convergence_chart;
use over_time::{linear_block, output};

/// Names of the figures of outputs, of the linear block, of its Bode plot, of times, and of
/// convergence.
type Names = ([&'static str; 4], [&'static str; 4]);

fn names(system: System) -> Names {
    match system {
        System::G1 => (
            ["figure-4", "figure-5", "figure-6", "figure-7"],
            ["figure-8a", "figure-8b", "figure-14a", "convergence-g1"],
        ),
        System::G2 => (
            ["figure-9", "figure-10", "figure-11", "figure-12"],
            ["figure-13a", "figure-13b", "figure-14b", "convergence-g2"],
        ),
    }
}

/// Draws every figure that the runs allow.
///
/// # Errors
/// Where an identified plant cannot be simulated.
pub(super) fn charts(reproduction: &Reproduction) -> Result<Vec<Chart>, SimulatorError> {
    let mut all = Vec::new();
    for &system in &reproduction.plan.systems {
        let (outputs, [block, bode, times, convergence]) = names(system);
        let first = |method: Method| {
            let level = reproduction.plan.levels.first().copied().flatten();
            reproduction.of(system, level, method).into_iter().next()
        };
        for (name, (column, method)) in outputs.into_iter().zip(&COLUMNS[1..]) {
            if let Some(run) = first(*method) {
                let closed = first(Method::TwoMagnitude);
                all.push(output(name, system, column, run, closed)?);
            }
        }
        all.push(linear_block(block, system)?);
        if let Some(answer) = first(Method::AbcAnn).and_then(ANSWER) {
            all.push(bode_plot(bode, system, answer, first(Method::TwoMagnitude)));
        }
        all.push(time_bars(times, reproduction, system));
        all.push(convergence_chart(convergence, reproduction, system));
    }
    Ok(all)
}

fn line(label: &str, points: Vec<[f64; 2]>, stroke: Stroke) -> Line {
    Line { label: label.to_owned(), points, stroke }
}

/// Figures 8b and 13b.
fn bode_plot(name: &'static str, system: System, answer: &Outcome, closed: Option<&Run>) -> Chart {
    let [low, high] = system.band_rad_s();
    let frequencies: Vec<f64> =
        (0..=300).map(|i| low * (high / low).powf(f64::from(i) / 300.0)).collect();
    let mut models = vec![("actual system", system.plant(), Stroke::Broad)];
    if let Some(found) = closed.and_then(|run| run.alone.as_ref()) {
        models.push(("two-magnitude", found.plant(system), Stroke::Dashed));
    }
    models.push(("abc-ann", answer.plant(system), Stroke::Solid));
    let mut plots = ["Gain (dB)", "Phase (degrees)"].map(|y| Plot {
        x: "Frequency (rad/s)".into(),
        y: y.into(),
        logarithmic: [true, false],
        ..Plot::default()
    });
    for (label, plant, stroke) in models {
        let response = |omega: f64| {
            let mechanics = plant.constant / Complex::new(plant.viscous_rate_rad_s, omega);
            (plant.actuator.response(omega), mechanics)
        };
        let gain = |omega: f64| {
            let (actuator, mechanics) = response(omega);
            20.0 * (actuator * mechanics).norm().log10()
        };
        // Each turns by less than half a turn: their sum needs no unwrapping.
        let phase = |omega: f64| {
            let (actuator, mechanics) = response(omega);
            (actuator.arg() + mechanics.arg()).to_degrees()
        };
        let gains = frequencies.iter().map(|omega| [*omega, gain(*omega)]).collect();
        let phases = frequencies.iter().map(|omega| [*omega, phase(*omega)]).collect();
        plots[0].lines.push(line(label, gains, stroke));
        plots[1].lines.push(line(label, phases, stroke));
    }
    let title = format!("{}: Bode plot of the linear block", system.name());
    let says = "Identified without noise; abc-ann lies on the actual system.";
    let svg = chart::lines(name, &title, says, &plots, Theme::Auto);
    Chart { name, title, svg }
}

/// Figures 14a and 14b.
fn time_bars(name: &'static str, reproduction: &Reproduction, system: System) -> Chart {
    let mut bars = Vec::new();
    for ((column, method), published) in COLUMNS[1..].iter().zip(seconds(system)) {
        let bar = |group: &str, value| Bar { name: (*column).into(), group: group.into(), value };
        bars.push(bar("published", published));
        let level = reproduction.plan.levels.first().copied().flatten();
        let ours = each(&reproduction.of(system, level, *method), ANSWER, |o| o.seconds);
        if !ours.is_empty() {
            bars.push(bar("here, median", median(&ours)));
        }
    }
    let title = format!("{}: computation time", system.name());
    let says = "Published on a machine that is not stated; here as the document states.";
    let svg = chart::bars(name, &title, says, "Time (s)", &bars, Theme::Auto);
    Chart { name, title, svg }
}
