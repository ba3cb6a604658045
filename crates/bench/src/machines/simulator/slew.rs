//! A rate limiter in its periodic steady state.
//!
//! w is the output of the limiter and x its input, which the stretches describe.

use super::input::{Input, Stretch, first_change};

/// Mode of the limiter.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    /// w = x.
    Follow,
    /// w' = ±rate towards x; the value is the direction, +1 or −1.
    Ramp(f64),
}

/// The periodic output w of the limiter: w' = ±rate until w meets x again, and w = x while
/// |x'| ≤ rate.
///
/// The map of w over one period is non-decreasing and non-expansive, so bisection for a change of
/// sign of w(T) − w(0) finds the periodic value. If w meets x and follows it, w no longer depends
/// on its initial value, and the second period is periodic already.
pub(super) fn slew_limited(input: &Input, stretches: &[Stretch], rate: f64) -> Vec<Stretch> {
    let limiter = Limiter { input, stretches, rate };
    let first = limiter.input_at(&stretches[0], 0.0).0;
    let (_, start) = limiter.one_period(first);
    let (limited, end) = limiter.one_period(start);
    let (mut low, mut high) = limiter.range();
    if (end - start).abs() <= 1e-14 * (high - low) {
        return limited;
    }
    while high - low > 1e-15 * high.abs().max(low.abs()) {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if limiter.one_period(middle).1 > middle {
            low = middle;
        } else {
            high = middle;
        }
    }
    limiter.one_period(0.5 * (low + high)).0
}

struct Limiter<'a> {
    input: &'a Input,
    stretches: &'a [Stretch],
    rate: f64,
}

impl Limiter<'_> {
    /// x and x' at a time within a stretch.
    fn input_at(&self, stretch: &Stretch, time_s: f64) -> (f64, f64) {
        let (value, rate) = self.input.value_and_rate(time_s);
        (stretch.offset + stretch.gain * value, stretch.gain * rate)
    }

    /// Smallest and largest x, at the ends of the search intervals.
    fn range(&self) -> (f64, f64) {
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for stretch in self.stretches {
            self.for_each_interval(stretch, |from_s, to_s| {
                for time_s in [from_s, to_s] {
                    let x = self.input_at(stretch, time_s).0;
                    range = (range.0.min(x), range.1.max(x));
                }
            });
        }
        range
    }

    /// Calls `visit` with the beginning and end of each search interval of a stretch.
    fn for_each_interval(&self, stretch: &Stretch, mut visit: impl FnMut(f64, f64)) {
        let length_s = stretch.to_s - stretch.from_s;
        let count = (length_s / self.input.search_interval_s()).ceil().max(1.0) as usize;
        let time_s = |i: usize| stretch.from_s + length_s * i as f64 / count as f64;
        (0..count).for_each(|i| visit(time_s(i), time_s(i + 1)));
    }

    /// The limiter's stretches from w = `start`, and w at the end of the period.
    fn one_period(&self, start: f64) -> (Vec<Stretch>, f64) {
        let (x, _) = self.input_at(&self.stretches[0], 0.0);
        let mode = match start - x {
            // Equal to within rounding errors: w follows x.
            apart if apart.abs() <= 1e-12 * x.abs() => Mode::Follow,
            apart => Mode::Ramp(-apart.signum()),
        };
        let mut pass = Pass { limiter: self, mode, w: start, out: Vec::new() };
        for stretch in self.stretches {
            pass.open(stretch, stretch.from_s);
            self.for_each_interval(stretch, |from_s, to_s| pass.advance(stretch, from_s, to_s));
        }
        (pass.out, pass.w)
    }
}

/// One pass through the period.
struct Pass<'a> {
    limiter: &'a Limiter<'a>,
    mode: Mode,
    w: f64,
    out: Vec<Stretch>,
}

impl Pass<'_> {
    /// Begins a new stretch of the output in the current mode.
    fn open(&mut self, stretch: &Stretch, from_s: f64) {
        let opened = match self.mode {
            Mode::Follow => Stretch { from_s, to_s: from_s, ..*stretch },
            Mode::Ramp(direction) => Stretch {
                from_s,
                to_s: from_s,
                offset: self.w,
                gain: 0.0,
                slope: direction * self.limiter.rate,
            },
        };
        // Remove the previous stretch if it has zero length.
        self.out.pop_if(|last| last.to_s <= last.from_s);
        self.out.push(opened);
    }

    fn change(&mut self, mode: Mode, stretch: &Stretch, at_s: f64) {
        self.mode = mode;
        self.open(stretch, at_s);
    }

    fn extend(&mut self, stretch: &Stretch, to_s: f64) {
        let Some(last) = self.out.last_mut() else { return };
        last.to_s = to_s;
        self.w = match self.mode {
            Mode::Follow => self.limiter.input_at(stretch, to_s).0,
            Mode::Ramp(_) => last.offset + last.slope * (to_s - last.from_s),
        };
    }

    /// Advances from `from_s` to `to_s`, an interval so short that each kind of event happens at
    /// most once.
    fn advance(&mut self, stretch: &Stretch, mut from_s: f64, to_s: f64) {
        let rate = self.limiter.rate;
        let x = |time_s: f64| self.limiter.input_at(stretch, time_s);
        let mut separated = false;
        while from_s < to_s {
            match self.mode {
                Mode::Follow => {
                    let slope = x(from_s).1;
                    if slope.abs() > rate && !separated {
                        separated = true;
                        self.change(Mode::Ramp(slope.signum()), stretch, from_s);
                    } else if x(to_s).1.abs() <= rate || separated {
                        self.extend(stretch, to_s);
                        from_s = to_s;
                    } else {
                        separated = true;
                        from_s = first_change(from_s, to_s, |t| x(t).1.abs() > rate);
                        self.extend(stretch, from_s);
                        self.change(Mode::Ramp(x(from_s).1.signum()), stretch, from_s);
                    }
                }
                Mode::Ramp(direction) => {
                    let (w, since_s) = (self.w, from_s);
                    let met = |t: f64| direction * (x(t).0 - w) <= rate * (t - since_s);
                    if !met(to_s) {
                        self.extend(stretch, to_s);
                        return;
                    }
                    // If w separates from x and meets it within one interval, it follows x.
                    let meets_s = if separated { from_s } else { first_change(from_s, to_s, met) };
                    self.extend(stretch, meets_s);
                    let slope = x(meets_s).1;
                    let turns = direction * slope < -rate && !separated;
                    let mode = if turns { Mode::Ramp(-direction) } else { Mode::Follow };
                    separated = true;
                    self.change(mode, stretch, meets_s);
                    from_s = meets_s;
                }
            }
        }
    }
}
