//! Nonuniform discrete Fourier transform: Σ xₙ exp(−jkωtₙ) over points at arbitrary times, for many
//! k.
//!
//! For a cell of the grid with centre t_c and length h, and s from −1 to 1 over the cell,
//!
//! ```text
//!   exp(−jkω(t_c + sh/2)) = exp(−jkωt_c) Σ_d (2d + 1)(−j)^d j_d(kωh/2) P_d(s)
//! ```
//!
//! (Abramowitz and Stegun 1964, 10.1.47), with the Legendre polynomials P_d and the spherical
//! Bessel functions j_d. So only the Legendre moments of the points in each cell are stored, and
//! one FFT over the cells for each d gives the sums.

use crate::measurement::Complex;
use crate::plant::Scalar;

use crate::simulate::signal::bessel;
use crate::simulate::signal::complex_dual::ComplexDual;
use crate::simulate::signal::grid::Grid;
use crate::simulate::signal::piecewise_quintic::Quintic;

/// Largest truncation error of the series, as a share of the point. Sets the number of degrees d.
const TRUNCATION_ERROR: f64 = 1e-10;

/// Most degrees d; they are enough for arguments of j_d up to 16, 0.2 cells for each harmonic. There
/// are at least six, the moments of a quintic.
const MOST_DEGREES: usize = 40;

/// ∫₀¹ uⁱ P_d(2u − 1) du, one row for each power i; see [`Points::add_whole`].
const LEGENDRE_OF_POWER: [[f64; 6]; 6] = {
    let mut rows = [[0.0; 6]; 6];
    let mut i = 0;
    while i < 6 {
        // i!²/(i!(i + 1)!) = 1/(i + 1), and the ratio of one d to the one before.
        rows[i][0] = 1.0 / (i + 1) as f64;
        let mut d = 1;
        while d <= i {
            rows[i][d] = rows[i][d - 1] * (i + 1 - d) as f64 / (i + d + 1) as f64;
            d += 1;
        }
        i += 1;
    }
    rows
};

/// Points of one signal.
pub(crate) struct Points<S> {
    /// Σ (2d + 1) x P_d(s) over the points of each cell, for d = 0, 1 …; cell after cell.
    moments: Vec<S>,
    /// Number of degrees d of a cell.
    degrees: usize,
}

impl<S: Scalar> Points<S> {
    /// For sums up to k = `highest`; `None` if the cells are too long for them.
    pub fn new(grid: &Grid, highest: usize) -> Option<Self> {
        let most = grid.half_turn(highest);
        let degrees = (6..=MOST_DEGREES)
            .find(|d| bessel::first_term(*d, most) * (2 * d + 1) as f64 <= TRUNCATION_ERROR)?;
        Some(Self { moments: vec![S::constant(0.0); degrees * grid.samples()], degrees })
    }

    /// Adds a point x at the time `at`, as a share of the period.
    #[inline]
    pub fn add(&mut self, at: f64, x: S) {
        let cells = self.moments.len() / self.degrees;
        let place = at * cells as f64;
        let cell = (place as usize).min(cells - 1);
        let s = 2.0 * (place - cell as f64) - 1.0;
        let (mut before, mut here) = (0.0, 1.0);
        let moments = &mut self.moments[cell * self.degrees..][..self.degrees];
        for (d, moment) in moments.iter_mut().enumerate() {
            let d = d as f64;
            *moment += x * ((2.0 * d + 1.0) * here);
            // Legendre's recurrence (Abramowitz and Stegun, 8.5.3).
            (before, here) = (here, ((2.0 * d + 1.0) * s * here - d * before) / (d + 1.0));
        }
    }

    /// Adds a quintic on the whole cell `n`, whose length is `length`. With P_d shifted to [0, 1],
    ///
    /// ```text
    ///   ∫₀¹ uⁱ P_d(2u − 1) du = i!²/((i − d)!(i + d + 1)!)  for d ≤ i, else 0
    /// ```
    ///
    /// (Abramowitz and Stegun, 22.13.8), so that a quintic has six Legendre moments.
    #[inline]
    pub fn add_whole(&mut self, n: usize, powers: &Quintic<S>, length: f64) {
        for (d, moment) in self.moments[n * self.degrees..][..6].iter_mut().enumerate() {
            let mut sum = S::constant(0.0);
            for (power, row) in powers[d..].iter().zip(&LEGENDRE_OF_POWER[d..]) {
                sum += *power * row[d];
            }
            *moment += sum * ((2 * d + 1) as f64 * length);
        }
    }

