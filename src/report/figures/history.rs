//! Parameters of an axis over the time of measuring, each in a panel of its own.

use super::NothingToDraw;
use super::canvas::{Canvas, MARGIN, Marker, TICK, Trace, WIDTH};
use super::panel::{Key, Look, Naming, Panel, legend};
use super::scale::{DECIMAL, Scale, Tick, padded, range};
use super::series::counted;
use super::text::{self, number};

/// A parameter over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Trend {
    /// What the parameter is called.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its values, earliest first.
    pub points: Vec<Estimated>,
}

/// A value at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimated {
    /// Seconds since 1970-01-01 UTC.
    pub at_s: f64,
    /// The value.
    pub value: f64,
    /// Its 95 % interval, where it has one.
    pub interval95: Option<[f64; 2]>,
    /// Whether it differs from the one before by more than both intervals.
    pub changed: bool,
}

const COLUMNS: usize = 2;
const LEFT: f64 = 64.0;
const GAP: f64 = 76.0;
const HEIGHT: f64 = 140.0;

/// Steps of the time axis, seconds: from a minute to a year, a whole number of the
/// smaller in most of the larger.
const STEPS_S: [f64; 14] = [
    60.0,
    300.0,
    900.0,
    3600.0,
    10_800.0,
    21_600.0,
    86_400.0,
    172_800.0,
    604_800.0,
    1_209_600.0,
    2_592_000.0,
    7_776_000.0,
    15_552_000.0,
    31_536_000.0,
];
const DAY_S: f64 = 86_400.0;

/// Ordered colours in use: of them those of values and of values that changed.
const SERIES: usize = 3;
const STEADY: usize = 2;
const CHANGED: usize = 1;

pub(super) fn draw(title: &str, trends: &[Trend]) -> Result<Canvas, NothingToDraw> {
    if trends.is_empty() {
        return Err(NothingToDraw("nothing has been identified on this axis".into()));
    }
    let mut canvas = Canvas::new("history", title, &says(trends), SERIES);
    legend(
        &mut canvas,
        &[
            Key::new(Look::Marker(Marker::Circle), format!("s{STEADY}"), "value and 95 % interval")
                .toggling("steady"),
            Key::new(
                Look::Marker(Marker::Diamond),
                format!("s{CHANGED}"),
                "changed beyond the uncertainty of both",
            )
            .toggling("changed"),
        ],
    );
    let times = || trends.iter().flat_map(|trend| &trend.points).map(|point| point.at_s);
    let span = times_around(range(times()));
    let start = canvas.y + 38.0;
    let width = (WIDTH - MARGIN - LEFT - GAP * (COLUMNS as f64 - 1.0)) / COLUMNS as f64;
    for (place, trend) in trends.iter().enumerate() {
        let left = LEFT + (place % COLUMNS) as f64 * (width + GAP);
        let top = start + (place / COLUMNS) as f64 * (HEIGHT + 82.0);
        let (right, bottom) = (left + width, top + HEIGHT);
        let ends = trend.points.iter().flat_map(|point| {
            let [low, high] = point.interval95.unwrap_or([point.value; 2]);
            [low, point.value, high]
        });
        let x = Scale::linear(span, [left, right]);
        let y = Scale::linear(padded(ends, 0.08, 0.0), [bottom, top]);
        let panel = Panel { x, y, left, top, right, bottom };
        let naming = Naming { heading: &trend.name, x: "UTC", y: &trend.unit, ..Naming::default() };
        panel.draw_with(&mut canvas, &dates(span, &x, width), &y.vertical_ticks(DECIMAL), naming);
        points(&mut canvas, &panel, trend);
        canvas.y = bottom + 40.0;
    }
    Ok(canvas)
}

/// What a reader's cursor stands on.
const POINT: Trace<'_> = Trace { series: "", name: "estimate", keys: "", hints: true };

fn points(canvas: &mut Canvas, panel: &Panel, trend: &Trend) {
    canvas.open_inside(&format!("s{STEADY}"), panel.sides(), Trace::keyed("steady"));
    canvas.polyline("faint", trend.points.iter().map(|point| panel.at(point.at_s, point.value)));
    canvas.close();
    for point in &trend.points {
        let Some(at) = panel.at(point.at_s, point.value) else { continue };
        let (class, keys) = if point.changed { (CHANGED, "changed") } else { (STEADY, "steady") };
        canvas.open_inside(&format!("s{class}"), panel.sides(), Trace::keyed(keys));
        if let Some([low, high]) = point.interval95
            && let (Some(low), Some(high)) = (panel.y.at(low), panel.y.at(high))
        {
            canvas.line("bar", [at[0], low], [at[0], high]);
        }
        canvas.close();
        canvas.open_inside(&format!("s{class} measured"), panel.sides(), Trace { keys, ..POINT });
        let shape = if point.changed { Marker::Diamond } else { Marker::Circle };
        canvas.marker(shape, at, 4.0, &hint(point, &trend.unit));
        canvas.close();
    }
}

