//! A pair of axes with its grid, and the legend above.

use super::canvas::{AXIS, Anchor, Canvas, Font, HEADING, MARGIN, Marker, NOTE, TICK};
use super::scale::{Scale, Tick};
use super::text;

/// Where a panel stands, and its scales.
#[derive(Debug, Clone, Copy)]
pub(super) struct Panel {
    pub x: Scale,
    pub y: Scale,
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

/// What stands around a panel; empty: nothing.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Naming<'a> {
    /// What the panel shows, where there are several.
    pub heading: &'a str,
    /// Quantity and unit of the horizontal axis.
    pub x: &'a str,
    /// The same where the numbers stand below another panel.
    pub x_below: &'a str,
    /// Quantity and unit of the vertical axis.
    pub y: &'a str,
}

impl Panel {
    /// Its sides: left, top, right, bottom.
    pub fn sides(&self) -> [f64; 4] {
        [self.left, self.top, self.right, self.bottom]
    }

    /// Where a point stands, if it has a place.
    pub fn at(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        Some([self.x.at(x)?, self.y.at(y)?])
    }

    /// Draws grid, frame, numbers and names. Without a name the horizontal axis
    /// has no numbers either: it is that of the panel below.
    pub fn draw(&self, canvas: &mut Canvas, vertical: &[Tick], naming: Naming<'_>) {
        self.draw_with(canvas, &self.x.horizontal_ticks(TICK.size), vertical, naming);
    }

    /// The same with numbers of one's own.
    pub fn draw_with(
        &self,
        canvas: &mut Canvas,
        horizontal: &[Tick],
        vertical: &[Tick],
        naming: Naming<'_>,
    ) {
        let [left, top, right, bottom] = self.sides();
        let inside = |px: &f64| *px > left + 0.5 && *px < right - 0.5;
        let x_name = if naming.x.is_empty() { naming.x_below } else { naming.x };
        let axes = [(self.x.described(), x_name), (self.y.described(), naming.y)];
        canvas.open_grid(self.sides(), axes, [!naming.x.is_empty(), !vertical.is_empty()]);
        for px in self.x.minor().iter().filter(|px| inside(px)) {
            canvas.line("minor", [*px, top], [*px, bottom]);
        }
        for px in horizontal.iter().map(|tick| tick.px).filter(inside) {
            canvas.line("grid", [px, top], [px, bottom]);
        }
        for tick in vertical.iter().filter(|tick| tick.px > top + 0.5 && tick.px < bottom - 0.5) {
            canvas.line("grid", [left, tick.px], [right, tick.px]);
        }
        for tick in vertical {
            canvas.text(left - 7.0, tick.px + 4.0, TICK, Anchor::End, &tick.label);
        }
        if !naming.x.is_empty() {
            for tick in horizontal.iter().filter(|tick| !tick.label.is_empty()) {
                canvas.text(tick.px, bottom + 16.0, TICK, Anchor::Middle, &tick.label);
            }
        }
        canvas.close();
        canvas.rectangle("frame", self.sides(), "");
        if !naming.x.is_empty() {
            let name = text::shorten(naming.x, AXIS.size, right - left);
            canvas.text(0.5 * (left + right), bottom + 33.0, AXIS, Anchor::Middle, &name);
        }
        // Above the axis, not turned beside it: read without turning the head.
        let mut y = top - 8.0;
        if !naming.y.is_empty() {
            let begin = if naming.heading.is_empty() { left - 40.0 } else { left };
            let begin = begin.max(MARGIN);
            canvas.text(begin, y, AXIS, Anchor::Start, naming.y);
        }
        if !naming.heading.is_empty() {
            y -= 16.0;
            let heading = text::shorten(naming.heading, HEADING.size, right - left + 12.0);
            canvas.text(left, y, HEADING, Anchor::Start, &heading);
        }
    }
}

/// One entry of a legend: how it looks, its class and its text.
#[derive(Debug, Clone)]
pub(super) struct Key {
    pub look: Look,
    pub class: String,
    pub text: String,
    /// What it shows and hides; empty: nothing.
    pub toggles: String,
}

/// How an entry of a legend looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    Marker(Marker),
    Beyond,
    Line(&'static str),
    Area,
    /// A rectangle of this class.
    Shade(&'static str),
}

impl Key {
    pub fn new(look: Look, class: impl Into<String>, text: impl Into<String>) -> Self {
        Self { look, class: class.into(), text: text.into(), toggles: String::new() }
    }

    /// The same, showing and hiding what has this key.
    pub fn toggling(self, key: impl Into<String>) -> Self {
        Self { toggles: key.into(), ..self }
    }
}

/// Draws a legend in as many lines as it takes, and moves on below.
pub(super) fn legend(canvas: &mut Canvas, keys: &[Key]) {
    const SAMPLE: f64 = 22.0;
    const FONT: Font = NOTE;
    let (mut x, right) = (MARGIN, canvas.width - MARGIN);
    let mut y = canvas.y + 8.0;
    for key in keys {
        let width = SAMPLE + 6.0 + text::width(&key.text, FONT.size);
        if x > MARGIN && x + width > right {
            x = MARGIN;
            y += 19.0;
        }
        let middle = [x + 0.5 * SAMPLE, y];
        let class = &key.class;
        if !key.toggles.is_empty() {
            canvas.open_toggle(&key.toggles);
        }
        match key.look {
            Look::Marker(shape) => {
                canvas.open(&format!("{class} measured"));
                canvas.marker(shape, middle, 3.4, "");
                canvas.close();
            }
            Look::Beyond => {
                canvas.open(&format!("{class} rest"));
                canvas.marker(Marker::Beyond, middle, 4.0, "");
                canvas.close();
            }
            Look::Line(style) => {
                canvas.open(class);
                canvas.line(style, [x, y], [x + SAMPLE, y]);
                canvas.close();
            }
            Look::Shade(class) => {
                canvas.rectangle(class, [x, y - 5.0, x + SAMPLE, y + 5.0], "");
            }
            Look::Area => {
                canvas.open(class);
                canvas.rectangle("band", [x, y - 5.0, x + SAMPLE, y + 5.0], "");
                canvas.close();
            }
        }
        canvas.text(x + SAMPLE + 6.0, y + 4.0, FONT, Anchor::Start, &key.text);
        if !key.toggles.is_empty() {
            canvas.close();
        }
        x += width + 20.0;
    }
    canvas.y = y + 14.0;
}
