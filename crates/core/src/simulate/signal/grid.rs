//! A uniform grid over one period, with FFTs and tables.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use rustfft::{Fft, FftPlanner};

use super::bessel;
use crate::measurement::Complex;

/// Largest interpolation error of a general input, as a share of its rms without the mean: what
/// [`MOST_SAMPLES_PER_CYCLE`] leaves of a flat spectrum.
const INTERPOLATION_ERROR: f64 = 1.25e-7;

/// Samples per cycle of the highest line with which any input is interpolated well enough:
/// (2π/12)⁶/46080 = 4.5e-7.
const MOST_SAMPLES_PER_CYCLE: usize = 12;

/// Fewest samples per period of a general input.
const FEWEST_SAMPLES: usize = 1024;

/// The same of a coarser grid.
const FEWEST_COARSE_SAMPLES: usize = 128;

/// A coarser grid has at most this share of the samples; one that saves less is not worth the
/// correction of its error.
const LARGEST_COARSE_SHARE: f64 = 0.5;

/// A uniform grid of N samples over one period, with its FFTs.
#[derive(Clone)]
pub(crate) struct Grid {
    inverse: Arc<dyn Fft<f64>>,
    forward: Arc<dyn Fft<f64>>,
    tables: Arc<Tables>,
}

type BesselTables = BTreeMap<(usize, usize), Arc<[f64]>>;

/// Tables that do not depend on the signal.
struct Tables {
    /// exp(2πj·n/N), n = 0 … N.
    turns: Vec<Complex>,
    /// ∫₀¹ uⁱ exp(−jθu) du at θ = 2πk/N, i = 0 … 5, for the lowest harmonics k.
    moments: Vec<[Complex; 6]>,
    /// Tables of [`Grid::bessel`], by their numbers of orders and degrees.
    bessel: Mutex<BesselTables>,
}

/// Number of fixed grid sizes, the ladder: 8, 12, 16, 24 … samples.
const LADDER: usize = 28;

/// Number of samples of a grid of the ladder.
const fn rung(step: usize) -> usize {
    if step.is_multiple_of(2) { 8 << (step / 2) } else { 12 << (step / 2) }
}

impl Grid {
    /// The coarsest grid on which quintics interpolate a signal with these lines. It depends on
    /// their sizes: noise far above the excited band needs few samples per cycle.
    pub fn for_lines(lines: &[Complex]) -> Self {
        Self::of(fewest_samples(lines, INTERPOLATION_ERROR, FEWEST_SAMPLES))
    }

    /// A coarser grid for the same lines, of at least `fewest` samples, that interpolates them to
    /// this error, relative to their rms without the mean. `None` if it would be hardly coarser
    /// than this one.
    pub fn coarser(&self, lines: &[Complex], error: f64, fewest: usize) -> Option<Self> {
        let samples = fewest_samples(lines, error, fewest.max(FEWEST_COARSE_SAMPLES));
        let most = LARGEST_COARSE_SHARE * self.samples() as f64;
        (samples as f64 <= most).then(|| Self::of(samples))
    }

