//! The figures, each named after the paper's.
//!
//! The paper's figures were not to be had but for their captions: what each shows is what its
//! caption and the text say.

use std::f64::consts::TAU;

use servoscope_bench::machines::simulator::{
    Machine, Motion, Samples, Settings, SimulatorError, Start, follow,
};
use servoscope_bench::reproduction::figure_of_merit::{ANSWER, each, median};
use servoscope_bench::reproduction::published::{COLUMNS, seconds};
use servoscope_bench::reproduction::system::{MAGNITUDES, System};
use servoscope_bench::reproduction::{Chart, Outcome, Reproduction, Run};
use servoscope_core::answers::{ConvergenceRow, Method};
use servoscope_core::plant::Plant;

use crate::report::figures::Theme;
use crate::report::figures::chart::{self, Bar, Line, Plot, Stroke};

/// Samples a period, and periods shown.
const SAMPLES: usize = 400;
const PERIODS: usize = 2;

/// Frequency of the input in the time domain: the pole, rad/s.
const OMEGA_RAD_S: f64 = 10.0;

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

fn input() -> Vec<f64> {
    let angle = |i: usize| TAU * i as f64 / SAMPLES as f64;
    (0..=SAMPLES * PERIODS).map(|i| MAGNITUDES[0] * angle(i).cos()).collect()
}

fn step_s() -> f64 {
    TAU / OMEGA_RAD_S / SAMPLES as f64
}

/// The motion from rest, by the simulator that made the data.
fn motion(plant: Plant) -> Result<Motion, SimulatorError> {
    let samples = Samples { step_s: step_s(), values: &input(), hold: false };
    follow(&Machine::base(plant), 0.0, &samples, &Start::default(), &Settings::default())
}

fn over_time(values: impl IntoIterator<Item = f64>) -> Vec<[f64; 2]> {
    values.into_iter().enumerate().map(|(i, value)| [i as f64 * step_s(), value]).collect()
}

fn line(label: &str, points: Vec<[f64; 2]>, stroke: Stroke) -> Line {
    Line { label: label.to_owned(), points, stroke }
}

/// Figures 4 to 7 and 9 to 12.
fn output(
    name: &'static str,
    system: System,
    column: &str,
    run: &Run,
    closed: Option<&Run>,
) -> Result<Chart, SimulatorError> {
    let actual = motion(system.plant())?.velocity;
    let mut models: Vec<(String, &Outcome, Stroke)> = Vec::new();
    let method = run.method.name();
    if let Some(found) = closed.and_then(|run| run.alone.as_ref()) {
        models.push(("two-magnitude".into(), found, Stroke::Dashed));
    }
    if let Some(found) = &run.alone {
        models.push((format!("{method}, search alone"), found, Stroke::Solid));
    }
    if let Some(found) = &run.refined {
        models.push((format!("{method}, refined"), found, Stroke::Solid));
    }
    let mut outputs = vec![line("actual system", over_time(actual.clone()), Stroke::Broad)];
    let mut deviations = Vec::new();
    for (label, outcome, stroke) in models {
        let velocity = motion(outcome.plant(system))?.velocity;
        let off = velocity.iter().zip(&actual).map(|(v, a)| (v - a).abs());
        deviations.push(line(&label, over_time(off), stroke));
        outputs.push(line(&label, over_time(velocity), stroke));
    }
    let x = "Time (s)".to_owned();
    let plots = [
        Plot {
            x: x.clone(),
            y: "Output (response units)".into(),
            lines: outputs,
            ..Plot::default()
        },
        Plot {
            x,
            y: "Distance from the actual output (response units)".into(),
            logarithmic: [false, true],
            floor: Some(1e-12),
            lines: deviations,
        },
    ];
    let title = format!("{}: output of {column} against the actual system", system.name());
    let says = format!(
        "From rest under {} cos({OMEGA_RAD_S}t); models identified without noise, seed {}.",
        MAGNITUDES[0], run.seed
    );
    let svg = chart::lines(name, &title, &says, &plots, Theme::Auto);
    Ok(Chart { name, title, svg })
}

