//! A uniform grid over one period, with FFTs and tables.

use std::sync::{Arc, OnceLock};

use rustfft::{Fft, FftPlanner};

use crate::measurement::Complex;

/// Fewest samples per cycle of the highest line; see `samples` for the interpolation error.
const SAMPLES_PER_HIGHEST_CYCLE: usize = 12;

/// Fewest samples per period of a general input.
const FEWEST_SAMPLES: usize = 1024;

/// A uniform grid of N samples over one period, with its FFTs.
#[derive(Clone)]
pub(crate) struct Grid {
    inverse: Arc<dyn Fft<f64>>,
    forward: Arc<dyn Fft<f64>>,
    tables: Arc<Tables>,
}

/// Tables that do not depend on the signal.
struct Tables {
    /// exp(2πj·n/N), n = 0 … N.
    turns: Vec<Complex>,
    /// ∫₀¹ uⁱ exp(−jθu) du at θ = 2πk/N, i = 0 … 5, for the lowest harmonics k.
    moments: Vec<[Complex; 6]>,
}

/// Number of fixed grid sizes, the ladder: 8, 12, 16, 24 … samples.
const LADDER: usize = 28;

/// Number of samples of a grid of the ladder.
const fn rung(step: usize) -> usize {
    if step.is_multiple_of(2) { 8 << (step / 2) } else { 12 << (step / 2) }
}

impl Grid {
    /// A grid for a signal with lines up to this one.
    pub fn new(highest_line: usize) -> Self {
        let samples = (SAMPLES_PER_HIGHEST_CYCLE * highest_line).max(FEWEST_SAMPLES);
        Self::of(next_quick_length(samples))
    }

    fn of(samples: usize) -> Self {
        let mut planner = FftPlanner::new();
        let step = std::f64::consts::TAU / samples as f64;
        let tables = Tables {
            turns: (0..=samples)
                .map(|n| Complex::from_polar(1.0, step * (n % samples) as f64))
                .collect(),
            moments: (0..=samples / 3).map(|k| moments(step * k as f64)).collect(),
        };
        Self {
            inverse: planner.plan_fft_inverse(samples),
            forward: planner.plan_fft_forward(samples),
            tables: Arc::new(tables),
        }
    }

    /// The smallest grid of the ladder with at least this many samples, or the largest one. Each is
    /// created once and shared.
    pub fn at_least(samples: usize) -> &'static Self {
        static GRIDS: [OnceLock<Grid>; LADDER] = [const { OnceLock::new() }; LADDER];
        let step = (0..LADDER).find(|step| rung(*step) >= samples).unwrap_or(LADDER - 1);
        GRIDS[step].get_or_init(|| Self::of(rung(step)))
    }

    /// exp(2πj·n/N).
    pub fn turn(&self, n: usize) -> Complex {
        self.tables.turns[n]
    }

    /// ∫₀¹ uⁱ exp(−jθu) du at θ = 2πk/N, i = 0 … 5.
    pub fn moments(&self, k: usize) -> [Complex; 6] {
        let theta = std::f64::consts::TAU * k as f64 / self.samples() as f64;
        self.tables.moments.get(k).copied().unwrap_or_else(|| moments(theta))
    }

    /// Number N of samples per period.
    pub fn samples(&self) -> usize {
        self.forward.len()
    }

    /// Inverse FFT from lines to samples, in place, unscaled.
    pub fn inverse(&self, signal: &mut [Complex]) {
        self.inverse.process(signal);
    }

    /// FFT from samples x to Σ x exp(−jkωt), in place, unscaled.
    pub fn forward(&self, signal: &mut [Complex]) {
        self.forward.process(signal);
    }
}

/// The next length without prime factors above 5, for which FFTs are fast.
fn next_quick_length(at_least: usize) -> usize {
    let left_over = |mut n: usize| {
        for factor in [2, 3, 5] {
            while n.is_multiple_of(factor) {
                n /= factor;
            }
        }
        n
    };
    (at_least..).find(|n| left_over(*n) == 1).expect("a power of two comes sooner or later")
}

/// ∫₀¹ uⁱ exp(−jθu) du, i = 0 … 5.
fn moments(theta: f64) -> [Complex; 6] {
    let j_theta = Complex::new(0.0, theta);
    if theta < 0.8 {
        // Power series: the first term left out is below 0.8¹⁸/18! = 3e-18.
        let mut sums = [Complex::new(0.0, 0.0); 6];
        let mut power = Complex::new(1.0, 0.0);
        for m in 0..18 {
            for (i, sum) in sums.iter_mut().enumerate() {
                *sum += power / (i + m + 1) as f64;
            }
            power *= -j_theta / (m + 1) as f64;
        }
        return sums;
    }
    let turn = Complex::from_polar(1.0, -theta);
    let mut moment = (1.0 - turn) / j_theta;
    std::array::from_fn(|i| {
        if i > 0 {
            moment = (i as f64 * moment - turn) / j_theta;
        }
        moment
    })
}
