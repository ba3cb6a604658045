//! SVG as text, element by element.

mod groups;
mod shapes;

use std::fmt::{Display, Write as _};

use super::text;
use super::theme::{self, Format};

pub(super) use groups::Trace;
pub(super) use shapes::Marker;

/// Width of a figure, pixels.
pub(super) const WIDTH: f64 = 800.0;

/// Width of a figure for a phone, pixels.
pub(super) const PHONE_WIDTH: f64 = 400.0;

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
    /// Its width, pixels.
    pub width: f64,
    /// Where the next thing below begins.
    pub y: f64,
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
        Self::of_width(WIDTH, name, title, subtitle, series)
    }

    /// The same of another width.
    pub fn of_width(
        width: f64,
        name: &'static str,
        title: &str,
        subtitle: &str,
        series: usize,
    ) -> Self {
        let mut canvas = Self {
            name,
            title: title.to_owned(),
            description: subtitle.to_owned(),
            body: String::new(),
            series,
            clips: 0,
            width,
            y: 54.0,
        };
        let room = width - 2.0 * MARGIN;
        let lines = (2.0 * WIDTH / width) as usize;
        canvas.text(MARGIN, 32.0, TITLE, Anchor::Start, &text::shorten(title, TITLE.size, room));
        for line in text::wrap(subtitle, SUBTITLE.size, room, lines) {
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
        for line in text::wrap(sentence, NOTE.size, self.width - 2.0 * MARGIN, 3) {
            self.text(MARGIN, self.y + 12.0, NOTE, Anchor::Start, &line);
            self.y += NOTE_LINE;
        }
    }

    /// The whole file. Its ids begin with `servoscope-`, the name of the figure
    /// and `suffix`, so that figures stand side by side in one page.
    pub fn finish(self, format: Format, suffix: &str) -> String {
        let id = format!("servoscope-{}{suffix}", self.name);
        let (width, height) = (self.width, (self.y + 14.0).ceil());
        let [shown_width, shown_height] = format.size([width, height]).map(px);
        let height = px(height);
        let style = theme::stylesheet(format.theme, &id, self.series);
        let (title, description) = (escape(&self.title), escape(&self.description));
        let body = self.body.replace(OWN_ID, &id);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" id=\"{id}\" role=\"img\" \
             aria-labelledby=\"{id}-title {id}-desc\" width=\"{shown_width}\" \
             height=\"{shown_height}\" viewBox=\"0 0 {width} {height}\">\n<title id=\"{id}-title\">{title}</title>\n\
             <desc id=\"{id}-desc\">{description}</desc>\n<style>\n{style}</style>\n\
             <rect class=\"bg\" width=\"{width}\" height=\"{height}\"/>\n{body}\n</svg>\n"
        )
    }
}
