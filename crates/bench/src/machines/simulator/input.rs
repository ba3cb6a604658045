//! A periodic input, and the stretches of time in which a command depends on it linearly.

use std::f64::consts::TAU;

use rustfft::FftPlanner;

use crate::measurement::Complex;
/// Bisection steps that locate an instant to the rounding error of the time.
const HALVINGS: usize = 50;

/// Number of instants per period of the highest input line between which crossings of a level are
/// searched. If the input crosses a level twice between two instants, it is missed; it then exceeds
/// the level by no more than (2π/1024)²/8 = 5e-6 of the amplitude.
const INTERVALS_PER_PERIOD: usize = 1024;

/// A periodic input.
pub(super) struct Input {
    /// U₀, U₁ … of u(t) = Re Σ Uₖ exp(jkωt).
    pub(super) lines: Vec<Complex>,
    /// ω.
    pub(super) omega_rad_s: f64,
}

impl Input {
    /// u(t) at any time.
    pub(super) fn at(&self, time_s: f64) -> f64 {
        self.value_and_rate(time_s).0
    }

    /// u(t) and u'(t).
    pub(super) fn value_and_rate(&self, time_s: f64) -> (f64, f64) {
        let turn = Complex::from_polar(1.0, self.omega_rad_s * time_s);
        let mut phasor = Complex::new(1.0, 0.0);
        let (mut value, mut rate) = (0.0, 0.0);
        for (k, line) in self.lines.iter().enumerate() {
            let turned = line * phasor;
            value += turned.re;
            rate -= k as f64 * self.omega_rad_s * turned.im;
            phasor *= turn;
        }
        (value, rate)
    }

    pub(super) fn period_s(&self) -> f64 {
        TAU / self.omega_rad_s
    }

    /// Length of the intervals in which events are searched, s.
    pub(super) fn search_interval_s(&self) -> f64 {
        self.period_s() / (INTERVALS_PER_PERIOD * self.lines.len().saturating_sub(1).max(1)) as f64
    }

    /// u(t) at `count` instants of the period, by one inverse FFT.
    pub(super) fn sampled(&self, count: usize) -> Vec<f64> {
        let mut values = vec![Complex::new(0.0, 0.0); count];
        values.iter_mut().zip(&self.lines).for_each(|(value, line)| *value = *line);
        FftPlanner::new().plan_fft_inverse(count).process(&mut values);
        values.iter().map(|value| value.re).collect()
    }
}

/// A stretch of time in which the command is offset + gain·u(t) + slope·(t − from).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stretch {
    pub(super) from_s: f64,
    pub(super) to_s: f64,
    pub(super) offset: f64,
    pub(super) gain: f64,
    pub(super) slope: f64,
}

/// The instant at which `changed` becomes true, by bisection; it must be true at `to_s`.
pub(super) fn first_change(from_s: f64, to_s: f64, changed: impl Fn(f64) -> bool) -> f64 {
    let (mut before, mut after) = (from_s, to_s);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (before + after);
        if changed(middle) {
            after = middle;
        } else {
            before = middle;
        }
    }
    after
}
