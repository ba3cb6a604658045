//! The input of the actuator, piecewise linear in time: delayed, mapped and rate-limited.

use crate::effects::{Axis, InputMap};

use super::motion::SampledInput;
use crate::measurement::Intersample;

/// Pieces shorter than this share of a sampling step are dropped: they come from rounding.
const SHORTEST_PIECE: f64 = 1e-9;

/// A linear piece of a signal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    /// Start, seconds.
    pub from_s: f64,
    /// Length, seconds.
    pub length_s: f64,
    /// Value at the start.
    pub start: f64,
    /// Change per second.
    pub slope: f64,
}

impl Line {
    fn at(&self, since_s: f64) -> f64 {
        self.start + self.slope * since_s
    }

    fn part(&self, from: f64, to: f64) -> Self {
        Self { from_s: self.from_s + from, length_s: to - from, start: self.at(from), ..*self }
    }
}

/// The pieces over the record, and the actuator's input before the record, when the input was
/// constant at `before`.
pub(super) fn of(axis: &Axis, input: &SampledInput<'_>, before: f64) -> (Vec<Line>, f64) {
    let mut lines = delayed(sampled(input), axis.delay, before);
    let mut input_before = before;
    let shortest_s = SHORTEST_PIECE * input.step_s;
    for map in &axis.input_maps {
        lines = mapped(&lines, map, shortest_s);
        input_before = mapped_value(map, input_before);
    }
    if let Some(rate) = axis.rate_limit {
        lines = limited(&lines, rate, input_before, shortest_s);
    }
    (lines, input_before)
}

fn sampled(input: &SampledInput<'_>) -> Vec<Line> {
    let h = input.step_s;
    let line = |(n, pair): (usize, &[f64])| Line {
        from_s: n as f64 * h,
        length_s: h,
        start: pair[0],
        slope: match input.between {
            Intersample::Linear => (pair[1] - pair[0]) / h,
            Intersample::Hold => 0.0,
        },
    };
    input.values.windows(2).enumerate().map(line).collect()
}

/// The signal delayed by `delay`, cut to the time of the record; `before` is its value before it.
fn delayed(lines: Vec<Line>, delay: f64, before: f64) -> Vec<Line> {
    let Some(last) = lines.last() else { return lines };
    let end_s = last.from_s + last.length_s;
    let shortest_s = SHORTEST_PIECE * last.length_s;
    if delay.abs() <= shortest_s {
        return lines;
    }
    let after = last.at(last.length_s);
    let ahead = Line { from_s: 0.0, length_s: delay, start: before, slope: 0.0 };
    let behind = Line { from_s: end_s + delay, length_s: -delay, start: after, slope: 0.0 };
    let moved = lines.into_iter().map(|line| Line { from_s: line.from_s + delay, ..line });
    let whole = [ahead].into_iter().chain(moved).chain([behind]);
    whole
        .filter_map(|line| {
            let from = (-line.from_s).max(0.0);
            let to = line.length_s.min(end_s - line.from_s);
            let whole = from == 0.0 && to == line.length_s;
            (to - from > shortest_s).then(|| if whole { line } else { line.part(from, to) })
        })
        .collect()
}

/// The output of a static map.
fn mapped_value(map: &InputMap<f64>, u: f64) -> f64 {
    let (offset, slope) = map.piece(map.breaks.iter().filter(|at| **at < u).count());
    offset + slope * u
}