/// Figures 8a and 13a.
fn linear_block(name: &'static str, system: System) -> Result<Chart, SimulatorError> {
    let plant = system.plant();
    let motion = motion(plant)?;
    // What the mechanics is driven by, friction taken off: (v' + a v)/K.
    let driven =
        motion.acceleration.iter().zip(&motion.velocity).map(|(acceleration, v)| {
            (acceleration + plant.viscous_rate_rad_s * v) / plant.constant
        });
    let plots = [Plot {
        x: "Time (s)".into(),
        y: "Input units, response units".into(),
        lines: vec![
            line("excitation u", over_time(input()), Stroke::Dashed),
            line("input of the linear block, friction taken off", over_time(driven), Stroke::Solid),
            line("output of the linear block", over_time(motion.velocity.clone()), Stroke::Solid),
        ],
        ..Plot::default()
    }];
    let title = format!("{}: input and output of the linear block", system.name());
    let says = match system {
        System::G1 => "From rest; the input jumps where the motion turns, by Fc⁺ + Fc⁻.",
        System::G2 => {
            "From rest; the block shown is the mechanics, behind the actuator, where friction acts."
        }
    };
    let svg = chart::lines(name, &title, says, &plots, Theme::Auto);
    Ok(Chart { name, title, svg })
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
            let mechanics = plant.constant
                / servoscope_core::measurement::Complex::new(plant.viscous_rate_rad_s, omega);
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

/// Convergence of all methods on one axis.
fn convergence_chart(name: &'static str, reproduction: &Reproduction, system: System) -> Chart {
    // With noise the cost has a floor that means something.
    let levels = &reproduction.plan.levels;
    let level = levels.iter().copied().flatten().next();
    let histories = reproduction.plan.methods.iter().filter_map(|method| {
        let run = reproduction.of(system, level, *method).into_iter().next()?;
        Some((method.name(), progress(&run.history))).filter(|(_, points)| points.len() > 1)
    });
    // Neighbours in the order of colours are alike: every other one is dashed.
    let strokes = [Stroke::Solid, Stroke::Dashed].into_iter().cycle();
    let lines = histories.zip(strokes).map(|((name, points), stroke)| line(name, points, stroke));
    let plots = [Plot {
        x: "Simulations of the whole measurement (–)".into(),
        y: "Least cost so far (–)".into(),
        logarithmic: [true, true],
        floor: None,
        lines: lines.collect(),
    }];
    let title = format!("{}: convergence of every method", system.name());
    let noise = level.map_or("without noise".to_owned(), |db| format!("at {db} dB"));
    let says = format!(
        "Seed {}, {noise}; a network's training counts, and its answer stands at its end.",
        reproduction.plan.seeds.start()
    );
    let svg = chart::lines(name, &title, &says, &plots, Theme::Auto);
    Chart { name, title, svg }
}

/// Least cost over all evaluations so far; the rows of a network are losses, not costs.
fn progress(rows: &[ConvergenceRow]) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    let (mut before, mut stage, mut used) = (0, "", 0);
    let mut best = f64::INFINITY;
    for row in rows {
        if row.stage != stage {
            before += used;
            stage = &row.stage;
        }
        used = row.evaluations;
        if stage != "network" && row.best < f64::MAX {
            best = best.min(row.best);
            points.push([(before + used).max(1) as f64, best]);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_adds_up_over_stages_and_leaves_losses_out() {
        let row = |stage: &str, evaluations, best| ConvergenceRow {
            stage: stage.into(),
            cycle: 0,
            evaluations,
            best,
            mean: None,
            elapsed_s: 0.0,
        };
        let rows = [
            row("closed_form", 1, 9.0),
            row("network", 800, 0.1),
            row("network", 800, 0.05),
            row("colony", 10, 20.0),
            row("colony", 30, 5.0),
            row("refinement", 2, 4.0),
        ];
        let found = progress(&rows);
        assert_eq!(found, [[1.0, 9.0], [811.0, 9.0], [831.0, 5.0], [833.0, 4.0]]);
    }

    #[test]
    fn the_input_of_the_linear_block_is_what_friction_leaves_of_the_torque() {
        let plant = System::G1.plant();
        let motion = motion(plant).unwrap();
        for ((u, v), acceleration) in input().iter().zip(&motion.velocity).zip(&motion.acceleration)
        {
            let driven = (acceleration + plant.viscous_rate_rad_s * v) / plant.constant;
            let level = if *v > 0.0 { 0.5 } else { -0.4 };
            // Away from a turn, where the direction is clear.
            if v.abs() > 0.05 {
                assert!((u - driven - level).abs() < 1e-9, "{u} {driven}");
            }
        }
    }
}
