//! Charts of plain numbers: lines over one or several panels, and bars. For what no answer holds.

use super::canvas::{Anchor, Canvas, MARGIN, Marker, TICK, Trace, WIDTH};
use super::panel::{Key, Look, Naming, Panel, legend};
use super::scale::{DECIMAL, Scale, padded, range};
use super::text::number;
use super::theme::Theme;

const LEFT: f64 = 76.0;
const HEIGHT: f64 = 210.0;

/// Height of a bar, and of the group of those of one name.
const BAR: f64 = 13.0;
const GROUP_GAP: f64 = 16.0;

/// A line through points; it breaks at a point that is not finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Its name; lines of one name have one colour in all panels.
    pub label: String,
    /// Points, in the units of the panel's axes.
    pub points: Vec<[f64; 2]>,
    /// How it is drawn.
    pub stroke: Stroke,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stroke {
    /// In full.
    Solid,
    /// Thin and dashed.
    Dashed,
    /// Broad and pale: it shows beside a line that lies on it.
    Broad,
}

impl Stroke {
    fn class(self) -> &'static str {
        match self {
            Stroke::Solid => "line",
            Stroke::Dashed => "thin",
            Stroke::Broad => "broad",
        }
    }
}

/// One pair of axes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plot {
    /// Quantity and unit of the horizontal axis.
    pub x: String,
    /// Quantity and unit of the vertical axis.
    pub y: String,
    /// Whether each of them is logarithmic.
    pub logarithmic: [bool; 2],
    /// Least value that the vertical axis shows, where smaller ones say nothing.
    pub floor: Option<f64>,
    /// What it shows.
    pub lines: Vec<Line>,
}

/// A bar with its name, and the group that gives it its colour.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// What the bar is of; bars of one name stand together.
    pub name: String,
    /// Which colour.
    pub group: String,
    /// Its value, positive: the axis is logarithmic.
    pub value: f64,
}

/// Draws panels below each other as an SVG document. `name` is that of the figure, unique in a
/// page; `says` what a reader should see.
pub fn lines(name: &'static str, title: &str, says: &str, plots: &[Plot], theme: Theme) -> String {
    let mut labels: Vec<(&str, Stroke)> = Vec::new();
    for line in plots.iter().flat_map(|plot| &plot.lines) {
        if !labels.iter().any(|(label, _)| *label == line.label) {
            labels.push((&line.label, line.stroke));
        }
    }
    let mut canvas = Canvas::new(name, title, says, labels.len());
    let key = |(i, (label, stroke)): (usize, &(&str, Stroke))| {
        Key::new(Look::Line(stroke.class()), format!("s{i}"), *label).toggling(format!("s{i}"))
    };
    let keys: Vec<Key> = labels.iter().enumerate().map(key).collect();
    legend(&mut canvas, &keys);
    for plot in plots {
        let top = canvas.y + 26.0;
        let (right, bottom) = (WIDTH - MARGIN, top + HEIGHT);
        let values = |axis: usize| {
            let points = plot.lines.iter().flat_map(|line| &line.points);
            let least = if plot.logarithmic[axis] { f64::MIN_POSITIVE } else { f64::NEG_INFINITY };
            let least = if axis == 1 { plot.floor.unwrap_or(least).max(least) } else { least };
            points.map(move |point| point[axis]).filter(move |value| *value >= least)
        };
        let scale = |axis: usize, pixels: [f64; 2]| match plot.logarithmic[axis] {
            true => {
                let [low, high] = range(values(axis));
                let space = if axis == 1 { (high / low).powf(0.05).max(1.1) } else { 1.0 };
                Scale::log([low / space, high * space], pixels)
            }
            false if axis == 1 => Scale::linear(padded(values(axis), 0.06, 1e-12), pixels),
            false => Scale::linear(range(values(axis)), pixels),
        };
        let (x, y) = (scale(0, [LEFT, right]), scale(1, [bottom, top]));
        let panel = Panel { x, y, left: LEFT, top, right, bottom };
        let naming = Naming { x: &plot.x, y: &plot.y, ..Naming::default() };
        panel.draw(&mut canvas, &y.vertical_ticks(DECIMAL), naming);
        for line in &plot.lines {
            let index = labels.iter().position(|(label, _)| *label == line.label);
            let class = format!("s{}", index.unwrap_or_default());
            let trace = Trace { name: &line.label, keys: &class, ..Trace::default() };
            canvas.open_trace(&class, panel.sides(), trace);
            let point =
                |[x, y]: &[f64; 2]| panel.at(*x, *y).filter(|_| x.is_finite() && y.is_finite());
            canvas.polyline(line.stroke.class(), line.points.iter().map(point));
            canvas.close();
        }
        canvas.y = bottom + 44.0;
    }
    canvas.finish(theme.into(), "")
}

