//! Figures of the time domain: outputs, and the signals of the linear block.

use std::f64::consts::TAU;

use servoscope_bench::machines::simulator::{
    Machine, Motion, Samples, Settings, SimulatorError, Start, follow,
};
use servoscope_bench::reproduction::system::{MAGNITUDES, System};
use servoscope_bench::reproduction::{Chart, Outcome, Run};
use servoscope_core::plant::Plant;

use crate::report::figures::Theme;
use crate::report::figures::chart::{self, Plot, Stroke};

use super::line;

/// Samples a period, and periods shown.
const SAMPLES: usize = 400;
const PERIODS: usize = 2;

/// Frequency of the input in the time domain: the pole, rad/s.
const OMEGA_RAD_S: f64 = 10.0;

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

/// Figures 4 to 7 and 9 to 12.
pub(super) fn output(
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
pub(super) fn linear_block(name: &'static str, system: System) -> Result<Chart, SimulatorError> {
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

#[cfg(test)]
mod tests {
    use super::*;

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
