//! Friction against velocity, as the model has it.

mod model;
mod velocities;

use servoscope_core::answers::{Comparison, Identification};

use super::canvas::{Anchor, Canvas, LABEL, Marker, Trace, WIDTH};
use super::panel::{Key, Look, Naming, Panel, legend};
use super::scale::{DECIMAL, Scale, padded, range};
use super::series::{by_magnitude, in_fraction, spread, unit_or};
use super::text::{self, number};
use super::{NothingToDraw, Subject};
use crate::report::number::Rounding;
use crate::report::units::friction;
use crate::report::words::typeset;

use model::{Side, Viscous, band, quantile, side, viscous};
use velocities::{VELOCITIES, extents, velocities};

const LEFT: f64 = 64.0;
const RIGHT: f64 = WIDTH - 92.0;

/// Height of a line of names.
const LINE: f64 = 16.0;
const HEIGHT: f64 = 320.0;

/// Magnitudes whose range of velocity is shown.
const MOST_RANGES: usize = 8;

/// Class of what the model says: no magnitude's colour.
const MODEL: &str = "model";

pub(super) fn draw(subject: &Subject<'_>) -> Result<Canvas, NothingToDraw> {
    let missing = |what: &str| NothingToDraw(what.to_owned());
    let answer = subject.identification.ok_or_else(|| missing("there is no identified model"))?;
    let viscous =
        viscous(answer).ok_or_else(|| missing("the data do not determine pole and constant"))?;
    let sides: Vec<Side> = [1.0, -1.0].into_iter().filter_map(|sign| side(answer, sign)).collect();
    if sides.is_empty() {
        return Err(missing("the data do not determine the friction levels"));
    }
    let comparison = subject.comparison;
    let groups = comparison.map(by_magnitude).unwrap_or_default();
    let ranges: Vec<(usize, [f64; 2])> = spread(groups.len(), MOST_RANGES)
        .into_iter()
        .filter_map(|i| Some((i, velocities(&groups[i], comparison?)?)))
        .collect();
    let unit = input_unit(answer, comparison);
    let says = says(answer, &viscous, &sides, &unit);
    let quantity = friction(&unit);
    let title = format!("{quantity} over velocity");
    let mut canvas = Canvas::new("friction", &title, &says, groups.len());
    let mut keys = vec![
        Key::new(Look::Line("line"), MODEL, "dry and viscous friction of the model")
            .toggling("model"),
        Key::new(Look::Area, MODEL, "95 % band").toggling("band"),
    ];
    if sides.iter().any(|side| side.static_level.is_some()) {
        let level = Key::new(Look::Marker(Marker::Diamond), MODEL, "static level");
        keys.push(level.toggling("static"));
    }
    if !ranges.is_empty() {
        let measured = Key::new(Look::Area, "s0", "velocities measured");
        keys.push(measured.toggling(VELOCITIES));
    }
    legend(&mut canvas, &keys);
    let top = canvas.y + 22.0;
    let reach = reach(&sides, &viscous, &ranges);
    let span = if sides.len() == 2 {
        [-reach, reach]
    } else {
        padded([0.0, sides[0].sign * reach], 0.05, 0.0)
    };
    let x = Scale::linear(span, [LEFT, RIGHT]);
    let bottom = top + HEIGHT;
    let covered: Vec<([f64; 2], &Side)> = sides
        .iter()
        .flat_map(|side| band(answer, side, &viscous, reach).into_iter().map(move |p| (p, side)))
        .collect();
    let statics = sides.iter().filter_map(|side| Some(side.sign * side.static_level?));
    let torques = covered.iter().map(|(point, _)| point[1]).chain(statics).chain([0.0]);
    let y = Scale::linear(padded(torques, 0.1, 0.0), [bottom, top]);
    let panel = Panel { x, y, left: LEFT, top, right: RIGHT, bottom };
    let velocity = velocity_unit(comparison);
    let x_name = format!("Velocity ({velocity})");
    let y_name = format!("{quantity} ({})", unit_or(&unit, "input units"));
    let x_name = if ranges.is_empty() { x_name.as_str() } else { "" };
    panel.draw(
        &mut canvas,
        &y.vertical_ticks(DECIMAL),
        Naming { x: x_name, y: &y_name, ..Naming::default() },
    );
    axes(&mut canvas, &panel);
    for side in &sides {
        curve(&mut canvas, &panel, answer, side, &viscous, reach);
    }
    names(&mut canvas, &panel, &sides, &unit);
    let per_velocity = if unit.is_empty() {
        String::new()
    } else {
        text::shorten(&format!("{unit}/{}", in_fraction(&velocity)), 12.0, 90.0)
    };
    slope(&mut canvas, &panel, &sides, &viscous, reach, &per_velocity);
    canvas.y = bottom + if ranges.is_empty() { 44.0 } else { 12.0 };
    if let Some(comparison) = comparison.filter(|_| !ranges.is_empty()) {
        extents(&mut canvas, &panel, &groups, &ranges, comparison, &velocity);
    }
    if sides.iter().any(|side| side.key == "fc_mean") {
        canvas.note("The data tell only the mean of the levels of both directions.");
    }
    Ok(canvas)
}