/// Draws bars over a logarithmic axis as an SVG document; likewise. `axis` names the quantity
/// and its unit.
pub fn bars(
    name: &'static str,
    title: &str,
    says: &str,
    axis: &str,
    bars: &[Bar],
    theme: Theme,
) -> String {
    let mut groups: Vec<&str> = Vec::new();
    let mut names: Vec<&str> = Vec::new();
    for Bar { name, group, .. } in bars {
        if !groups.contains(&group.as_str()) {
            groups.push(group);
        }
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let mut canvas = Canvas::new(name, title, says, groups.len());
    let key = |(i, group): (usize, &&str)| {
        Key::new(Look::Marker(Marker::Square), format!("s{i}"), *group)
    };
    let keys: Vec<Key> = groups.iter().enumerate().map(key).collect();
    legend(&mut canvas, &keys);
    let left = LEFT + 70.0;
    let right = WIDTH - MARGIN - 60.0;
    let top = canvas.y + 26.0;
    let height = |name: &str| {
        let count = bars.iter().filter(|bar| bar.name == name).count();
        count as f64 * BAR + GROUP_GAP
    };
    let bottom = top + GROUP_GAP + names.iter().map(|name| height(name)).sum::<f64>();
    let [low, high] = range(bars.iter().map(|bar| bar.value));
    let x = Scale::log([low / 2.0, high * 1.5], [left, right]);
    let y = Scale::linear([0.0, 1.0], [bottom, top]);
    let panel = Panel { x, y, left, top, right, bottom };
    panel.draw(&mut canvas, &[], Naming { x: axis, ..Naming::default() });
    let mut place = top + GROUP_GAP;
    for name in names {
        let of_name: Vec<&Bar> = bars.iter().filter(|bar| bar.name == name).collect();
        let middle = place + 0.5 * BAR * of_name.len() as f64;
        canvas.text(left - 7.0, middle + 4.0, TICK, Anchor::End, name);
        for bar in of_name {
            let index = groups.iter().position(|group| *group == bar.group).unwrap_or_default();
            if let Some(end) = x.at(bar.value) {
                let value = number(bar.value, 3);
                canvas.open(&format!("s{index}"));
                canvas.rectangle("fill", [left, place, end, place + BAR - 2.0], &value);
                canvas.close();
                canvas.text(end + 5.0, place + BAR - 3.0, TICK, Anchor::Start, &value);
            }
            place += BAR;
        }
        place += GROUP_GAP;
    }
    canvas.y = bottom + 44.0;
    canvas.finish(theme.into(), "")
}

#[cfg(test)]
mod tests {
    use roxmltree::Document;

    use super::*;

    fn line(label: &str, points: Vec<[f64; 2]>) -> Line {
        Line { label: label.into(), points, stroke: Stroke::Solid }
    }

    fn count(svg: &str, element: &str) -> usize {
        let document = Document::parse(svg).expect("well-formed XML");
        document.descendants().filter(|node| node.has_tag_name(element)).count()
    }

    #[test]
    fn a_line_of_one_name_has_one_colour_in_every_panel_and_one_entry() {
        let points = vec![[1.0, 2.0], [2.0, f64::NAN], [3.0, 4.0], [4.0, 5.0]];
        let plot = Plot { lines: vec![line("a", points)], ..Plot::default() };
        let svg = lines("figure-4", "Title", "Says.", &[plot.clone(), plot], Theme::Light);
        assert_eq!(svg.matches(">a</text>").count(), 1);
        assert_eq!(count(&svg, "clipPath"), 2);
        assert!(svg.contains("servoscope-figure-4") && !svg.contains("NaN"));
    }

    // A pale line is told from the one on it, and a dashed one from the one beneath.
    #[test]
    fn every_stroke_is_drawn_in_its_own_way_and_the_style_knows_it() {
        let strokes = [Stroke::Solid, Stroke::Dashed, Stroke::Broad];
        let drawn = strokes.map(|stroke| {
            let line = Line { stroke, ..line("a", vec![[0.0, 1.0], [1.0, 2.0]]) };
            let plot = Plot { lines: vec![line], ..Plot::default() };
            let svg = lines("figure-4", "", "", &[plot], Theme::Light);
            assert!(svg.contains(&format!(".{}", stroke.class())), "{stroke:?}");
            svg
        });
        assert!(drawn[0] != drawn[1] && drawn[1] != drawn[2] && drawn[0] != drawn[2]);
    }

    #[test]
    fn nothing_below_the_floor_takes_the_axis_along() {
        let plot = |floor| Plot {
            logarithmic: [false, true],
            floor,
            lines: vec![line("a", vec![[0.0, 1e-300], [1.0, 1.0], [2.0, 10.0]])],
            ..Plot::default()
        };
        let drawn = |floor| lines("figure-4", "", "", &[plot(floor)], Theme::Light);
        assert_ne!(drawn(Some(0.5)), drawn(None));
    }

    #[test]
    fn a_bar_is_longer_where_its_value_is_larger() {
        let bar = |name: &str, value| Bar { name: name.into(), group: "here".into(), value };
        let svg = bars(
            "figure-14a",
            "T",
            "S",
            "Time (s)",
            &[bar("a", 1.0), bar("b", 60.0)],
            Theme::Light,
        );
        let document = Document::parse(&svg).unwrap();
        let bars = document.descendants().filter(|node| node.attribute("class") == Some("fill"));
        let widths: Vec<f64> =
            bars.map(|bar| bar.attribute("width").unwrap().parse().unwrap()).collect();
        assert!(widths.len() == 2 && widths[1] > 2.0 * widths[0], "{widths:?}");
    }
}
