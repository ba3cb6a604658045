//! The velocities that were measured.

use std::f64::consts::TAU;

use servoscope_core::answers::{ComparedExperiment, Comparison};

use super::super::canvas::{Anchor, Canvas, NOTE, Trace};
use super::super::panel::{Naming, Panel};
use super::super::scale::{Scale, range};
use super::super::series::{Group, magnitude_label};
use super::super::text::number;

/// Samples of a period on which its extremes are looked for, per harmonic.
const SAMPLES_PER_HARMONIC: usize = 8;

/// What shows and hides the bars.
pub(super) const VELOCITIES: &str = "velocities";

/// The velocities each magnitude reached, as bars below.
pub(super) fn extents(
    canvas: &mut Canvas,
    panel: &Panel,
    groups: &[Group<'_>],
    ranges: &[(usize, [f64; 2])],
    comparison: &Comparison,
    velocity: &str,
) {
    const HEIGHT: f64 = 17.0;
    let top = canvas.y + 20.0;
    let bottom = top + HEIGHT * ranges.len() as f64 + 6.0;
    let below = Panel { top, bottom, y: Scale::linear([0.0, 1.0], [bottom, top]), ..*panel };
    let naming = Naming {
        x: &format!("Velocity ({velocity})"),
        y: "Velocities measured at each magnitude",
        ..Naming::default()
    };
    below.draw(canvas, &[], naming);
    for (row, (index, range)) in ranges.iter().rev().enumerate() {
        let y = top + 3.0 + HEIGHT * (row as f64 + 0.5);
        let [Some(from), Some(to)] = range.map(|v| panel.x.at(v)) else { continue };
        let label = magnitude_label(groups[*index].magnitude, comparison);
        let [lowest, highest] = range.map(|v| number(v, 3));
        let hint = format!("{label}: from {lowest} to {highest} {velocity}");
        let trace = Trace { name: &label, keys: VELOCITIES, hints: true, ..Trace::default() };
        canvas.open_trace(&format!("s{index}"), below.sides(), trace);
        canvas.rectangle("fill", [from, y - 4.0, to.max(from + 1.0), y + 4.0], &hint);
        canvas.close();
        canvas.text(panel.right + 8.0, y + 4.0, NOTE, Anchor::Start, &label);
    }
    canvas.y = bottom + 44.0;
}

/// Lowest and highest velocity at a magnitude.
pub(super) fn velocities(group: &Group<'_>, comparison: &Comparison) -> Option<[f64; 2]> {
    let power = match comparison.response_quantity.as_str() {
        "position" => 1,
        "acceleration" => -1,
        _ => 0,
    };
    let [low, high] = range(group.experiments.iter().flat_map(|e| extremes(e, power)));
    (high > low).then_some([low, high])
}

/// Lowest and highest velocity of a period, from Yₖ·(jkω)^power.
fn extremes(experiment: &ComparedExperiment, power: i32) -> [f64; 2] {
    let highest = experiment.harmonics.last().map_or(1, |h| h.order).max(8);
    let samples = SAMPLES_PER_HARMONIC * highest;
    let mut velocity = vec![0.0; samples];
    for harmonic in &experiment.harmonics {
        let k = harmonic.order as f64;
        if harmonic.order == 0 && power != 0 {
            continue;
        }
        let [re, im] = harmonic.measured;
        let factor = if power == 0 { 1.0 } else { (k * experiment.omega_rad_s).powi(power) };
        // Times j or 1/j.
        let (re, im) = match power {
            1 => (-im * factor, re * factor),
            -1 => (im * factor, -re * factor),
            _ => (re, im),
        };
        for (i, value) in velocity.iter_mut().enumerate() {
            // The angle in whole steps of the grid: exact for any harmonic.
            let step = (i * harmonic.order) % samples;
            let (sin, cos) = (TAU * step as f64 / samples as f64).sin_cos();
            *value += re * cos - im * sin;
        }
    }
    range(velocity)
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::ComparedHarmonic;

    use super::*;

    #[test]
    fn velocities_follow_from_any_kind_of_response() {
        // v = 2 cos ωt − 0.5 cos 3ωt.
        let lines = [(1, 2.0), (3, -0.5)];
        let omega: f64 = 7.0;
        let experiment = |power: i32| ComparedExperiment {
            experiment: 0,
            magnitude: 1.0,
            omega_rad_s: omega,
            run: None,
            harmonics: lines
                .iter()
                .map(|&(order, v)| {
                    let s = order as f64 * omega;
                    let measured = match power {
                        1 => [0.0, -v / s],
                        -1 => [0.0, v * s],
                        _ => [v, 0.0],
                    };
                    let zero = [0.0; 2];
                    ComparedHarmonic { order, input: zero, measured, simulated: zero, std: 1.0 }
                })
                .collect(),
        };
        let truth = (0..10_000).map(|i| {
            let angle = TAU * f64::from(i) / 10_000.0;
            2.0 * angle.cos() - 0.5 * (3.0 * angle).cos()
        });
        let [low, high] = range(truth);
        for power in [0, 1, -1] {
            let [from, to] = extremes(&experiment(power), power);
            // A grid of 64 samples misses an extreme by (π/64)²/2 times its curvature, 7.
            assert!((from - low).abs() < 0.02 && (to - high).abs() < 0.02, "{power}: {from} {to}");
        }
    }
}
