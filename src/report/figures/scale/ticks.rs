//! The numbers that an axis shows.

use super::super::text;
use super::{Kind, Scale};

/// A number at an axis.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::report::figures) struct Tick {
    pub px: f64,
    /// Empty: a line without a number.
    pub label: String,
}

/// Steps of a decimal axis, times powers of ten.
pub(in crate::report::figures) const DECIMAL: &[f64] = &[1.0, 2.0, 5.0];

/// Steps that divide a turn, degrees.
pub(in crate::report::figures) const DEGREES: &[f64] =
    &[0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0];

/// Least distance of numbers on a vertical axis, pixels.
const VERTICAL_SPACING: f64 = 26.0;

/// Space between numbers on a horizontal axis, pixels.
const HORIZONTAL_GAP: f64 = 12.0;

impl Scale {
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
    fn many_decades_are_numbered_with_gaps() {
        let scale = Scale::log([1e-12, 1.0], [120.0, 0.0]);
        let ticks = scale.vertical_ticks(DECIMAL);
        assert_eq!(ticks.len(), 13);
        assert!(ticks.iter().filter(|tick| !tick.label.is_empty()).count() <= 5);
    }
}
