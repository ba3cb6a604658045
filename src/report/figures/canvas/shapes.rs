//! Lines, areas and markers.

use std::fmt::Write as _;

use super::{Canvas, escape, px};

/// Shape of a marker: besides colour, what tells series apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::report::figures) enum Marker {
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

impl Canvas {
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
}
