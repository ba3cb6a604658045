//! Measured points of a Bode diagram, and the lines of the models.

use super::super::canvas::{Canvas, Marker, Trace};
use super::super::panel::Panel;
use super::super::text::number;
use super::Model;
use super::curves::{Curve, Point, Ratio};

/// Measured points and simulated lines of every curve.
pub(in crate::report::figures) fn trace(
    canvas: &mut Canvas,
    panel: &Panel,
    curves: &[Curve],
    few: bool,
    value: fn(Ratio) -> f64,
) {
    let is_extended = curves.iter().flat_map(|curve| &curve.points).any(|p| p.extended.is_some());
    let models: &[(&str, &str, &str, Model)] = match is_extended {
        false => &[("line", "after", "simulated", |point| point.simulated)],
        true => &[
            ("thin", "before", "base model", |point| point.simulated),
            ("line", "after", "with causes", |point| point.extended),
        ],
    };
    for (index, curve) in curves.iter().enumerate() {
        for (style, key, name, model) in models {
            let keys = format!("{key} s{index}");
            let trace = Trace { series: &curve.label, name, keys: &keys, hints: false };
            canvas.open_trace(&format!("s{index} simulated"), panel.sides(), trace);
            simulated(canvas, panel, curve, style, |point| model(point).map(value));
            canvas.close();
        }
    }
    for (index, curve) in curves.iter().enumerate() {
        let (look, shape, radius) = match few {
            true => ("measured", Marker::of(index), 3.2),
            false => ("dense", Marker::Circle, 1.7),
        };
        let keys = format!("measured s{index}");
        let trace = Trace { series: &curve.label, name: "measured", keys: &keys, hints: false };
        canvas.open_inside(&format!("s{index} {look} data"), panel.sides(), trace);
        for point in &curve.points {
            let Some(ratio) = point.measured else { continue };
            let Some(place) = panel.at(point.frequency_hz, value(ratio)) else { continue };
            let hint = if few { hint(curve, point) } else { String::new() };
            canvas.marker(shape, place, radius, &hint);
        }
        canvas.close();
    }
}

/// The line of a model, in a curve's colour.
fn simulated(
    canvas: &mut Canvas,
    panel: &Panel,
    curve: &Curve,
    style: &str,
    value: impl Fn(&Point) -> Option<f64>,
) {
    let line = curve.points.iter();
    canvas.polyline(style, line.map(|p| panel.at(p.frequency_hz, value(p)?)));
    // A point without neighbours is no line: a dash stands for it.
    for (i, point) in curve.points.iter().enumerate() {
        let beside = [i.checked_sub(1), Some(i + 1)].into_iter().flatten();
        let joined = beside.filter_map(|n| curve.points.get(n)).any(|p| value(p).is_some());
        let Some(value) = value(point).filter(|_| !joined) else { continue };
        if let Some([x, y]) = panel.at(point.frequency_hz, value) {
            canvas.line(style, [x - 8.0, y], [x + 8.0, y]);
        }
    }
}

/// What did not move, at the lower edge.
pub(in crate::report::figures) fn resting(canvas: &mut Canvas, panel: &Panel, curves: &[Curve]) {
    for (index, curve) in curves.iter().enumerate() {
        let resting: Vec<&Point> = curve.points.iter().filter(|p| p.measured.is_none()).collect();
        if resting.is_empty() {
            continue;
        }
        let keys = format!("measured s{index}");
        let trace = Trace { keys: &keys, ..Trace::default() };
        canvas.open_inside(&format!("s{index} rest data"), panel.sides(), trace);
        // One above the other, where several magnitudes rest at a frequency.
        let y = panel.bottom - 6.0 - 8.0 * index.min(6) as f64;
        for point in resting {
            let Some(x) = panel.x.at(point.frequency_hz) else { continue };
            canvas.marker(Marker::Beyond, [x, y], 3.6, &hint(curve, point));
        }
        canvas.close();
    }
}

fn hint(curve: &Curve, point: &Point) -> String {
    let ratio = |ratio: Option<Ratio>| match ratio {
        Some(Ratio { gain_db, phase_deg }) => {
            format!("{} dB, {}°", number(gain_db, 4), number(phase_deg, 4))
        }
        None => "at rest".to_owned(),
    };
    let (measured, simulated) = (ratio(point.measured), ratio(point.simulated));
    let frequency = number(point.frequency_hz, 4);
    let extended =
        point.extended.map(|extended| format!("; with causes {}", ratio(Some(extended))));
    let extended = extended.unwrap_or_default();
    format!(
        "{} at {frequency} Hz: measured {measured}; simulated {simulated}{extended}",
        curve.label
    )
}