    fn of(samples: usize) -> Self {
        let mut planner = FftPlanner::new();
        let step = std::f64::consts::TAU / samples as f64;
        let tables = Tables {
            turns: (0..=samples)
                .map(|n| Complex::from_polar(1.0, step * (n % samples) as f64))
                .collect(),
            moments: (0..=samples / 3).map(|k| moments(step * k as f64)).collect(),
            bessel: Mutex::default(),
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

    /// kωh/2, half the angle of harmonic k over a cell, radians.
    pub fn half_turn(&self, k: usize) -> f64 {
        std::f64::consts::PI * k as f64 / self.samples() as f64
    }

    /// Spherical Bessel functions j_d(kωh/2) of the degrees d below `degrees`, for k = 0, then for
    /// the next k, up to `orders` of them. Each table is computed once.
    pub fn bessel(&self, orders: usize, degrees: usize) -> Arc<[f64]> {
        let mut tables = self.tables.bessel.lock().unwrap_or_else(PoisonError::into_inner);
        let of_order = |k| (0..degrees).map(move |d| bessel::spherical(d, self.half_turn(k)));
        let table = || (0..orders).flat_map(of_order).collect();
        Arc::clone(tables.entry((orders, degrees)).or_insert_with(table))
    }

    /// Number N of samples per period.
    pub fn samples(&self) -> usize {
        self.forward.len()
    }

    /// Number of lines, 0 included, that the samples can hold: those below half their number.
    pub fn lines(&self) -> usize {
        self.samples().div_ceil(2)
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

/// The least number of samples, `fewest` or more, on which quintics interpolate a signal with these
/// lines to this error, relative to its rms without the mean.
fn fewest_samples(lines: &[Complex], error: f64, fewest: usize) -> usize {
    let most = MOST_SAMPLES_PER_CYCLE * lines.len().saturating_sub(1);
    let power = |line: &Complex| line.norm_sqr();
    let allowed = error.powi(2) * lines.iter().skip(1).map(power).sum::<f64>();
    let mut samples = next_quick_length(fewest);
    while samples < most && interpolation_error(lines, samples) > allowed {
        samples = next_quick_length(samples + samples / 32);
    }
    samples
}

/// Sum of the squared errors of the lines on a grid of so many samples; see `samples` for the
/// error of one line. Lines from half the number of samples on are lost altogether.
fn interpolation_error(lines: &[Complex], samples: usize) -> f64 {
    let step = std::f64::consts::TAU / samples as f64;
    let error = |(l, line): (usize, &Complex)| {
        let relative = if 2 * l >= samples { 1.0 } else { (step * l as f64).powi(6) / 46080.0 };
        relative * relative * line.norm_sqr()
    };
    lines.iter().enumerate().skip(1).map(error).sum()
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of size 1 up to `excited`, and of size `noise` from there up to `all`.
    fn lines(excited: usize, noise: f64, all: usize) -> Vec<Complex> {
        let size = |l: usize| {
            if l == 0 {
                0.0
            } else if l <= excited {
                1.0
            } else {
                noise
            }
        };
        (0..=all).map(|l| Complex::from_polar(size(l), (l * l) as f64)).collect()
    }

    #[test]
    fn lines_that_carry_nothing_do_not_refine_the_grid() {
        let excited = Grid::for_lines(&lines(200, 0.0, 200));
        let recorded = Grid::for_lines(&lines(200, 1e-12, 5000));
        // Lengths that are quick to transform are a few per cent apart.
        assert!(recorded.samples() < excited.samples() * 11 / 10, "{}", recorded.samples());
        let even = Grid::for_lines(&lines(5000, 1.0, 5000));
        assert!(even.samples() > 20 * recorded.samples(), "{}", even.samples());
    }

    #[test]
    fn a_coarser_grid_has_at_most_half_the_samples_and_the_error_that_was_asked_for() {
        for (all, noise) in [(200, 0.0), (2000, 1e-8)] {
            let lines = lines(200, noise, all);
            let fine = Grid::for_lines(&lines);
            let coarse = fine.coarser(&lines, 1e-5, 0).unwrap();
            assert!(2 * coarse.samples() <= fine.samples());
            let power: f64 = lines.iter().map(Complex::norm_sqr).sum();
            let error = (interpolation_error(&lines, coarse.samples()) / power).sqrt();
            assert!((1e-6..=1e-5).contains(&error), "{error}");
        }
        let few = lines(2, 0.0, 2);
        let coarser = |fewest| Grid::for_lines(&few).coarser(&few, 1e-5, fewest);
        assert_eq!(coarser(0).unwrap().samples(), 128);
        assert_eq!(coarser(300).unwrap().samples(), 300);
        let noisy = lines(100, 1.0, 1000);
        let fine = Grid::of(Grid::for_lines(&noisy).samples() / 2);
        assert!(fine.coarser(&noisy, 1e-5, 0).is_none());
    }

    #[test]
    fn the_interpolation_errs_by_less_than_a_millionth_of_the_input() {
        for noise in [0.0, 1e-4, 1e-2, 1.0] {
            let lines = lines(100, noise, 1000);
            let grid = Grid::for_lines(&lines);
            let (signal, _) = super::super::samples::Samples::of(&grid, 1.0, &lines, &[]);
            let (mut error, mut power) = (0.0, 0.0);
            for cell in (0..grid.samples()).step_by(grid.samples() / 300) {
                // The interpolation errs most in the middle of a cell.
                let time_s = (cell as f64 + 0.5) * signal.step_s;
                let at = |(l, line): (usize, &Complex)| {
                    (line * Complex::from_polar(1.0, l as f64 * time_s)).re
                };
                let exact: f64 = lines.iter().enumerate().map(at).sum();
                error += (signal.at(cell, time_s) - exact).powi(2);
                power += exact * exact;
            }
            let relative = (error / power).sqrt();
            // The leading term of the error, on which the grid is chosen, is its largest value over
            // a cell; the terms after it add at most as much at two samples a cycle.
            assert!(relative < 2.5e-7, "{noise}: {relative}");
        }
    }
}