    /// Adds the sums for k = 0, 1 … to `sums`.
    pub fn add_to(&self, grid: &Grid, sums: &mut [ComplexDual<S>]) {
        let orders = sums.len();
        let weights = grid.bessel(orders, self.degrees);
        let values = self.transformed(grid, &weights, |x| x.value());
        let lanes: Vec<Vec<Complex>> = (0..S::LANES)
            .map(|lane| match self.varies(lane) {
                true => self.transformed(grid, &weights, |x| x.lane(lane)),
                false => vec![Complex::ZERO; orders],
            })
            .collect();
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum = *sum
                + ComplexDual {
                    re: S::with_lanes(values[k].re, |lane| lanes[lane][k].re),
                    im: S::with_lanes(values[k].im, |lane| lanes[lane][k].im),
                };
        }
    }

    fn varies(&self, lane: usize) -> bool {
        self.moments.iter().any(|x| x.lane(lane) != 0.0)
    }

    /// The sums of the numbers that `part` takes from the points. `weights` has j_d for every degree
    /// of the first order k, then of the next.
    fn transformed(&self, grid: &Grid, weights: &[f64], part: impl Fn(&S) -> f64) -> Vec<Complex> {
        let samples = grid.samples();
        let mut sums = vec![Complex::ZERO; weights.len() / self.degrees];
        let mut signal = vec![Complex::ZERO; samples];
        // One complex FFT transforms two real sequences.
        for first in (0..self.degrees).step_by(2) {
            let has_second = first + 1 < self.degrees;
            for (sample, cell) in signal.iter_mut().zip(self.moments.chunks_exact(self.degrees)) {
                let second = if has_second { part(&cell[first + 1]) } else { 0.0 };
                *sample = Complex::new(part(&cell[first]), second);
            }
            grid.forward(&mut signal);
            // (−j)^d for the even degree, and for the next one.
            let sign = if first % 4 == 0 { 1.0 } else { -1.0 };
            let turned = Complex::new(0.0, -sign);
            let orders = sums.iter_mut().zip(weights.chunks_exact(self.degrees)).enumerate();
            for (k, (sum, weights)) in orders {
                let here = signal[k % samples];
                let there = signal[(samples - k % samples) % samples].conj();
                let (even, difference) = (0.5 * (here + there), here - there);
                let odd = 0.5 * Complex::new(difference.im, -difference.re);
                *sum += even * (sign * weights[first]);
                if has_second {
                    *sum += odd * turned * weights[first + 1];
                }
            }
        }
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum *= Complex::from_polar(1.0, -grid.half_turn(k));
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_the_points_one_by_one() {
        sums_are_those_of_the_points(200, 100);
    }

    #[test]
    fn sums_hold_where_a_cell_is_longer_than_a_period_of_the_harmonic() {
        sums_are_those_of_the_points(24, 120);
    }

    fn sums_are_those_of_the_points(cells: usize, highest: usize) {
        let grid = Grid::at_least(cells);
        let points: Vec<(f64, f64)> =
            (0..500).map(|n| ((f64::from(n) * 0.618_034).fract(), f64::from(n).cos())).collect();
        let mut all = Points::new(grid, highest).unwrap();
        points.iter().for_each(|(at, x)| all.add(*at, *x));
        let mut sums = vec![ComplexDual::real(0.0); highest + 1];
        all.add_to(grid, &mut sums);
        for (k, sum) in sums.iter().enumerate() {
            let turn = |at: f64| Complex::from_polar(1.0, -std::f64::consts::TAU * k as f64 * at);
            let expected: Complex = points.iter().map(|(at, x)| turn(*at) * *x).sum();
            // 500 points, each with the truncation error.
            assert!(
                (sum.value() - expected).norm() < 500.0 * TRUNCATION_ERROR,
                "{k}: {sum:?} {expected}"
            );
        }
    }

    #[test]
    fn a_quintic_on_a_whole_cell_is_the_sum_over_its_quadrature_points() {
        let (grid, highest) = (Grid::at_least(48), 30);
        let powers = [0.3, -1.2, 0.7, 2.1, -0.4, 0.9];
        let mut whole = Points::new(grid, highest).unwrap();
        whole.add_whole(5, &powers, 0.2);
        let mut nodes = Points::new(grid, highest).unwrap();
        // The midpoint rule errs by 1/24 of the squared step times the second derivative.
        for n in 0..4000 {
            let u = (f64::from(n) + 0.5) / 4000.0;
            let value: f64 = powers.iter().rev().fold(0.0, |sum, c| sum * u + c);
            nodes.add((5.0 + u) / grid.samples() as f64, value * 0.2 / 4000.0);
        }
        let sums = [whole, nodes].map(|points| {
            let mut sums = vec![ComplexDual::real(0.0); highest + 1];
            points.add_to(grid, &mut sums);
            sums
        });
        for (whole, nodes) in sums[0].iter().zip(&sums[1]) {
            assert!((whole.value() - nodes.value()).norm() < 1e-7, "{whole:?} {nodes:?}");
        }
    }

    #[test]
    fn cells_that_are_too_long_are_refused() {
        assert!(Points::<f64>::new(Grid::at_least(24), 120).is_some());
        assert!(Points::<f64>::new(Grid::at_least(24), 130).is_none());
    }
}
