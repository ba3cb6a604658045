//! A periodic signal on a uniform grid, interpolated by quintics.
//!
//! FFTs compute the value and two derivatives at every sample from the signal's lines. Between
//! samples the quintic through these at both ends approximates the signal. For a line with n
//! samples per cycle its error is (2π/n)⁶/46080 of that line.

use crate::measurement::Complex;

use super::grid::Grid;

/// A sampled periodic signal.
pub(crate) struct Samples {
    /// Distance between samples, seconds.
    pub step_s: f64,
    /// Values; the first sample is repeated at the end.
    pub value: Vec<f64>,
    /// First derivatives, per second.
    pub first: Vec<f64>,
    /// Second derivatives, per second squared.
    pub second: Vec<f64>,
}

impl Samples {
    /// Samples of Re Σ Xₗ exp(jlωt) and, by the same FFTs, the values of a second signal with the
    /// lines `other`. Lines that the grid cannot hold are left out.
    pub fn of(grid: &Grid, omega: f64, lines: &[Complex], other: &[Complex]) -> (Self, Vec<f64>) {
        let zero = Complex::new(0.0, 0.0);
        let j = Complex::new(0.0, 1.0);
        let samples = grid.samples();
        // One complex FFT transforms two real signals.
        let mut values = vec![zero; samples];
        let mut derivatives = vec![zero; samples];
        for (l, line) in lines.iter().enumerate().take(grid.lines()) {
            let other = other.get(l).copied().unwrap_or_default();
            if l == 0 {
                values[0] = Complex::new(line.re, other.re);
                continue;
            }
            let s = Complex::new(0.0, l as f64 * omega);
            let (line, other) = (0.5 * line, 0.5 * other);
            values[l] = line + j * other;
            values[samples - l] = line.conj() + j * other.conj();
            let (first, second) = (s * line, s * s * line);
            derivatives[l] = first + j * second;
            derivatives[samples - l] = first.conj() + j * second.conj();
        }
        grid.inverse(&mut values);
        grid.inverse(&mut derivatives);
        let wrapped = |signal: &[Complex], part: fn(&Complex) -> f64| -> Vec<f64> {
            signal.iter().chain(signal.first()).map(part).collect()
        };
        let these = Self {
            step_s: std::f64::consts::TAU / omega / samples as f64,
            value: wrapped(&values, |z| z.re),
            first: wrapped(&derivatives, |z| z.re),
            second: wrapped(&derivatives, |z| z.im),
        };
        (these, wrapped(&values, |z| z.im))
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.value.len() - 1
    }

    /// The cell that contains a time of the period.
    pub fn cell_of(&self, time_s: f64) -> usize {
        ((time_s / self.step_s) as usize).min(self.cells() - 1)
    }

    /// The signal at a time in the cell.
    pub fn at(&self, cell: usize, time_s: f64) -> f64 {
        if time_s <= cell as f64 * self.step_s {
            return self.value[cell]; // usually only the start of a cell is needed
        }
        self.quintic(cell).value(time_s / self.step_s - cell as f64)
    }

    /// The derivative there, per second.
    pub fn slope_at(&self, cell: usize, time_s: f64) -> f64 {
        self.quintic(cell).slope(time_s / self.step_s - cell as f64) / self.step_s
    }

    fn quintic(&self, cell: usize) -> Quintic {
        let h = self.step_s;
        let end = |n: usize| [self.value[n], h * self.first[n], h * h * self.second[n]];
        Quintic::through(end(cell), end(cell + 1))
    }

    /// ∫ x(t) exp(−jkωt) dt, k = 0 … `highest`, over the given spans of time.
    ///
    /// Whole cells are integrated by Filon's method (1928): the product of quintic and exponential
    /// exactly, and an FFT sums over all cells. Parts of cells at the ends of a span are integrated
    /// by Gauss–Legendre quadrature.
    pub fn integrals(
        &self,
        grid: &Grid,
        omega: f64,
        spans: impl Iterator<Item = (f64, f64)>,
        highest: usize,
    ) -> Vec<Complex> {
        let zero = Complex::new(0.0, 0.0);
        let period_s = std::f64::consts::TAU / omega;
        let mut sums = vec![zero; highest + 1];
        // Samples at the left ends of whole cells. The right ends are the same samples, except for
        // the first and the last one of every span.
        let mut left = [vec![zero; grid.samples()], vec![zero; grid.samples()]];
        let mut ends: Vec<(usize, f64)> = Vec::new();
        for (start, end) in spans.flat_map(|span| within_period(span, period_s)) {
            let (first, last) = (self.cell_of(start), self.cell_of(end));
            if first == last {
                self.add_part(first, start, end, omega, &mut sums);
                continue;
            }
            self.add_part(first, start, (first + 1) as f64 * self.step_s, omega, &mut sums);
            self.add_part(last, last as f64 * self.step_s, end, omega, &mut sums);
            let [values, curvatures] = &mut left;
            let whole = first + 1..last;
            for ((n, value), curvature) in
                whole.clone().zip(&mut values[whole.clone()]).zip(&mut curvatures[whole])
            {
                *value = Complex::new(self.value[n], self.first[n]);
                *curvature = Complex::new(self.second[n], 0.0);
            }
            if last > first + 1 {
                ends.extend([(first + 1, -1.0), (last, 1.0)]);
            }
        }
        if ends.is_empty() {
            return sums;
        }
        left.iter_mut().for_each(|signal| grid.forward(signal));
        let samples = grid.samples();
        // What the samples at the right ends have more than those at the left ends.
        let mut more = vec![[zero; 3]; highest + 1];
        for (sample, sign) in ends {
            let these = [self.value[sample], self.first[sample], self.second[sample]];
            let (step, mut at) = (sample % samples, 0);
            for sums in &mut more {
                let turn = sign * grid.turn(at).conj();
                sums.iter_mut().zip(these).for_each(|(sum, value)| *sum += turn * value);
                at += step;
                at -= if at >= samples { samples } else { 0 };
            }
        }
        for (k, (sum, more)) in sums.iter_mut().zip(more).enumerate() {
            let (n, mirrored) = (k % samples, (samples - k % samples) % samples);
            let (value, first) = unpack(left[0][n], left[0][mirrored]);
            let (second, _) = unpack(left[1][n], left[1][mirrored]);
            let at_left = [value, first, second];
            let at_right: [Complex; 3] = std::array::from_fn(|i| at_left[i] + more[i]);
            let theta = k as f64 * omega * self.step_s;
            let weights = hermite_weights(&grid.moments(k));
            // The cell of a right end begins one step earlier.
            let back = Complex::from_polar(1.0, theta);
            let h = self.step_s;
            for (i, scale) in [h, h * h, h * h * h].into_iter().enumerate() {
                *sum += scale * (weights[i] * at_left[i] + back * weights[i + 3] * at_right[i]);
            }
        }
        sums
    }

