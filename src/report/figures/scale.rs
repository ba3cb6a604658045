//! From values to pixels, and the numbers an axis shows.

use super::text;

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

/// A number at an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub px: f64,
    /// Empty: a line without a number.
    pub label: String,
}

/// Steps of a decimal axis, times powers of ten.
pub(super) const DECIMAL: &[f64] = &[1.0, 2.0, 5.0];

/// Steps that divide a turn, degrees.
pub(super) const DEGREES: &[f64] =
    &[0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0];

/// Least distance of numbers on a vertical axis, pixels.
const VERTICAL_SPACING: f64 = 26.0;

/// Space between numbers on a horizontal axis, pixels.
const HORIZONTAL_GAP: f64 = 12.0;

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

    /// Numbers for a vertical axis, in these steps if it is linear.
    pub fn vertical_ticks(&self, steps: &[f64]) -> Vec<Tick> {
        let least = VERTICAL_SPACING / (self.to_px - self.from_px).abs();
        match self.kind {
            Kind::Linear => self.even(steps, least),
            Kind::Log => self.decades(least),
        }
    }

    /// Numbers for a horizontal axis: as many as stand beside each other.
    pub fn horizontal_ticks(&self, font_size: f64) -> Vec<Tick> {
        let fits = |ticks: &[Tick]| {
            let mut end = f64::NEG_INFINITY;
            ticks.iter().filter(|tick| !tick.label.is_empty()).all(|tick| {
                let half = 0.5 * text::width(&tick.label, font_size);
                let clear = tick.px - half >= end + HORIZONTAL_GAP;
                end = tick.px + half;
                clear
            })
        };
        if self.kind == Kind::Log {
            // The plainest first; only a short axis needs more numbers than 1, 2 and 5.
            let enough = |ticks: &[Tick], least: usize| ticks.len() >= least && fits(ticks);
            let choices =
                [(DECIMAL, 4), (&[1.0, 2.0, 3.0, 5.0, 7.0][..], 4), (&[1.0, 3.0], 3), (&[1.0], 2)];
            for (factors, least) in choices {
                let ticks = self.within_decades(factors);
                if enough(&ticks, least) {
                    return ticks;
                }
            }
            if self.high - self.low > 1.0 {
                return self.decades(60.0 / (self.to_px - self.from_px).abs());
            }
        }
        let widest = (1..=10).rev().map(|count| self.even(DECIMAL, 1.0 / f64::from(count)));
        let mut fitting = widest.filter(|ticks| fits(ticks));
        fitting.next().unwrap_or_default()
    }

    /// Values in even steps, of which each takes at least this share of the axis.
    fn even(&self, steps: &[f64], least: f64) -> Vec<Tick> {
        let [low, high] = [self.low, self.high]
            .map(|value| if self.kind == Kind::Log { 10.0_f64.powf(value) } else { value });
        let wanted = least * (high - low);
        let step = if steps == DECIMAL {
            let power = 10.0_f64.powf(wanted.log10().floor());
            steps
                .iter()
                .map(|s| s * power)
                .find(|s| *s >= wanted * (1.0 - 1e-9))
                .unwrap_or(10.0 * power)
        } else {
            let last = steps.last().copied().unwrap_or(1.0);
            steps.iter().copied().find(|s| *s >= wanted).unwrap_or(last * (wanted / last).ceil())
        };
        let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        let written = |value: f64| match value.abs().max(step) {
            size if !(1e-4..1e6).contains(&size) => text::number(value, 4),
            _ => format!("{value:.decimals$}").replace('-', "−"),
        };
        (0..=(last - first).clamp(0.0, 100.0) as usize)
            .filter_map(|i| {
                let value = (first + i as f64) * step + 0.0;
                Some(Tick { px: self.at(value)?, label: written(value) })
            })
            .collect()
    }

    /// Powers of ten, or 1, 2 and 5 times them where there are few.
    fn decades(&self, least: f64) -> Vec<Tick> {
        let room = 1.0 / least;
        let decades = self.high - self.low;
        if decades < 2.0 {
            let dense = self.within_decades(DECIMAL);
            // 0.3 of a decade lies between neighbours.
            if dense.len() >= 3 && 0.3 / decades >= least {
                return dense;
            }
            if decades < 1.0 {
                return self.even(DECIMAL, least);
            }
        }
        let stride = (decades / room).ceil().max(1.0) as i32;
        let (first, last) = (self.low.ceil() as i32, self.high.floor() as i32);
        // All as powers or all as numbers: mixed, the step is harder to see.
        let plain = first >= -3 && last <= 3;
        let written = |power: i32| match power {
            0 | 1 => text::number(10.0_f64.powi(power), 1),
            _ if plain => text::number(10.0_f64.powi(power), 1),
            _ => format!("10{}", text::superscript(&power.to_string())),
        };
        (first..=last)
            .filter_map(|power| {
                let label =
                    if power.rem_euclid(stride) == 0 { written(power) } else { String::new() };
                Some(Tick { px: self.at(10.0_f64.powi(power))?, label })
            })
            .collect()
    }

    fn within_decades(&self, factors: &[f64]) -> Vec<Tick> {
        let (first, last) = (self.low.floor() as i32, self.high.floor() as i32);
        let mut ticks = Vec::new();
        for power in first..=last {
            for factor in factors {
                let value = factor * 10.0_f64.powi(power);
                if self.holds(value) || self.holds(value * (1.0 + 1e-9)) {
                    let label = match power {
                        -3..=4 => text::number(value, 1),
                        _ if *factor == 1.0 => power_of_ten(power),
                        _ => format!("{factor}·{}", power_of_ten(power)),
                    };
                    ticks.extend(self.at(value).map(|px| Tick { px, label }));
                }
            }
        }
        ticks
    }

    /// Lines between the numbers of a logarithmic axis.
    pub fn minor(&self) -> Vec<f64> {
        if self.kind == Kind::Linear || self.high - self.low > 4.0 {
            return Vec::new();
        }
        let every: Vec<f64> = (1..10).map(f64::from).collect();
        self.within_decades(&every).into_iter().map(|tick| tick.px).collect()
    }
}

