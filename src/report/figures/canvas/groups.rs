//! Groups of what is drawn: what moves with the axes of a panel, and what a legend shows and hides.

use std::fmt::Write as _;

use super::{Canvas, OWN_ID, escape, px};

/// What a reader's cursor calls something drawn, and which entries of the legend show and hide it.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::report::figures) struct Trace<'a> {
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

impl Canvas {
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
}