/// Largest velocity shown: what was measured, or what makes the slope visible.
fn reach(sides: &[Side], viscous: &Viscous, ranges: &[(usize, [f64; 2])]) -> f64 {
    let [low, high] = range(ranges.iter().flat_map(|(_, range)| *range));
    let measured = low.abs().max(high.abs());
    let level = sides.iter().map(|side| side.level).fold(0.0, f64::max);
    let guess = 2.0 * level / viscous.slope;
    match (measured.is_finite() && measured > 0.0, guess.is_finite() && guess > 0.0) {
        (true, _) => 1.05 * measured,
        (false, true) => guess,
        (false, false) => 1.0,
    }
}

fn axes(canvas: &mut Canvas, panel: &Panel) {
    let zero = [panel.x.at(0.0), panel.y.at(0.0)];
    if let Some(x) = zero[0].filter(|x| (panel.left..=panel.right).contains(x)) {
        canvas.line("frame", [x, panel.top], [x, panel.bottom]);
    }
    if let Some(y) = zero[1].filter(|y| (panel.top..=panel.bottom).contains(y)) {
        canvas.line("frame", [panel.left, y], [panel.right, y]);
    }
}

fn curve(
    canvas: &mut Canvas,
    panel: &Panel,
    answer: &Identification,
    side: &Side,
    viscous: &Viscous,
    reach: f64,
) {
    let area = band(answer, side, viscous, reach);
    let area: Vec<[f64; 2]> = area.iter().filter_map(|[v, t]| panel.at(*v, *t)).collect();
    canvas.open_trace(MODEL, panel.sides(), Trace::keyed("band"));
    canvas.area("band", &area);
    canvas.close();
    // From rest: whatever value holds the axis, up to the static level.
    let sliding = side.torque(viscous.slope, 0.0);
    let breakaway = side.static_level.unwrap_or(sliding).max(sliding);
    let rest = [panel.at(0.0, 0.0), panel.at(0.0, side.sign * breakaway), None];
    let moving = side.curve(viscous.slope, reach).map(|[v, torque]| panel.at(v, torque));
    let trace = Trace { name: "friction", keys: "model", ..Trace::default() };
    canvas.open_trace(MODEL, panel.sides(), trace);
    canvas.polyline("line", rest.into_iter().chain(moving));
    canvas.close();
    if let Some(place) = side.static_level.and_then(|level| panel.at(0.0, side.sign * level)) {
        let trace = Trace { name: "static level", keys: "static", ..Trace::default() };
        canvas.open_inside(&format!("{MODEL} measured"), panel.sides(), trace);
        canvas.marker(Marker::Diamond, place, 4.2, "static level");
        canvas.close();
    }
}

/// Names the levels where the curve leaves rest, and static levels beyond them.
fn names(canvas: &mut Canvas, panel: &Panel, sides: &[Side], unit: &str) {
    for side in sides {
        let Some([x, y]) = panel.at(0.0, side.sign * side.level) else { continue };
        // On the side where the curve is not.
        let (anchor, x) = match side.sign > 0.0 {
            true => (Anchor::End, x - 10.0),
            false => (Anchor::Start, x + 10.0),
        };
        let mut label = |name: &str, level: f64, y: f64, keys: &'static str| {
            let label = format!("{name} = {}", text::quantity(level, 3, unit));
            canvas.open_inside(MODEL, panel.sides(), Trace::keyed(keys));
            canvas.text(x, y + 4.0, LABEL, anchor, &label);
            canvas.close();
        };
        // Clear of the axis, where a level is small.
        let own = y - 4.0 * side.sign;
        label(side.name, side.level, own, "model");
        let fixed = side.static_level.filter(|level| *level > side.level);
        let place = fixed.and_then(|level| Some((level, panel.at(0.0, side.sign * level)?[1])));
        if let Some((level, y)) = place {
            // Above its own level, clear of that one's name.
            let y = match side.sign > 0.0 {
                true => y.min(own - LINE),
                false => y.max(own + LINE),
            };
            label(side.static_name(), level, y, "static");
        }
    }
}

