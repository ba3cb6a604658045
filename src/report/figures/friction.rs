//! Friction torque against velocity, as the model has it.

use std::f64::consts::TAU;

use crate::answers::{ComparedExperiment, Comparison, Identification, ParameterEstimate};

use super::canvas::{Anchor, Canvas, Font, LABEL, Marker, NOTE, WIDTH};
use super::panel::{Key, Look, Naming, Panel, legend};
use super::scale::{DECIMAL, Scale, padded, range};
use super::series::{Group, by_magnitude, in_fraction, magnitude_label, spread, unit_or};
use super::text::{self, number};
use super::{NothingToDraw, Subject};

const LEFT: f64 = 64.0;
const RIGHT: f64 = WIDTH - 92.0;
const HEIGHT: f64 = 320.0;

/// Samples of a period on which its extremes are looked for, per harmonic.
const SAMPLES_PER_HARMONIC: usize = 8;

/// Velocities on which the band is drawn, each side.
const STEPS: usize = 40;

/// Magnitudes whose range of velocity is shown.
const MOST_RANGES: usize = 8;

/// Class of what the model says: no magnitude's colour.
const MODEL: &str = "model";

/// One direction of motion.
struct Side {
    /// 1: positive velocity; −1: negative.
    sign: f64,
    level: f64,
    level_std: Option<f64>,
    static_level: Option<f64>,
    name: &'static str,
    key: &'static str,
}

/// Viscous friction a/K, input per velocity.
struct Viscous {
    slope: f64,
    std: Option<f64>,
}

