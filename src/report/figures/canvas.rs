//! SVG as text, element by element.

use std::fmt::{Display, Write as _};

use super::text;
use super::theme::{self, Format};

/// Width of every figure, pixels.
pub(super) const WIDTH: f64 = 800.0;

/// Space left of the content and right of it.
pub(super) const MARGIN: f64 = 24.0;

/// Stands for the figure's id until it is finished. It is not allowed in XML, so
/// that no text of the figure holds it.
const OWN_ID: char = '\u{fffe}';

/// Height of a line of notes.
const NOTE_LINE: f64 = 17.0;

/// Size and colour of a text.
#[derive(Debug, Clone, Copy)]
pub(super) struct Font {
    pub size: f64,
    pub class: &'static str,
}

/// The one line a reader sees first.
const TITLE: Font = Font { size: 18.0, class: "h" };
/// What the figure says.
const SUBTITLE: Font = Font { size: 13.0, class: "m" };
/// Heading of a panel.
pub(super) const HEADING: Font = Font { size: 12.5, class: "b" };
/// Name of an axis.
pub(super) const AXIS: Font = Font { size: 11.5, class: "m" };
/// Numbers at an axis.
pub(super) const TICK: Font = Font { size: 11.0, class: "m" };
/// Legend and notes.
pub(super) const NOTE: Font = Font { size: 12.0, class: "m" };
/// Label of a series, in its colour.
pub(super) const LABEL: Font = Font { size: 12.0, class: "label" };

/// Which part of a text stands at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Shape of a marker: besides colour, what tells series apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Marker {
    Circle,
    Square,
    Diamond,
    Triangle,
    /// At the edge: the value lies beyond.
    Beyond,
}

impl Marker {
    /// The shape of series `index`.
    pub fn of(index: usize) -> Self {
        [Marker::Circle, Marker::Square, Marker::Diamond, Marker::Triangle][index % 4]
    }
}

/// A figure being drawn, from top to bottom.
#[derive(Debug)]
pub(super) struct Canvas {
    name: &'static str,
    title: String,
    description: String,
    body: String,
    /// Ordered colours in use.
    series: usize,
    clips: usize,
    /// Where the next thing below begins.
    pub y: f64,
}

/// What a reader's cursor calls something drawn, and which entries of the legend show and hide it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Trace<'a> {
    /// Which of the several things of one kind: a magnitude.
    pub series: &'a str,
    /// What it shows: measured, before, after.
    pub name: &'a str,
    /// Keys of the legend, with spaces between them.
    pub keys: &'a str,
    /// Whether the cursor shows the hints of what is drawn in the place of its coordinates.
    pub hints: bool,
}

impl<'a> Trace<'a> {
    /// What the cursor passes by, shown and hidden by these keys.
    pub fn keyed(keys: &'a str) -> Self {
        Self { keys, ..Self::default() }
    }

    fn attributes(&self) -> String {
        let parts = [("series", self.series), ("name", self.name), ("keys", self.keys)];
        let given = parts.into_iter().filter(|(_, text)| !text.is_empty());
        let mut attributes: String =
            given.map(|(name, text)| format!(" data-{name}=\"{}\"", escape(text))).collect();
        if self.hints {
            attributes.push_str(" data-hints=\"\"");
        }
        attributes
    }
}

fn inside(sides: [f64; 4]) -> String {
    let [left, top, right, bottom] = sides.map(px);
    format!(" data-in=\"{left} {top} {right} {bottom}\"")
}

/// A coordinate with a tenth of a pixel. What is not finite is a mistake, and
/// stands at the origin rather than spoiling the whole file.
fn px(value: f64) -> impl Display {
    debug_assert!(value.is_finite(), "a coordinate is not finite");
    let value = if value.is_finite() { value } else { 0.0 };
    (value * 10.0).round() / 10.0 + 0.0
}

/// Text for XML: what has a meaning there is escaped, what is not allowed there
/// is replaced.
pub(super) fn escape(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut escaped, character| {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            other => escaped.push(other),
        }
        escaped
    })
}

