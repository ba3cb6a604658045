//! Frequency response at every magnitude, measured and simulated.

pub(super) mod curves;
pub(super) mod points;

use servoscope_core::answers::Comparison;

use super::bands;
use super::canvas::{Anchor, Canvas, LABEL, Marker, WIDTH};
use super::panel::{Key, Look, Naming, Panel, legend};
use super::scale::{DECIMAL, DEGREES, Scale, padded, range};
use super::series::{in_fraction, left_out};
use super::text::{self, number};
use super::{Extended, NothingToDraw, Subject, comparison};
use curves::{Curve, Point, Ratio, curves};
use points::{resting, trace};

/// What the horizontal axis is called.
pub(super) const FREQUENCY: &str = "Frequency (Hz)";

const LEFT: f64 = 64.0;
const RIGHT: f64 = WIDTH - 92.0;
const GAIN_HEIGHT: f64 = 240.0;
const PHASE_HEIGHT: f64 = 180.0;

/// How far below the measured gains a simulated one may take the axis, dB.
const BELOW_MEASURED_DB: f64 = 20.0;

/// Points above which markers are small and have no hints.
pub(super) const FEW_POINTS: usize = 150;

/// What one of the models makes of a point.
pub(super) type Model = fn(&Point) -> Option<Ratio>;

pub(super) fn draw(subject: &Subject<'_>) -> Result<Canvas, NothingToDraw> {
    let comparison = comparison(subject)?;
    let extended = subject.extended;
    let curves = curves(comparison, extended.map(|extended| extended.comparison));
    let points: usize = curves.iter().map(|curve| curve.points.len()).sum();
    if points == 0 {
        return Err(NothingToDraw("no line of the response is a line of the input".into()));
    }
    let quantity = &comparison.response_quantity;
    let title = format!("Frequency response from input to {quantity}");
    let mut canvas = Canvas::new("bode", &title, &says(&curves, extended), curves.len());
    let rests = curves.iter().flat_map(|curve| &curve.points).any(|p| p.measured.is_none());
    let measured = Key::new(Look::Marker(Marker::Circle), "key", "measured");
    let mut keys = vec![measured.toggling("measured")];
    match extended {
        None => keys.push(Key::new(Look::Line("line"), "key", "simulated").toggling("after")),
        Some(Extended { name, .. }) => {
            let name = text::shorten(&format!("simulated {name}"), 11.5, 420.0);
            keys.push(Key::new(Look::Line("line"), "key", name).toggling("after"));
            keys.push(Key::new(Look::Line("thin"), "key", "base model").toggling("before"));
        }
    }
    if rests {
        let rest = Key::new(Look::Beyond, "key", "measured, below the noise");
        keys.push(rest.toggling("measured"));
    }
    let bands = bands::invalid(subject.valid_band);
    if !bands.is_empty() {
        keys.push(bands::key());
    }
    legend(&mut canvas, &keys);
    panels(&mut canvas, comparison, &curves, &bands);
    if let Some(sentence) = left_out(comparison) {
        canvas.note(&sentence);
    }
    Ok(canvas)
}

/// Gain and phase of curves, over each other.
pub(super) fn panels(
    canvas: &mut Canvas,
    comparison: &Comparison,
    curves: &[Curve],
    bands: &[[f64; 2]],
) {
    let every = || curves.iter().flat_map(|curve| &curve.points);
    let [low, high] = range(every().map(|point| point.frequency_hz));
    let x = Scale::log([low / 1.12, high * 1.12], [LEFT, RIGHT]);
    let [gain_range, phase_range] = ranges(curves);
    let few = every().count() <= FEW_POINTS;
    let top = canvas.y + 22.0;
    let bottom = top + GAIN_HEIGHT;
    let y = Scale::linear(gain_range, [bottom, top]);
    let gain = Panel { x, y, left: LEFT, top, right: RIGHT, bottom };
    let gain_name = text::shorten(&gain_name(comparison), 11.5, RIGHT - LEFT);
    let naming = Naming { y: &gain_name, x_below: FREQUENCY, ..Naming::default() };
    bands::shade(canvas, &gain, bands, true);
    gain.draw(canvas, &y.vertical_ticks(DECIMAL), naming);
    trace(canvas, &gain, curves, few, |ratio| ratio.gain_db);
    resting(canvas, &gain, curves);
    labels(canvas, &gain, curves, few);

    let top = bottom + 34.0;
    let bottom = top + PHASE_HEIGHT;
    let y = Scale::linear(phase_range, [bottom, top]);
    let phase = Panel { x, y, left: LEFT, top, right: RIGHT, bottom };
    let naming = Naming { x: FREQUENCY, y: "Phase (degrees)", ..Naming::default() };
    bands::shade(canvas, &phase, bands, false);
    phase.draw(canvas, &y.vertical_ticks(DEGREES), naming);
    trace(canvas, &phase, curves, few, |ratio| ratio.phase_deg);
    canvas.y = bottom + 44.0;
}