fn power_of_ten(power: i32) -> String {
    match power {
        -3..=3 => text::number(10.0_f64.powi(power), 1),
        _ => format!("10{}", text::superscript(&power.to_string())),
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

    fn labels(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|tick| tick.label.as_str()).collect()
    }

    #[test]
    fn a_linear_axis_shows_round_numbers() {
        let scale = Scale::linear([-0.13, 0.27], [200.0, 0.0]);
        assert_eq!(labels(&scale.vertical_ticks(DECIMAL)), ["−0.1", "0.0", "0.1", "0.2"]);
        let phase = Scale::linear([-170.0, 10.0], [200.0, 0.0]);
        let shown = phase.vertical_ticks(DEGREES);
        assert_eq!(labels(&shown), ["−150", "−120", "−90", "−60", "−30", "0"]);
    }

    #[test]
    fn a_frequency_axis_shows_decades_and_what_has_room_between() {
        let wide = Scale::log([0.1, 100.0], [0.0, 600.0]);
        assert_eq!(
            labels(&wide.horizontal_ticks(11.0)),
            ["0.1", "0.2", "0.5", "1", "2", "5", "10", "20", "50", "100"]
        );
        let narrow = Scale::log([0.1, 100.0], [0.0, 200.0]);
        assert_eq!(
            labels(&narrow.horizontal_ticks(11.0)),
            ["0.1", "0.3", "1", "3", "10", "30", "100"]
        );
        let short = Scale::log([0.1, 100.0], [0.0, 120.0]);
        assert_eq!(labels(&short.horizontal_ticks(11.0)), ["0.1", "1", "10", "100"]);
        let one = Scale::log([11.0, 14.0], [0.0, 600.0]);
        assert!(one.horizontal_ticks(11.0).len() > 3);
    }

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

    #[test]
    fn many_decades_are_numbered_with_gaps() {
        let scale = Scale::log([1e-12, 1.0], [120.0, 0.0]);
        let ticks = scale.vertical_ticks(DECIMAL);
        assert_eq!(ticks.len(), 13);
        assert!(ticks.iter().filter(|tick| !tick.label.is_empty()).count() <= 5);
    }
}
