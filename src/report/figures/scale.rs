//! From values to pixels.

mod ticks;

pub(super) use ticks::{DECIMAL, DEGREES, Tick};

/// How values map to pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Linear,
    Log,
}

/// One direction of a panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    kind: Kind,
    low: f64,
    high: f64,
    from_px: f64,
    to_px: f64,
}

impl Scale {
    /// Values from `low` to `high` evenly over the pixels; a range that is empty
    /// or no range at all is widened.
    pub fn linear([low, high]: [f64; 2], [from_px, to_px]: [f64; 2]) -> Self {
        let (low, high) = match (low.is_finite() && high.is_finite(), high - low) {
            (true, width) if width > 1e-12 * low.abs().max(high.abs()) => (low, high),
            (true, _) => (low - 1.0, high + 1.0),
            (false, _) => (0.0, 1.0),
        };
        Self { kind: Kind::Linear, low, high, from_px, to_px }
    }

    /// Ratios evenly over the pixels; likewise.
    pub fn log([low, high]: [f64; 2], pixels: [f64; 2]) -> Self {
        let usable = low > 0.0 && high > 0.0 && low.is_finite() && high.is_finite();
        let (low, high) = match usable {
            true if high > 1.0001 * low => (low, high),
            true => (low / 2.0, high * 2.0),
            false => (0.1, 10.0),
        };
        Self { kind: Kind::Log, ..Self::linear([low.log10(), high.log10()], pixels) }
    }

    /// The pixel of a value; `None` where it has none.
    pub fn at(&self, value: f64) -> Option<f64> {
        let value = self.coordinate(value);
        let share = (value - self.low) / (self.high - self.low);
        // Far beyond the edge is beyond it: numbers of a million digits help nobody.
        let share = if share.is_nan() { return None } else { share.clamp(-50.0, 50.0) };
        Some(self.from_px + share * (self.to_px - self.from_px))
    }

    /// Whether a value lies within the range.
    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&self.coordinate(value))
    }

    /// Lower and upper edge, pixels.
    pub fn edges(&self) -> [f64; 2] {
        [self.from_px, self.to_px]
    }

    /// Kind, range (logarithms where it is logarithmic) and edges, for a script that moves it.
    pub fn described(&self) -> String {
        let kind = if self.kind == Kind::Log { "log" } else { "linear" };
        let number = |value: f64| super::super::number::significant(value, 12);
        format!(
            "{kind} {} {} {} {}",
            number(self.low),
            number(self.high),
            number(self.from_px),
            number(self.to_px)
        )
    }

    fn coordinate(&self, value: f64) -> f64 {
        if self.kind == Kind::Log { value.log10() } else { value }
    }
}

/// The range of values, widened by a share of itself at both ends, and to
/// `least` at least: what hardly varies is not blown up.
pub(super) fn padded(values: impl IntoIterator<Item = f64>, share: f64, least: f64) -> [f64; 2] {
    let [low, high] = range(values);
    let pad = (share * (high - low)).max(0.5 * (least - (high - low)));
    [low - pad, high + pad]
}

/// Smallest and largest of the finite values.
pub(super) fn range(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let finite = values.into_iter().filter(|value| value.is_finite());
    finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_of_nothing_is_a_range_all_the_same() {
        for empty in [[3.0, 3.0], [f64::NAN, 1.0], [f64::INFINITY, f64::NEG_INFINITY], [0.0, 0.0]] {
            for scale in [Scale::linear(empty, [0.0, 100.0]), Scale::log(empty, [0.0, 100.0])] {
                assert!(scale.at(3.0).is_some_and(f64::is_finite), "{scale:?}");
                assert!(!scale.horizontal_ticks(11.0).is_empty(), "{scale:?}");
            }
        }
        assert_eq!(Scale::log([1.0, 10.0], [0.0, 1.0]).at(-1.0), None);
    }
}