fn hint(point: &Estimated, unit: &str) -> String {
    let interval = point.interval95.map_or_else(String::new, |[low, high]| {
        format!(" ({} to {})", number(low, 5), number(high, 5))
    });
    let changed = if point.changed { ", changed" } else { "" };
    let when = date(point.at_s, true);
    format!("{when}: {}{interval} {unit}{changed}", number(point.value, 5))
}

/// A range of times with space at both ends; one time alone stands in its day.
fn times_around([first, last]: [f64; 2]) -> [f64; 2] {
    let space = if last > first { 0.06 * (last - first) } else { 0.5 * DAY_S };
    [first - space, last + space]
}

/// As many round times as stand beside each other.
fn dates([from, to]: [f64; 2], x: &Scale, room: f64) -> Vec<Tick> {
    let ticks = |step: f64| -> Vec<Tick> {
        let first = (from / step).ceil();
        let count = ((to / step).floor() - first).max(-1.0) as usize + 1;
        let times = (0..count).map(|i| (first + i as f64) * step);
        let tick = |at: f64| Some(Tick { px: x.at(at)?, label: date(at, step < DAY_S) });
        times.filter_map(tick).collect()
    };
    let fits = |step: f64| {
        let widest = text::width(&date(from, step < DAY_S), TICK.size) + 14.0;
        (to - from) / step * widest <= room
    };
    ticks(STEPS_S.into_iter().find(|step| fits(*step)).unwrap_or(10.0 * STEPS_S[13]))
}

/// `2026-03-04`, or `03-04 10:20` with the time of day.
fn date(at_s: f64, with_time: bool) -> String {
    let format = if with_time { "%m-%d %H:%M" } else { "%Y-%m-%d" };
    let time = jiff::Timestamp::from_second(at_s as i64);
    time.map_or_else(|_| String::new(), |time| time.strftime(format).to_string())
}

fn says(trends: &[Trend]) -> String {
    let measured = trends.iter().map(|trend| trend.points.len()).max().unwrap_or(0);
    let changed = trends.iter().filter(|trend| trend.points.iter().any(|point| point.changed));
    let changed: Vec<&str> = changed.map(|trend| trend.name.as_str()).collect();
    let measured = counted(measured, "measurement", "measurements");
    match changed.is_empty() {
        true => format!("{measured}; no parameter changed beyond its intervals."),
        false => format!("{measured}; changed beyond their intervals: {}.", changed.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::figures::{Theme, draw_history};

    fn trend(name: &str, points: &[(f64, f64, bool)]) -> Trend {
        let estimated = |&(at_s, value, changed): &(f64, f64, bool)| Estimated {
            at_s,
            value,
            interval95: Some([value - 0.1, value + 0.1]),
            changed,
        };
        let points = points.iter().map(estimated).collect();
        Trend { name: name.into(), unit: "rad/s".into(), points }
    }

    #[test]
    fn changes_are_said_and_marked() {
        let day = 1_772_582_400.0;
        let trends = [
            trend("pole", &[(day, -10.0, false), (day + 9.0 * DAY_S, -12.0, true)]),
            trend("static friction forwards", &[(day, 0.8, false)]),
        ];
        let svg = draw_history("press 4, x", &trends, Theme::Light).unwrap();
        roxmltree::Document::parse(&svg).unwrap();
        assert!(svg.contains("2 measurements; changed beyond their intervals: pole."), "{svg}");
        assert!(svg.contains(">static friction forwards<"));
        assert!(svg.contains("03-13 00:00: −12 (−12.1 to −11.9) rad/s, changed"), "{svg}");
        // Weeks are counted from 1970-01-01, a Thursday.
        assert!(svg.contains(">2026-03-05<") && svg.contains(">2026-03-12<"), "{svg}");
    }

    #[test]
    fn one_time_alone_has_a_place() {
        let svg = draw_history("x", &[trend("pole", &[(0.0, -10.0, false)])], Theme::Light);
        assert!(svg.unwrap().contains("no parameter changed"));
        assert!(draw_history("x", &[], Theme::Light).is_err());
    }
}
