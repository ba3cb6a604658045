//! Samples a motion at the times of the input's samples, as the sensor reports it.
//!
//! A sensor with one lag of time constant T reports y with y' = (v − y)/T. So its acceleration is
//! (v − y)/T, and its position, the integral of y, is θ − T·(y − y₀).

use super::motion::{InitialState, SampledInput, Trajectory};
use crate::simulate::signal::exponential_integrator::ExponentialIntegrator;
use crate::simulate::signal::piecewise_quintic::{polynomial, restricted, slope, through};

/// A sample's time may lie beyond the end of a piece by this share of a sampling step, by rounding.
const TIME_ROUNDING: f64 = 1e-9;

/// A piece of a degree above 5 is divided into this many parts, each replaced by a quintic, for the
/// lags.
const HIGH_DEGREE_PARTS: usize = 4;

/// Samples a motion while it is integrated, piece by piece.
pub(in super::super) struct Recorder {
    step_s: f64,
    count: usize,
    trajectory: Trajectory,
    /// θ at the end of the last piece.
    position: f64,
    lags: Vec<Lag>,
}

/// A lag of the sensor: T, and its output at the beginning and at the end of the last piece.
#[derive(Debug, Clone, Copy)]
struct Lag {
    time_constant_s: f64,
    first: f64,
    value: f64,
}

impl Recorder {
    pub(super) fn new(input: &SampledInput<'_>, lags: &[f64], initial: &InitialState) -> Self {
        let first = initial.velocity;
        let lag = |time_constant_s: f64| Lag { time_constant_s, first, value: first };
        Self {
            step_s: input.step_s,
            count: input.values.len(),
            trajectory: Trajectory::default(),
            position: initial.position,
            lags: lags.iter().copied().filter(|t| *t > 0.0).map(lag).collect(),
        }
    }

    /// Adds the next piece of the velocity, a polynomial in u, from u = 0 to `reach`; u = 1 is
    /// `length_s` after u = 0.
    pub(in super::super) fn add(&mut self, from_s: f64, length_s: f64, powers: &[f64], reach: f64) {
        if reach <= 0.0 || length_s <= 0.0 {
            return;
        }
        while self.trajectory.velocity.len() < self.count {
            let time_s = self.trajectory.velocity.len() as f64 * self.step_s;
            let u = (time_s - from_s) / length_s;
            if u > reach + TIME_ROUNDING * self.step_s / length_s {
                break;
            }
            self.read(length_s, powers, u.clamp(0.0, reach));
        }
        self.position += length_s * integral(powers, reach);
        let mut lags = std::mem::take(&mut self.lags);
        advance(&mut lags, length_s, powers, reach);
        self.lags = lags;
    }

    /// Records what the sensor reports at u.
    fn read(&mut self, length_s: f64, powers: &[f64], u: f64) {
        let mut velocity = polynomial(powers, u);
        let mut position = self.position + length_s * integral(powers, u);
        let mut acceleration = derivative(powers, u) / length_s;
        if !self.lags.is_empty() {
            let mut lags = self.lags.clone();
            advance(&mut lags, length_s, powers, u);
            for Lag { time_constant_s, first, value } in lags {
                acceleration = (velocity - value) / time_constant_s;
                position -= time_constant_s * (value - first);
                velocity = value;
            }
        }
        self.trajectory.velocity.push(velocity);
        self.trajectory.position.push(position);
        self.trajectory.acceleration.push(acceleration);
    }

    /// The complete trajectory. Samples after the last piece repeat the values at its end.
    pub(super) fn finish(mut self) -> Trajectory {
        let rest = |values: &mut Vec<f64>, count: usize, first: f64| {
            let last = values.last().copied().unwrap_or(first);
            values.resize(count, last);
        };
        let first = self.lags.first().map_or(0.0, |lag| lag.first);
        rest(&mut self.trajectory.velocity, self.count, first);
        rest(&mut self.trajectory.position, self.count, self.position);
        rest(&mut self.trajectory.acceleration, self.count, 0.0);
        self.trajectory
    }
}

/// Integrates the lags, which are in series, over a piece.
fn advance(lags: &mut [Lag], length_s: f64, powers: &[f64], reach: f64) {
    if lags.is_empty() || reach <= 0.0 {
        return;
    }
    let parts = if powers.len() > 6 { HIGH_DEGREE_PARTS } else { 1 };
    for part in 0..parts {
        let bounds = [part, part + 1].map(|i| reach * i as f64 / parts as f64);
        let length_s = length_s * (bounds[1] - bounds[0]);
        let mut signal = quintic(powers, bounds);
        for lag in lags.iter_mut() {
            let Lag { time_constant_s: t, value: start, .. } = *lag;
            let share = length_s / t;
            let driven = signal.map(|power| power / t);
            lag.value = ExponentialIntegrator::new(share).step(start, &driven, length_s);
            let node = |y: f64, v: f64, rate: f64| {
                let first = share * (v - y);
                [y, first, share * (rate - first)]
            };
            let left = node(start, signal[0], signal[1]);
            let right = node(lag.value, polynomial(&signal, 1.0), slope(&signal, 1.0));
            signal = through(left, right);
        }
    }
}

/// The part of a piece between two positions as a quintic in u, 0 to 1.
fn quintic(powers: &[f64], [from, to]: [f64; 2]) -> [f64; 6] {
    if powers.len() <= 6 {
        let mut quintic = [0.0; 6];
        quintic[..powers.len()].copy_from_slice(powers);
        return if (from, to) == (0.0, 1.0) { quintic } else { restricted(&quintic, from, to) };
    }
    let width = to - from;
    let second: Vec<f64> = derived(&derived(powers));
    let node = |u: f64| {
        let first = derivative(powers, u) * width;
        [polynomial(powers, u), first, polynomial(&second, u) * width * width]
    };
    through(node(from), node(to))
}

/// Coefficients of the derivative of a polynomial.
fn derived(powers: &[f64]) -> Vec<f64> {
    powers.iter().enumerate().skip(1).map(|(i, power)| i as f64 * power).collect()
}

/// ∫₀ᵘ of a polynomial.
fn integral(powers: &[f64], u: f64) -> f64 {
    let terms = powers.iter().enumerate().rev();
    terms.fold(0.0, |sum, (i, power)| sum * u + power / (i + 1) as f64) * u
}

/// The derivative of a polynomial at u.
fn derivative(powers: &[f64], u: f64) -> f64 {
    let terms = powers.iter().enumerate().skip(1).rev();
    terms.fold(0.0, |sum, (i, power)| sum * u + i as f64 * power)
}