impl Canvas {
    /// A figure with its title and what it says in a line or two.
    pub fn new(name: &'static str, title: &str, subtitle: &str, series: usize) -> Self {
        let mut canvas = Self {
            name,
            title: title.to_owned(),
            description: subtitle.to_owned(),
            body: String::new(),
            series,
            clips: 0,
            y: 54.0,
        };
        let room = WIDTH - 2.0 * MARGIN;
        canvas.text(MARGIN, 32.0, TITLE, Anchor::Start, &text::shorten(title, TITLE.size, room));
        for line in text::wrap(subtitle, SUBTITLE.size, room, 2) {
            canvas.text(MARGIN, canvas.y, SUBTITLE, Anchor::Start, &line);
            canvas.y += 18.0;
        }
        canvas.y += 6.0;
        canvas
    }

    /// Adds to what the figure says to those who do not see it.
    pub fn describe(&mut self, sentence: &str) {
        self.description.push(' ');
        self.description.push_str(sentence);
    }

    /// Begins a group of this class.
    pub fn open(&mut self, class: &str) {
        let _ = write!(self.body, "<g class=\"{class}\">");
    }

    /// Ends a group.
    pub fn close(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// Begins a group of what moves with the axes of the panel that has these sides.
    pub fn open_inside(&mut self, class: &str, sides: [f64; 4], trace: Trace<'_>) {
        let _ = write!(self.body, "<g class=\"{class}\"{}{}>", inside(sides), trace.attributes());
    }

    /// The same, of which nothing shows outside the panel.
    pub fn open_clipped(&mut self, class: &str, sides: [f64; 4]) {
        self.open_trace(class, sides, Trace::default());
    }

    /// The same with what it is called, and what shows and hides it.
    pub fn open_trace(&mut self, class: &str, sides: [f64; 4], trace: Trace<'_>) {
        let [left, top, right, bottom] = sides;
        let id = format!("{OWN_ID}-clip-{}", self.clips);
        self.clips += 1;
        let (width, height) = (px(right - left), px(bottom - top));
        let (x, y) = (px(left), px(top));
        let (inside, trace) = (inside(sides), trace.attributes());
        let _ = write!(
            self.body,
            "<clipPath id=\"{id}\"><rect x=\"{x}\" y=\"{y}\" width=\"{width}\" \
             height=\"{height}\"/></clipPath><g class=\"{class}\"{inside}{trace} \
             clip-path=\"url(#{id})\">"
        );
    }

    /// Begins what a panel draws anew where its axes move: grid and numbers. `axes` are its
    /// scales and their names, horizontal first; `numbered`: which of them have numbers.
    pub fn open_grid(&mut self, sides: [f64; 4], axes: [(String, &str); 2], numbered: [bool; 2]) {
        let [left, top, right, bottom] = sides.map(px);
        let [(x, x_name), (y, y_name)] = axes;
        let numbered: String = ["x", "y"]
            .into_iter()
            .zip(numbered)
            .filter(|(_, on)| *on)
            .map(|(name, _)| name)
            .collect();
        let _ = write!(
            self.body,
            "<g data-panel=\"{left} {top} {right} {bottom}\" data-x=\"{x}\" data-x-name=\"{}\" \
             data-y=\"{y}\" data-y-name=\"{}\" data-numbered=\"{numbered}\">",
            escape(x_name),
            escape(y_name),
        );
    }

    /// Begins an entry of a legend that shows and hides what has this key.
    pub fn open_toggle(&mut self, key: &str) {
        let _ = write!(self.body, "<g data-toggle=\"{key}\">");
    }

    pub fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        let ([x1, y1], [x2, y2]) = (from.map(px), to.map(px));
        let _ = write!(self.body, "<path class=\"{class}\" d=\"M{x1} {y1}L{x2} {y2}\"/>");
    }

    /// One line through points; it breaks where there is none.
    pub fn polyline(&mut self, class: &str, points: impl IntoIterator<Item = Option<[f64; 2]>>) {
        let mut path = String::new();
        let mut pen_is_down = false;
        for point in points {
            if let Some([x, y]) = point {
                let command = if pen_is_down { 'L' } else { 'M' };
                let _ = write!(path, "{command}{} {}", px(x), px(y));
            }
            pen_is_down = point.is_some();
        }
        if !path.is_empty() {
            let _ = write!(self.body, "<path class=\"{class}\" d=\"{path}\"/>");
        }
    }