/// Names the slope of the branch of positive velocity, and of the other where it has another.
fn slope(
    canvas: &mut Canvas,
    panel: &Panel,
    sides: &[Side],
    viscous: &Viscous,
    reach: f64,
    unit: &str,
) {
    let (Some(zero), Some(end)) = (panel.x.at(0.0), panel.x.at(reach)) else { return };
    let are_alike = sides.iter().all(|side| side.slope(1.0) == 1.0);
    for side in sides.iter().filter(|side| side.sign > 0.0 || !are_alike) {
        let slope = text::quantity(side.slope(viscous.slope), 3, unit);
        let label = format!("slope {} = {slope}", side.slope_name());
        let room = (panel.right - 10.0) - text::width(&label, LABEL.size) - zero;
        let v = reach * room / (end - zero);
        let Some(y) = panel.y.at(side.sign * side.torque(viscous.slope, v)) else { continue };
        canvas.open_inside(MODEL, panel.sides(), Trace::keyed("model"));
        // On the side of zero, clear of the point of the branch nearest to it.
        match side.sign > 0.0 {
            true => {
                let y = (y + 18.0).min(panel.bottom - 8.0);
                canvas.text(panel.right - 10.0, y, LABEL, Anchor::End, &label);
            }
            false => {
                let y = (y - 10.0).max(panel.top + 14.0);
                canvas.text(panel.left + 10.0, y, LABEL, Anchor::Start, &label);
            }
        }
        canvas.close();
    }
}

fn input_unit(answer: &Identification, comparison: Option<&Comparison>) -> String {
    let of_level = || {
        let level = ["fc_plus", "fc_mean"].into_iter().find_map(|key| answer.parameters.get(key));
        level.map(|estimate| estimate.unit.clone()).unwrap_or_default()
    };
    let unit = comparison.map_or_else(of_level, |comparison| comparison.input_unit.clone());
    text::shorten(&unit, 12.0, 80.0)
}

fn velocity_unit(comparison: Option<&Comparison>) -> String {
    let Some(comparison) = comparison else { return "velocity units".to_owned() };
    let unit = comparison.response_unit.as_str();
    let unit = match (unit.is_empty(), comparison.response_quantity.as_str()) {
        (true, "position") => "position units/s".to_owned(),
        (true, "acceleration") => "acceleration units·s".to_owned(),
        (true, _) => "response units".to_owned(),
        (false, "position") => format!("{}/s", in_fraction(unit)),
        (false, "acceleration") => format!("{}·s", in_fraction(unit)),
        (false, _) => unit.to_owned(),
    };
    text::shorten(&unit, 11.5, 300.0)
}

fn says(answer: &Identification, viscous: &Viscous, sides: &[Side], unit: &str) -> String {
    let quantile = quantile(answer);
    let with_band = |value: f64, std: Option<f64>| match std {
        Some(std) if std > 0.0 => {
            let half = quantile * std;
            // As many digits as the interval leaves any meaning.
            match Rounding::of(value, half) {
                Some(rounding) => {
                    let written = [value, half].map(|number| typeset(&rounding.write(number)));
                    written.join(" ± ")
                }
                None => number(value, 4),
            }
        }
        _ => number(value, 4),
    };
    let space = if unit.is_empty() { "" } else { " " };
    let level = |side: &Side| {
        format!("{} = {}{space}{unit}", side.name, with_band(side.level, side.level_std))
    };
    let levels = sides.iter().map(level).collect::<Vec<_>>().join(", ");
    format!("{levels}; viscous a/K = {} (± 95 %).", with_band(viscous.slope, viscous.std))
}