/// Ranges of gain, dB, and phase, degrees, that show what was measured and simulated.
pub(super) fn ranges(curves: &[Curve]) -> [[f64; 2]; 2] {
    let every = || curves.iter().flat_map(|curve| &curve.points);
    let gains = |of: Model| every().filter_map(of).map(|ratio| ratio.gain_db);
    let phases = |of: Model| every().filter_map(of).map(|ratio| ratio.phase_deg);
    let [lowest, _] = range(gains(|p| p.measured));
    let floor = if lowest.is_finite() { lowest - BELOW_MEASURED_DB } else { f64::NEG_INFINITY };
    let simulated =
        gains(|p| p.simulated).chain(gains(|p| p.extended)).filter(|gain| *gain > floor);
    let gain = padded(gains(|p| p.measured).chain(simulated), 0.06, 1.0);
    let simulated = phases(|p| p.simulated).chain(phases(|p| p.extended));
    let phase = padded(phases(|p| p.measured).chain(simulated), 0.06, 5.0);
    // Where nothing moves there is nothing to take a range from.
    let or_usual = |[low, high]: [f64; 2], usual: [f64; 2]| {
        if low.is_finite() && high.is_finite() { [low, high] } else { usual }
    };
    [or_usual(gain, [-40.0, 0.0]), or_usual(phase, [-180.0, 0.0])]
}

/// What the axis of the gain is called.
pub(super) fn gain_name(comparison: &Comparison) -> String {
    let (input, response) = (&comparison.input_unit, &comparison.response_unit);
    let reference = match (input.is_empty(), response.is_empty()) {
        (false, false) => format!("{}/{}", in_fraction(response), in_fraction(input)),
        _ => "response unit/input unit".to_owned(),
    };
    format!("Gain (dB re 1 {reference})")
}

/// Names each curve where it ends.
fn labels(canvas: &mut Canvas, panel: &Panel, curves: &[Curve], few: bool) {
    const SPACING: f64 = 16.0;
    let most = (GAIN_HEIGHT / SPACING) as usize;
    let shown = super::series::spread(curves.len(), most);
    let end = |curve: &Curve| {
        let last = curve.points.iter().rev().find_map(|p| p.measured.or(p.simulated));
        let y = last.and_then(|ratio| panel.y.at(ratio.gain_db)).unwrap_or(panel.bottom);
        y.clamp(panel.top, panel.bottom)
    };
    let mut heights: Vec<f64> = shown.iter().map(|i| end(&curves[*i])).collect();
    // Equal ends keep the order of the magnitudes: the largest on top.
    let count = heights.len();
    heights.iter_mut().enumerate().for_each(|(i, y)| *y += 1e-6 * (count - i) as f64);
    text::dodge(&mut heights, SPACING, panel.top + 6.0, panel.bottom - 6.0);
    for (&index, y) in shown.iter().zip(heights) {
        canvas.open(&format!("s{index} measured"));
        let shape = if few { Marker::of(index) } else { Marker::Circle };
        canvas.marker(shape, [panel.right + 12.0, y], 3.2, "");
        canvas.close();
        canvas.open(&format!("s{index}"));
        let label = text::shorten(&curves[index].label, LABEL.size, 64.0);
        canvas.text(panel.right + 21.0, y + 4.0, LABEL, Anchor::Start, &label);
        canvas.close();
    }
}

/// What the figure says, in one line: of the model that has the causes, where
/// there is one.
pub(super) fn says(curves: &[Curve], extended: Option<Extended<'_>>) -> String {
    let (model, named): (Model, String) = match extended {
        None => (|point| point.simulated, String::new()),
        Some(Extended { name, .. }) => (|point| point.extended, format!(" {name}")),
    };
    let mut worst: Option<(f64, f64, String)> = None;
    let mut departures = Vec::new();
    for curve in curves {
        for point in &curve.points {
            let Some((measured, simulated)) = point.measured.zip(model(point)) else { continue };
            let gain = (measured.gain_db - simulated.gain_db).abs();
            let phase = (measured.phase_deg - simulated.phase_deg).abs();
            departures.push(gain);
            if worst.as_ref().is_none_or(|(largest, ..)| gain > *largest) {
                let place = format!("{}, {} Hz", curve.label, number(point.frequency_hz, 3));
                worst = Some((gain, phase, place));
            }
        }
    }
    departures.sort_by(f64::total_cmp);
    match worst {
        None => "Nothing moved, measured or simulated: every point is at rest.".to_owned(),
        Some((gain, phase, place)) => {
            let half = rounded(departures[departures.len() / 2]);
            let (gain, phase) = (rounded(gain), rounded(phase));
            format!(
                "Simulated{named}: median error of the gain {half} dB, largest {gain} dB and \
                 {phase}° ({place})."
            )
        }
    }
}

/// A departure with two digits, and no smaller than a plot could show.
fn rounded(departure: f64) -> String {
    number(departure.max(1e-3), 2)
}
