//! A rate limiter in its own periodic state.

use super::chain::{Input, Stretch, first_change};

/// What the limiter does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    /// w = x.
    Follow,
    /// w' = rate in this direction, +1 or −1, towards x.
    Ramp(f64),
}

/// w of the limiter w' = ± rate until w meets x again, w = x while |x'| ≤ rate, where x is
/// what the stretches describe.
///
/// One period takes w to a value that never falls as w rises and never moves further apart,
/// so that the periodic value lies where the change over a period changes sign. Where w
/// meets x and follows, it forgets where it came from and a second period is periodic.
pub(super) fn slew_limited(input: &Input, stretches: &[Stretch], rate: f64) -> Vec<Stretch> {
    let limiter = Limiter { input, stretches, rate };
    let first = limiter.wanted(&stretches[0], 0.0).0;
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
    /// x and x' within a stretch.
    fn wanted(&self, stretch: &Stretch, time_s: f64) -> (f64, f64) {
        let (value, rate) = self.input.value_and_rate(time_s);
        (stretch.offset + stretch.gain * value, stretch.gain * rate)
    }

    /// Bounds of x, looked at where events are looked for.
    fn range(&self) -> (f64, f64) {
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        for stretch in self.stretches {
            self.looks(stretch, |from_s, to_s| {
                for time_s in [from_s, to_s] {
                    let x = self.wanted(stretch, time_s).0;
                    range = (range.0.min(x), range.1.max(x));
                }
            });
        }
        range
    }

    /// Calls with the beginning and end of each short interval of a stretch.
    fn looks(&self, stretch: &Stretch, mut visit: impl FnMut(f64, f64)) {
        let length_s = stretch.to_s - stretch.from_s;
        let count = (length_s / self.input.look_s()).ceil().max(1.0) as usize;
        let time_s = |i: usize| stretch.from_s + length_s * i as f64 / count as f64;
        (0..count).for_each(|i| visit(time_s(i), time_s(i + 1)));
    }

    /// The limiter's stretches from w = `start`, and w at the end of the period.
    fn one_period(&self, start: f64) -> (Vec<Stretch>, f64) {
        let (x, _) = self.wanted(&self.stretches[0], 0.0);
        let mode = match start - x {
            // Rounding of a w that follows.
            apart if apart.abs() <= 1e-12 * x.abs() => Mode::Follow,
            apart => Mode::Ramp(-apart.signum()),
        };
        let mut pass = Pass { limiter: self, mode, w: start, out: Vec::new() };
        for stretch in self.stretches {
            pass.open(stretch, stretch.from_s);
            self.looks(stretch, |from_s, to_s| pass.advance(stretch, from_s, to_s));
        }
        (pass.out, pass.w)
    }
}

/// A walk through one period.
struct Pass<'a> {
    limiter: &'a Limiter<'a>,
    mode: Mode,
    w: f64,
    out: Vec<Stretch>,
}

impl Pass<'_> {
    /// Begins a stretch of the output in the present mode.
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
        // One that ended where it began.
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
            Mode::Follow => self.limiter.wanted(stretch, to_s).0,
            Mode::Ramp(_) => last.offset + last.slope * (to_s - last.from_s),
        };
    }

    /// From `from_s` to `to_s`, so close that each kind of event happens at most once.
    fn advance(&mut self, stretch: &Stretch, mut from_s: f64, to_s: f64) {
        let rate = self.limiter.rate;
        let x = |time_s: f64| self.limiter.wanted(stretch, time_s);
        let mut parted = false;
        while from_s < to_s {
            match self.mode {
                Mode::Follow => {
                    let slope = x(from_s).1;
                    if slope.abs() > rate && !parted {
                        parted = true;
                        self.change(Mode::Ramp(slope.signum()), stretch, from_s);
                    } else if x(to_s).1.abs() <= rate || parted {
                        self.extend(stretch, to_s);
                        from_s = to_s;
                    } else {
                        parted = true;
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
                    // One that parts and meets in no time has followed.
                    let meets_s = if parted { from_s } else { first_change(from_s, to_s, met) };
                    self.extend(stretch, meets_s);
                    let slope = x(meets_s).1;
                    let turns = direction * slope < -rate && !parted;
                    let mode = if turns { Mode::Ramp(-direction) } else { Mode::Follow };
                    parted = true;
                    self.change(mode, stretch, meets_s);
                    from_s = meets_s;
                }
            }
        }
    }
}