pub(super) fn draw(subject: &Subject<'_>) -> Result<Canvas, NothingToDraw> {
    let missing = |what: &str| NothingToDraw(what.to_owned());
    let answer = subject.identification.ok_or_else(|| missing("there is no identified model"))?;
    let viscous =
        viscous(answer).ok_or_else(|| missing("the data does not determine pole and constant"))?;
    let sides: Vec<Side> = [1.0, -1.0].into_iter().filter_map(|sign| side(answer, sign)).collect();
    if sides.is_empty() {
        return Err(missing("the data does not determine the friction levels"));
    }
    let comparison = subject.comparison;
    let groups = comparison.map(by_magnitude).unwrap_or_default();
    let ranges: Vec<(usize, [f64; 2])> = spread(groups.len(), MOST_RANGES)
        .into_iter()
        .filter_map(|i| Some((i, velocities(&groups[i], comparison?)?)))
        .collect();
    let unit = input_unit(answer, comparison);
    let says = says(answer, &viscous, &sides, &unit);
    let title = "Friction torque over velocity";
    let mut canvas = Canvas::new("friction", title, &says, groups.len());
    let mut keys = vec![
        Key::new(Look::Line("line"), MODEL, "dry and viscous friction of the model"),
        Key::new(Look::Area, MODEL, "95 % band"),
    ];
    if sides.iter().any(|side| side.static_level.is_some()) {
        keys.push(Key::new(Look::Marker(Marker::Diamond), MODEL, "static level"));
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
    let y_name = format!("Friction torque ({})", unit_or(&unit, "input units"));
    let x_name = if ranges.is_empty() { x_name.as_str() } else { "" };
    panel.draw(
        &mut canvas,
        &y.vertical_ticks(DECIMAL),
        Naming { x: x_name, y: &y_name, heading: "" },
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
        canvas.note("The data tells only the mean of the levels of both directions.");
    }
    Ok(canvas)
}

fn std(estimate: &ParameterEstimate) -> Option<f64> {
    estimate.std.filter(|std| std.is_finite())
}

fn viscous(answer: &Identification) -> Option<Viscous> {
    let [pole, constant] = ["pole", "constant"].map(|name| answer.parameters.get(name));
    let (pole, constant) = (pole?, constant?);
    let slope = -pole.value? / constant.value?;
    let gradient = gradient(answer, None);
    let std = std(pole).and(std(constant)).and_then(|_| deviation(answer, &gradient?, slope));
    slope.is_finite().then_some(Viscous { slope, std })
}

/// Derivatives of a/K by the parameters, or with a level: of the torque at
/// velocity v in its direction.
fn gradient<'a>(
    answer: &Identification,
    level_at: Option<(&'a str, f64)>,
) -> Option<Vec<(&'a str, f64)>> {
    let [pole, constant] =
        ["pole", "constant"].map(|name| answer.parameters.get(name).and_then(|e| e.value));
    let (pole, constant) = (pole?, constant?);
    let v = level_at.map_or(1.0, |(_, v)| v.abs());
    let mut gradient =
        vec![("pole", -v / constant), ("constant", v * pole / (constant * constant))];
    gradient.extend(level_at.map(|(name, _)| (name, 1.0)));
    Some(gradient)
}

/// Standard deviation of a function of the parameters, to first order, with
/// their correlations.
fn deviation(answer: &Identification, gradient: &[(&str, f64)], scale: f64) -> Option<f64> {
    let correlations = &answer.correlations;
    let index = |name: &str| correlations.names.iter().position(|known| known == name);
    let term = |(name, slope): &(&str, f64)| {
        Some((slope * std(answer.parameters.get(*name)?)?, index(name)))
    };
    let terms: Vec<(f64, Option<usize>)> = gradient.iter().map(term).collect::<Option<_>>()?;
    let mut variance = 0.0;
    for (i, (a, row)) in terms.iter().enumerate() {
        for (j, (b, column)) in terms.iter().enumerate() {
            let listed = row.zip(*column).and_then(|(r, c)| correlations.matrix.get(r)?.get(c));
            variance += a * b * if i == j { 1.0 } else { listed.copied().unwrap_or(0.0) };
        }
    }
    // Rounding may leave a little less than nothing.
    let deviation = variance.max(0.0).sqrt();
    (deviation.is_finite() && scale.is_finite()).then_some(deviation)
}

fn side(answer: &Identification, sign: f64) -> Option<Side> {
    let (key, static_key, name) = if sign > 0.0 {
        ("fc_plus", "fs_plus", "Fc⁺")
    } else {
        ("fc_minus", "fs_minus", "Fc⁻")
    };
    let estimate =
        |key: &str| answer.parameters.get(key).filter(|estimate| estimate.value.is_some());
    let (key, estimate_of_level) = match estimate(key) {
        Some(own) => (key, own),
        None => ("fc_mean", estimate("fc_mean")?),
    };
    Some(Side {
        sign,
        level: estimate_of_level.value?,
        level_std: std(estimate_of_level),
        static_level: estimate(static_key).and_then(|estimate| estimate.value),
        name,
        key,
    })
}

/// Widths of a 95 % interval in standard deviations, as the answer has them.
fn quantile(answer: &Identification) -> f64 {
    let widths = answer.parameters.values().filter(|e| !e.at_bound).filter_map(|estimate| {
        let [from, to] = estimate.interval95?;
        let width = 0.5 * (to - from) / estimate.std?;
        (1.9..13.0).contains(&width).then_some(width)
    });
    widths.fold(1.96, f64::max)
}

/// Lower edge outwards, upper edge back: the area of the 95 % band.
fn band(answer: &Identification, side: &Side, viscous: &Viscous, reach: f64) -> Vec<[f64; 2]> {
    let quantile = quantile(answer);
    let edge = |end: f64| {
        (0..=STEPS).map(move |i| {
            let v = reach * i as f64 / STEPS as f64;
            let gradient = gradient(answer, Some((side.key, v))).unwrap_or_default();
            let std = side.level_std.and(viscous.std);
            let std = std.and_then(|_| deviation(answer, &gradient, side.level)).unwrap_or(0.0);
            let torque = side.level + viscous.slope * v + end * quantile * std;
            [side.sign * v, side.sign * torque]
        })
    };
    edge(-1.0).chain(edge(1.0).collect::<Vec<_>>().into_iter().rev()).collect()
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
    canvas.open_clipped(MODEL, panel.sides());
    canvas.area("band", &area);
    // From rest: whatever value holds the axis, up to the static level.
    let breakaway = side.static_level.unwrap_or(side.level).max(side.level);
    canvas.polyline(
        "line",
        [
            panel.at(0.0, 0.0),
            panel.at(0.0, side.sign * breakaway),
            None,
            panel.at(0.0, side.sign * side.level),
            panel.at(side.sign * reach, side.sign * (side.level + viscous.slope * reach)),
        ],
    );
    canvas.close();
    if let Some(place) = side.static_level.and_then(|level| panel.at(0.0, side.sign * level)) {
        canvas.open(&format!("{MODEL} measured"));
        canvas.marker(Marker::Diamond, place, 4.2, "static level");
        canvas.close();
    }
}

/// Names the levels where the curve leaves rest.
fn names(canvas: &mut Canvas, panel: &Panel, sides: &[Side], unit: &str) {
    for side in sides {
        let Some([x, y]) = panel.at(0.0, side.sign * side.level) else { continue };
        let label = format!("{} = {}", side.name, text::quantity(side.level, 3, unit));
        // On the side where the curve is not.
        let (anchor, x) = match side.sign > 0.0 {
            true => (Anchor::End, x - 10.0),
            false => (Anchor::Start, x + 10.0),
        };
        // Clear of the axis, where a level is small.
        let y = y - 4.0 * side.sign;
        canvas.open(MODEL);
        canvas.text(x, y + 4.0, LABEL, anchor, &label);
        canvas.close();
    }
}

/// Names the slope below the branch of positive velocity, which it leaves free.
fn slope(
    canvas: &mut Canvas,
    panel: &Panel,
    sides: &[Side],
    viscous: &Viscous,
    reach: f64,
    unit: &str,
) {
    let Some(side) = sides.iter().find(|side| side.sign > 0.0) else { return };
    let label = format!("slope a/K = {}", text::quantity(viscous.slope, 3, unit));
    let right = panel.right - 10.0;
    let left = right - text::width(&label, LABEL.size);
    let (Some(zero), Some(end)) = (panel.x.at(0.0), panel.x.at(reach)) else { return };
    let v = reach * (left - zero) / (end - zero);
    let Some(y) = panel.y.at(side.level + viscous.slope * v) else { return };
    canvas.open(MODEL);
    // Below the lowest point of the branch that the text passes.
    canvas.text(right, (y + 18.0).min(panel.bottom - 8.0), LABEL, Anchor::End, &label);
    canvas.close();
}

/// The velocities each magnitude reached, as bars below.
fn extents(
    canvas: &mut Canvas,
    panel: &Panel,
    groups: &[Group<'_>],
    ranges: &[(usize, [f64; 2])],
    comparison: &Comparison,
    velocity: &str,
) {
    const HEIGHT: f64 = 17.0;
    const FONT: Font = NOTE;
    let top = canvas.y + 20.0;
    let bottom = top + HEIGHT * ranges.len() as f64 + 6.0;
    let below = Panel { top, bottom, y: Scale::linear([0.0, 1.0], [bottom, top]), ..*panel };
    let naming = Naming {
        x: &format!("Velocity ({velocity})"),
        y: "Velocities measured at each magnitude",
        heading: "",
    };
    below.draw(canvas, &[], naming);
    for (row, (index, range)) in ranges.iter().rev().enumerate() {
        let y = top + 3.0 + HEIGHT * (row as f64 + 0.5);
        let [Some(from), Some(to)] = range.map(|v| panel.x.at(v)) else { continue };
        canvas.open_clipped(&format!("s{index}"), below.sides());
        canvas.rectangle("fill", [from, y - 4.0, to.max(from + 1.0), y + 4.0], "");
        canvas.close();
        let label = magnitude_label(groups[*index].magnitude, comparison);
        canvas.text(panel.right + 8.0, y + 4.0, FONT, Anchor::Start, &label);
    }
    canvas.y = bottom + 44.0;
}

/// Lowest and highest velocity at a magnitude.
fn velocities(group: &Group<'_>, comparison: &Comparison) -> Option<[f64; 2]> {
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
            let digits = (value.abs() / half).log10().ceil().clamp(1.0, 6.0) as usize + 1;
            format!("{} ± {}", number(value, digits), number(half, 2))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::ComparedHarmonic;
    use crate::report::sample;

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

    #[test]
    fn the_band_knows_that_pole_and_constant_go_together() {
        let mut answer = sample::identification();
        let gradient = gradient(&answer, None).unwrap();
        let loose = deviation(&answer, &gradient, 1.0).unwrap();
        // a/K with both terms of the same size: σ√2 without correlation, 0 with that of −1
        // between pole (negative) and constant, which is what the sample nearly has.
        answer.correlations.matrix = vec![vec![1.0, 0.0], vec![0.0, 1.0]];
        let free = deviation(&answer, &gradient, 1.0).unwrap();
        assert!(loose < 0.2 * free, "{loose} {free}");
    }
}
