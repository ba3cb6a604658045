//! Linear response, distortion and noise, from the data alone.

use std::f64::consts::TAU;

use servoscope_core::answers::{DistortionLine, LinearLine, Linearity, LinearityLevel, Parity};

use super::canvas::{Canvas, MARGIN, Marker, Trace, WIDTH};
use super::panel::{Key, Look, Naming, Panel, legend};
use super::scale::{DECIMAL, Scale, range};
use super::series::{spread, unit_or};
use super::text::{self, number, quantity};
use super::{NothingToDraw, Subject};

/// Panels at most: the smallest and the largest level, and one between.
const MOST_PANELS: usize = 3;

/// Decades shown below the largest amplitude, at most.
const MOST_DECADES: f64 = 8.0;

const LEFT: f64 = 64.0;

/// Kinds of line: their classes, their keys and their names.
const KINDS: [(&str, &str, &str); 3] = [
    ("s2", "input", "at lines of the input"),
    ("s1", "odd", "odd distortion"),
    ("s0", "even", "even distortion"),
];

pub(super) fn draw(subject: &Subject<'_>) -> Result<Canvas, NothingToDraw> {
    let nothing = || NothingToDraw("the data alone tell nothing of noise or distortion".into());
    let Linearity { levels, sentence, .. } = subject.linearity.ok_or_else(nothing)?;
    let title = "Response, distortion and noise (from the data alone)";
    let mut canvas = Canvas::new("linearity", title, sentence, KINDS.len());
    let mut keys: Vec<Key> = KINDS
        .iter()
        .map(|(class, key, name)| {
            Key::new(Look::Marker(Marker::Circle), *class, *name).toggling(*key)
        })
        .collect();
    keys.push(Key::new(Look::Line("floor"), "key", "noise").toggling("noise"));
    legend(&mut canvas, &keys);
    let units = subject.comparison.map_or(["", ""], |c| [&c.input_unit, &c.response_unit]);
    for index in spread(levels.len(), MOST_PANELS) {
        level(&mut canvas, &levels[index], units, levels.len() > 1);
    }
    Ok(canvas)
}

fn level(canvas: &mut Canvas, level: &LinearityLevel, units: [&str; 2], several: bool) {
    let hz = |omega: f64| omega / TAU;
    let linear: Vec<[f64; 2]> =
        level.approximation.iter().map(|line| [hz(line.omega_rad_s), line.amplitude]).collect();
    let distorted = |parity: Parity| -> Vec<[f64; 2]> {
        let own = level.distortion.iter().filter(|line| line.parity == parity);
        own.map(|line| [hz(line.omega_rad_s), line.amplitude]).collect()
    };
    let points = [linear, distorted(Parity::Odd), distorted(Parity::Even)];
    let noise = noise(level);
    let all = || points.iter().flatten().chain(&noise).filter(|[_, value]| *value > 0.0);
    let [low, high] = range(all().map(|[_, value]| *value));
    let [from, to] = range(all().map(|[hz, _]| *hz));
    let top = canvas.y + if several { 38.0 } else { 22.0 };
    let bottom = top + if several { 190.0 } else { 300.0 };
    let (left, right) = (LEFT, WIDTH - MARGIN);
    let x = Scale::log([from / 1.1, to * 1.1], [left, right]);
    let lowest = (low / 2.0).max(high * 10.0_f64.powf(-MOST_DECADES));
    let y = Scale::log([lowest, 2.0 * high], [bottom, top]);
    let panel = Panel { x, y, left, top, right, bottom };
    let [input_unit, response_unit] = units;
    let heading = match (several, input_unit) {
        (false, _) => String::new(),
        (true, "") => format!("magnitude {}", number(level.magnitude, 3)),
        (true, unit) => quantity(level.magnitude, 3, &text::shorten(unit, 12.0, 30.0)),
    };
    let unit = unit_or(response_unit, "response units");
    let name = text::shorten(&format!("Amplitude ({unit})"), 11.5, 200.0);
    let naming = Naming { heading: &heading, x: "Frequency (Hz)", y: &name, ..Naming::default() };
    panel.draw(canvas, &y.vertical_ticks(DECIMAL), naming);
    canvas.open_trace("", panel.sides(), Trace::keyed("noise"));
    canvas.polyline("floor", noise.iter().map(|[hz, value]| panel.at(*hz, *value)));
    canvas.close();
    let radius = if points.iter().map(Vec::len).sum::<usize>() > 150 { 2.0 } else { 3.2 };
    // The input's lines last: they are what the eye looks for.
    for ((class, keys, name), points) in KINDS.iter().zip(points).rev() {
        let trace = Trace { name, keys, ..Trace::default() };
        canvas.open_trace(&format!("{class} dense data"), panel.sides(), trace);
        for [hz, value] in points {
            let hint = format!("{} Hz, {name}: {}", number(hz, 4), number(value, 4));
            if let Some(at) = panel.at(hz, value) {
                canvas.marker(Marker::Circle, at, radius, &hint);
            }
        }
        canvas.close();
    }
    canvas.y = bottom + 44.0;
}

/// Frequency and root mean square of the noise of every line of which it is known.
fn noise(level: &LinearityLevel) -> Vec<[f64; 2]> {
    let linear = level
        .approximation
        .iter()
        .map(|LinearLine { omega_rad_s, noise, .. }| (*omega_rad_s, *noise));
    // Of single cosines, the noise of several harmonics together is not that of a line.
    let lines = |line: &&DistortionLine| {
        !level.approximation.iter().any(|l| l.omega_rad_s == line.omega_rad_s)
    };
    let distortion =
        level.distortion.iter().filter(lines).map(|line| (line.omega_rad_s, line.noise));
    let mut all: Vec<[f64; 2]> =
        linear.chain(distortion).filter_map(|(omega, noise)| Some([omega / TAU, noise?])).collect();
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    all
}