    /// The area within points.
    pub fn area(&mut self, class: &str, points: &[[f64; 2]]) {
        self.polyline(class, points.iter().copied().map(Some));
    }

    /// A rectangle with what a pointer on it shows.
    pub fn rectangle(&mut self, class: &str, sides: [f64; 4], hint: &str) {
        let [left, top, right, bottom] = sides;
        let (width, height) = (px((right - left).max(0.0)), px((bottom - top).max(0.0)));
        let (x, y) = (px(left), px(top));
        let _ = write!(
            self.body,
            "<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\""
        );
        self.hint(hint, "rect");
    }

    /// A marker with what a pointer on it shows.
    pub fn marker(&mut self, shape: Marker, [x, y]: [f64; 2], radius: f64, hint: &str) {
        let r = radius;
        let (element, points): (&str, &[[f64; 2]]) = match shape {
            Marker::Circle => ("circle", &[]),
            Marker::Square => ("path", &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
            Marker::Diamond => ("path", &[[0.0, -1.3], [1.3, 0.0], [0.0, 1.3], [-1.3, 0.0]]),
            Marker::Triangle => ("path", &[[0.0, -1.25], [1.2, 0.9], [-1.2, 0.9]]),
            Marker::Beyond => ("path", &[[0.0, 1.1], [1.1, -0.8], [-1.1, -0.8]]),
        };
        if points.is_empty() {
            let _ = write!(self.body, "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"", px(x), px(y), px(r));
        } else {
            let _ = write!(self.body, "<path transform=\"translate({} {})\" d=\"", px(x), px(y));
            for (i, [dx, dy]) in points.iter().enumerate() {
                let command = if i == 0 { 'M' } else { 'L' };
                let _ = write!(self.body, "{command}{} {}", px(r * dx), px(r * dy));
            }
            self.body.push_str("Z\"");
        }
        self.hint(hint, element);
    }

    fn hint(&mut self, hint: &str, element: &str) {
        let _ = match hint {
            "" => write!(self.body, "/>"),
            hint => write!(self.body, "><title>{}</title></{element}>", escape(hint)),
        };
    }

    pub fn text(&mut self, x: f64, y: f64, font: Font, anchor: Anchor, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let _ = write!(
            self.body,
            "<text class=\"{}\" x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{anchor}\">{}\
             </text>",
            font.class,
            px(x),
            px(y),
            px(font.size),
            escape(text)
        );
    }

    /// Sentences below what is drawn.
    pub fn note(&mut self, sentence: &str) {
        for line in text::wrap(sentence, NOTE.size, WIDTH - 2.0 * MARGIN, 3) {
            self.text(MARGIN, self.y + 12.0, NOTE, Anchor::Start, &line);
            self.y += NOTE_LINE;
        }
    }

    /// The whole file. Its ids begin with `servoscope-`, the name of the figure
    /// and `suffix`, so that figures stand side by side in one page.
    pub fn finish(self, format: Format, suffix: &str) -> String {
        let id = format!("servoscope-{}{suffix}", self.name);
        let height = (self.y + 14.0).ceil();
        let [shown_width, shown_height] = format.size([WIDTH, height]).map(px);
        let height = px(height);
        let style = theme::stylesheet(format.theme, &id, self.series);
        let (title, description) = (escape(&self.title), escape(&self.description));
        let body = self.body.replace(OWN_ID, &id);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" id=\"{id}\" role=\"img\" \
             aria-labelledby=\"{id}-title {id}-desc\" width=\"{shown_width}\" \
             height=\"{shown_height}\" viewBox=\"0 0 {WIDTH} {height}\">\n<title id=\"{id}-title\">{title}</title>\n\
             <desc id=\"{id}-desc\">{description}</desc>\n<style>\n{style}</style>\n\
             <rect class=\"bg\" width=\"{WIDTH}\" height=\"{height}\"/>\n{body}\n</svg>\n"
        )
    }
}