/// The signal behind a static map, cut where the slope of the map changes.
fn mapped(lines: &[Line], map: &InputMap<f64>, shortest_s: f64) -> Vec<Line> {
    let mut out = Vec::with_capacity(lines.len() + lines.len() / 8);
    for line in lines {
        let mut cuts = vec![0.0, line.length_s];
        let crossed = map.breaks.iter().map(|level| (level - line.start) / line.slope);
        cuts.extend(crossed.filter(|cut| *cut > shortest_s && *cut < line.length_s - shortest_s));
        cuts.sort_by(f64::total_cmp);
        for cut in cuts.windows(2).filter(|cut| cut[1] - cut[0] > shortest_s) {
            let whole = cut[0] == 0.0 && cut[1] == line.length_s;
            let part = if whole { *line } else { line.part(cut[0], cut[1]) };
            let middle = part.at(0.5 * part.length_s);
            let piece = map.breaks.iter().filter(|at| **at < middle).count();
            let (offset, gain) = map.piece(piece);
            let (start, slope) = (offset + gain * part.start, gain * part.slope);
            out.push(Line { start, slope, ..part });
        }
    }
    out
}

/// The output w of a rate limiter, which begins at `w`: w' = ±rate until w meets the signal, then w
/// is the signal while that changes no faster than `rate`.
fn limited(lines: &[Line], rate: f64, mut w: f64, shortest_s: f64) -> Vec<Line> {
    let mut out = Vec::with_capacity(lines.len() + lines.len() / 8);
    for line in lines {
        let mut done = 0.0;
        while line.length_s - done > shortest_s {
            let left_s = line.length_s - done;
            let apart = line.at(done) - w;
            // A w that follows the signal differs from it by rounding.
            let follows = apart.abs() <= 1e-12 * w.abs();
            if follows && line.slope.abs() <= rate {
                let whole = done == 0.0;
                out.push(if whole { *line } else { line.part(done, line.length_s) });
                w = line.at(line.length_s);
                break;
            }
            let slope = rate * if follows { line.slope.signum() } else { apart.signum() };
            let meets_s = apart / (slope - line.slope);
            let ramps_s = match meets_s {
                meets_s if !follows && meets_s > 0.0 && meets_s < left_s => meets_s,
                _ => left_s,
            };
            let (from_s, start) = (line.from_s + done, w);
            if ramps_s > shortest_s {
                out.push(Line { from_s, length_s: ramps_s, start, slope });
            }
            done += ramps_s;
            w = if ramps_s < left_s { line.at(done) } else { w + slope * ramps_s };
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from_s: f64, length_s: f64, start: f64, slope: f64) -> Line {
        Line { from_s, length_s, start, slope }
    }

    #[test]
    fn a_delayed_input_has_the_value_of_its_first_sample_before_it() {
        let lines = vec![line(0.0, 1.0, 2.0, 1.0), line(1.0, 1.0, 3.0, -1.0)];
        let moved = delayed(lines, 0.25, 2.0);
        assert_eq!(moved[0], line(0.0, 0.25, 2.0, 0.0));
        assert_eq!(moved[1], line(0.25, 1.0, 2.0, 1.0));
        assert_eq!(moved[2], line(1.25, 0.75, 3.0, -1.0));
    }

    #[test]
    fn a_limited_rate_ramps_until_it_meets() {
        // A step up, and a second later a step down: ramps of half a second each.
        let lines = vec![line(0.0, 1.0, 1.0, 0.0), line(1.0, 1.0, 0.0, 0.0)];
        let out = limited(&lines, 2.0, 0.0, 1e-9);
        let expected = [
            line(0.0, 0.5, 0.0, 2.0),
            line(0.5, 0.5, 1.0, 0.0),
            line(1.0, 0.5, 1.0, -2.0),
            line(1.5, 0.5, 0.0, 0.0),
        ];
        assert_eq!(out, expected);
        // A signal that is always too fast is met on its way back.
        let lines = vec![line(0.0, 1.0, 0.0, 3.0), line(1.0, 1.0, 3.0, -3.0)];
        let out = limited(&lines, 1.0, 0.0, 1e-9);
        assert_eq!(out[..2], [line(0.0, 1.0, 0.0, 1.0), line(1.0, 0.5, 1.0, 1.0)]);
        assert_eq!(out[2], line(1.5, 0.5, 1.5, -1.0));
    }
}
