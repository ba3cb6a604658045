//! Frequency response before and after, and beneath it what each model leaves: gain in dB and phase
//! in degrees, against the noise.

mod layout;
mod reach;

use servoscope_core::answers::Comparison;

use super::bands::{self, invalid, shade};
use super::bode::curves::{Curve, Point, curves};
use super::bode::points::{resting, trace};
use super::bode::{FEW_POINTS, FREQUENCY, Model, gain_name, ranges, says};
use super::canvas::{Canvas, Marker, NOTE, Trace};
use super::panel::{Key, Look, Naming, Panel, legend};
use super::scale::{DECIMAL, DEGREES, Scale, range};
use super::series::{left_out, spread};
use super::text;
use super::{NothingToDraw, Subject, comparison};
use layout::{Layout, PHONE, WIDE};
use reach::{Column, DB_PER_SHARE, NOISE_BAND, beyond, size};

const RESPONSE_HEIGHT: f64 = 212.0;
const ERROR_HEIGHT: f64 = 132.0;

/// Magnitudes that the legend names.
const MOST_KEYS: usize = 8;

pub(super) fn draw(subject: &Subject<'_>) -> Result<Canvas, NothingToDraw> {
    drawn(subject, &WIDE)
}

/// The same for a phone: the phase beneath the gain.
pub(super) fn draw_for_phone(subject: &Subject<'_>) -> Result<Canvas, NothingToDraw> {
    drawn(subject, &PHONE)
}

fn drawn(subject: &Subject<'_>, layout: &Layout) -> Result<Canvas, NothingToDraw> {
    let comparison = comparison(subject)?;
    let extended = subject.extended;
    let curves = curves(comparison, extended.map(|extended| extended.comparison));
    if curves.iter().all(|curve| curve.points.is_empty()) {
        return Err(NothingToDraw("no line of the response is a line of the input".into()));
    }
    let title = format!("Measured and simulated {}", comparison.response_quantity);
    let says = says(&curves, extended);
    let mut canvas = Canvas::of_width(layout.width, "bode-errors", &title, &says, curves.len());
    let bands = invalid(subject.valid_band);
    let mut keys = models(subject, !bands.is_empty(), is_noise_known(&curves));
    if curves.iter().flat_map(|curve| &curve.points).any(|point| point.measured.is_none()) {
        let rest = Key::new(Look::Beyond, "key", "measured, below the noise");
        keys.push(rest.toggling("measured"));
    }
    legend(&mut canvas, &keys);
    if curves.len() > 1 {
        canvas.y -= 4.0;
        legend(&mut canvas, &magnitudes(&curves));
    }
    columns(&mut canvas, layout, comparison, &curves, &bands);
    if let Some(sentence) = left_out(comparison) {
        canvas.note(&sentence);
    }
    Ok(canvas)
}

fn models(subject: &Subject<'_>, shaded: bool, noise: bool) -> Vec<Key> {
    let mut keys =
        vec![Key::new(Look::Marker(Marker::Circle), "key", "measured").toggling("measured")];
    match subject.extended {
        None => keys.push(Key::new(Look::Line("line"), "key", "simulated").toggling("after")),
        Some(extended) => {
            let after = text::shorten(&format!("after, {}", extended.name), NOTE.size, 250.0);
            keys.push(Key::new(Look::Line("thin"), "key", "before, base model").toggling("before"));
            keys.push(Key::new(Look::Line("line"), "key", after).toggling("after"));
        }
    }
    if noise {
        keys.push(Key::new(Look::Shade("noise"), "key", "noise, ± 2σ").toggling("noise"));
    }
    if shaded {
        keys.push(bands::key());
    }
    keys
}

fn magnitudes(curves: &[Curve]) -> Vec<Key> {
    let shown = spread(curves.len(), MOST_KEYS).into_iter();
    let key = |i: usize| {
        let class = format!("s{i}");
        Key::new(Look::Marker(Marker::of(i)), &class, &curves[i].label).toggling(&class)
    };
    shown.map(key).collect()
}

fn is_noise_known(curves: &[Curve]) -> bool {
    curves.iter().flat_map(|curve| &curve.points).any(|point| point.noise.is_some())
}