    /// Adds the integrals over a part of a cell.
    fn add_part(&self, cell: usize, from_s: f64, to_s: f64, omega: f64, sums: &mut [Complex]) {
        let quintic = self.quintic(cell);
        let (middle, half) = (0.5 * (from_s + to_s), 0.5 * (to_s - from_s));
        let times = GAUSS_5.map(|(node, _)| middle + half * node);
        let turns = times.map(|time_s| Complex::from_polar(1.0, -omega * time_s));
        // All nodes together: each power waits for the one before, but not for those of the others.
        let mut at: [Complex; 5] = std::array::from_fn(|i| {
            let value = quintic.value(times[i] / self.step_s - cell as f64);
            Complex::new(half * GAUSS_5[i].1 * value, 0.0)
        });
        for sum in sums {
            *sum += at.iter().sum::<Complex>();
            at.iter_mut().zip(&turns).for_each(|(at, turn)| *at *= turn);
        }
    }
}

/// Nodes and weights of Gauss–Legendre quadrature with 5 points.
pub(crate) const GAUSS_5: [(f64, f64); 5] = [
    (0.0, 128.0 / 225.0),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// A span of time as one or two spans within [0, period].
pub(crate) fn within_period(
    (start, end): (f64, f64),
    period_s: f64,
) -> impl Iterator<Item = (f64, f64)> {
    let (first, rest) = if end > period_s {
        ((start, period_s), Some((0.0, end - period_s)))
    } else {
        ((start, end), None)
    };
    std::iter::once(first).chain(rest)
}

/// The transforms of two real signals x and y from that of x + j·y at n and at −n.
fn unpack(here: Complex, mirrored: Complex) -> (Complex, Complex) {
    let mirrored = mirrored.conj();
    let difference = here - mirrored;
    (0.5 * (here + mirrored), 0.5 * Complex::new(difference.im, -difference.re))
}

/// The quintic on [0, 1] through value, slope and curvature at both ends.
struct Quintic([f64; 6]);

/// Coefficients of the quintics whose values, slopes and curvatures at both ends are 0 but for one.
const HERMITE: [Quintic; 6] = [
    Quintic::through([1.0, 0.0, 0.0], [0.0; 3]),
    Quintic::through([0.0, 1.0, 0.0], [0.0; 3]),
    Quintic::through([0.0, 0.0, 1.0], [0.0; 3]),
    Quintic::through([0.0; 3], [1.0, 0.0, 0.0]),
    Quintic::through([0.0; 3], [0.0, 1.0, 0.0]),
    Quintic::through([0.0; 3], [0.0, 0.0, 1.0]),
];

impl Quintic {
    const fn through(left: [f64; 3], right: [f64; 3]) -> Self {
        let [y, d, e] = left;
        // Differences at the right end from the parabola through the left end.
        let value = right[0] - (y + d + 0.5 * e);
        let slope = right[1] - (d + e);
        let curvature = right[2] - e;
        Self([
            y,
            d,
            0.5 * e,
            10.0 * value - 4.0 * slope + 0.5 * curvature,
            -15.0 * value + 7.0 * slope - curvature,
            6.0 * value - 3.0 * slope + 0.5 * curvature,
        ])
    }

    fn value(&self, u: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * u + c)
    }

    fn slope(&self, u: f64) -> f64 {
        (1..6).rev().fold(0.0, |sum, i| sum * u + i as f64 * self.0[i])
    }
}

/// The quintic through value, slope and curvature at both ends, at u.
pub(crate) fn quintic_at(left: [f64; 3], right: [f64; 3], u: f64) -> f64 {
    Quintic::through(left, right).value(u)
}

/// ∫₀¹ H(u) exp(−jθu) du for the six Hermite basis quintics H, from the same integrals of the
/// powers of u.
fn hermite_weights(moments: &[Complex; 6]) -> [Complex; 6] {
    std::array::from_fn(|basis| {
        HERMITE[basis].0.iter().zip(moments).map(|(c, moment)| moment * *c).sum()
    })
}