fn columns(
    canvas: &mut Canvas,
    layout: &Layout,
    comparison: &Comparison,
    curves: &[Curve],
    bands: &[[f64; 2]],
) {
    let every = || curves.iter().flat_map(|curve| &curve.points);
    let [low, high] = range(every().map(|point| point.frequency_hz));
    let [gain_range, phase_range] = ranges(curves);
    let [gain_left, gain_right] = layout.columns[0];
    let gain = text::shorten(&gain_name(comparison), 11.5, gain_right - gain_left);
    let columns = [
        Column {
            name: &gain,
            error_name: "Error of the gain (dB)",
            value: |ratio| ratio.gain_db,
            per_share: DB_PER_SHARE,
            least_error: 0.01,
            steps: DECIMAL,
            range: gain_range,
        },
        Column {
            name: "Phase (degrees)",
            error_name: "Error of the phase (degrees)",
            value: |ratio| ratio.phase_deg,
            per_share: 1.0_f64.to_degrees(),
            least_error: 0.1,
            steps: DEGREES,
            range: phase_range,
        },
    ];
    let few = every().count() <= FEW_POINTS;
    let above = canvas.y;
    for (index, (column, [left, right])) in columns.iter().zip(layout.columns).enumerate() {
        let top = 22.0 + if layout.stacked { canvas.y } else { above };
        let middle = top + RESPONSE_HEIGHT;
        let [error_top, error_bottom] = [middle + 28.0, middle + 28.0 + ERROR_HEIGHT];
        let x = Scale::log([low / 1.12, high * 1.12], [left, right]);
        let y = Scale::linear(column.range, [middle, top]);
        let response = Panel { x, y, left, top, right, bottom: middle };
        shade(canvas, &response, bands, true);
        let naming = Naming { y: column.name, x_below: FREQUENCY, ..Naming::default() };
        response.draw(canvas, &y.vertical_ticks(column.steps), naming);
        trace(canvas, &response, curves, few, column.value);
        if index == 0 {
            resting(canvas, &response, curves);
        }
        let size = size(column, curves, bands);
        let y = Scale::linear([-size, size], [error_bottom, error_top]);
        let panel = Panel { x, y, left, top: error_top, right, bottom: error_bottom };
        shade(canvas, &panel, bands, false);
        let naming = Naming { x: FREQUENCY, y: column.error_name, ..Naming::default() };
        panel.draw(canvas, &y.vertical_ticks(DECIMAL), naming);
        errors(canvas, &panel, column, curves, few);
        beyond(canvas, &panel, column, curves, size);
        canvas.y = error_bottom + 40.0;
    }
}

fn errors(canvas: &mut Canvas, panel: &Panel, column: &Column<'_>, curves: &[Curve], few: bool) {
    noise(canvas, panel, column, curves);
    canvas.open_clipped("", panel.sides());
    canvas.polyline("frame", [panel.at(1e-9, 0.0), panel.at(1e9, 0.0)]);
    canvas.close();
    let is_extended = curves.iter().flat_map(|curve| &curve.points).any(|p| p.extended.is_some());
    let models: &[(&str, &str, Model)] = match is_extended {
        false => &[("after", "error", |point| point.simulated)],
        true => &[
            ("before", "error before", |point| point.simulated),
            ("after", "error after", |point| point.extended),
        ],
    };
    for (key, name, model) in models {
        for (index, curve) in curves.iter().enumerate() {
            let at = |point: &Point| {
                let error = point.error(model(point))?;
                panel.at(point.frequency_hz, (column.value)(error))
            };
            let keys = format!("{key} s{index}");
            let trace = Trace { series: &curve.label, name, keys: &keys, hints: false };
            let before = *key == "before";
            let places = || curve.points.iter().filter_map(at);
            if few {
                let line = if before { "thin" } else { "faint" };
                canvas.open_trace(&format!("s{index}"), panel.sides(), trace);
                canvas.polyline(line, curve.points.iter().map(at));
                canvas.close();
                if before {
                    continue;
                }
            }
            let (look, shape, radius) = match (few, before) {
                (true, _) => ("measured", Marker::of(index), 2.6),
                (false, true) => ("hollow", Marker::Circle, 1.4),
                (false, false) => ("dense", Marker::Circle, 1.5),
            };
            let trace = if few { Trace { keys: &keys, ..Trace::default() } } else { trace };
            canvas.open_trace(&format!("s{index} {look}"), panel.sides(), trace);
            places().for_each(|place| canvas.marker(shape, place, radius, ""));
            canvas.close();
        }
    }
}

/// The noise of the noisiest magnitude at each frequency.
fn noise(canvas: &mut Canvas, panel: &Panel, column: &Column<'_>, curves: &[Curve]) {
    let every = curves.iter().flat_map(|curve| &curve.points);
    let mut known: Vec<[f64; 2]> =
        every.filter_map(|point| Some([point.frequency_hz, point.noise?])).collect();
    known.sort_by(|a, b| a[0].total_cmp(&b[0]));
    known.dedup_by(|next, kept| {
        let same = next[0] <= kept[0] * 1.001;
        kept[1] = if same { kept[1].max(next[1]) } else { kept[1] };
        same
    });
    let edge = |sign: f64| {
        let value = move |share: f64| sign * NOISE_BAND * share * column.per_share;
        known.iter().filter_map(move |[hz, share]| panel.at(*hz, value(*share)))
    };
    let area: Vec<[f64; 2]> =
        edge(1.0).chain(edge(-1.0).collect::<Vec<_>>().into_iter().rev()).collect();
    canvas.open_trace("", panel.sides(), Trace { keys: "noise", ..Trace::default() });
    canvas.area("noise", &area);
    canvas.close();
}

#[cfg(test)]
mod tests {
    use super::super::bode::curves::Ratio;
    use super::*;

    #[test]
    fn errors_of_a_phase_are_less_than_half_a_turn() {
        let ratio = |phase_deg: f64| Some(Ratio { gain_db: 1.0, phase_deg });
        let point = Point {
            frequency_hz: 1.0,
            measured: ratio(-350.0),
            simulated: ratio(5.0),
            extended: None,
            noise: None,
        };
        assert!((point.error(point.simulated).unwrap().phase_deg - 5.0).abs() < 1e-9);
        assert!(point.error(point.extended).is_none());
    }
}
