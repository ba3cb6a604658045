//! Fourier integrals ∫ x(t) exp(−jkωt) dt of a signal that is given piece by piece.
//!
//! For few harmonics, pieces that are whole cells of the grid are integrated by Filon's method
//! (1928): the product of polynomial and exponential is integrated exactly, and an FFT sums over
//! all cells. Other pieces are integrated by Gauss–Legendre quadrature, node by node. For many
//! harmonics both kinds of pieces are summed together (`points`).

mod points;

use crate::measurement::Complex;
use crate::plant::Scalar;

use super::complex_dual::ComplexDual;
use super::grid::Grid;
use super::piecewise_quintic::{Cell, Quintic, polynomial, restricted};
use super::samples::GAUSS_5;
use points::Points;

/// Largest angle θ of the highest harmonic over a part for which three, or four, nodes err by less
/// than 1e-8 of the part (θ⁶/2e6, θ⁸/2e9).
const LARGEST_ANGLES: [f64; 2] = [0.5, 1.3];

/// Nodes and weights of Gauss–Legendre quadrature with 3 points.
const GAUSS_3: [(f64, f64); 3] =
    [(0.0, 8.0 / 9.0), (-0.774_596_669_241_483_4, 5.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// The same with 4 points.
const GAUSS_4: [(f64, f64); 4] = [
    (-0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
];

/// From this harmonic on, summing the nodes of all pieces together is faster. Tuned.
const MANY_HARMONICS: usize = 48;

/// The Fourier integrals of one signal.
pub(crate) struct Fourier<'g, S> {
    grid: &'g Grid,
    omega: f64,
    /// Coefficients of the signal in each whole cell, 0 where none was added; empty before the
    /// first, and with `points`.
    whole: Vec<Quintic<S>>,
    /// All pieces, if there are many harmonics; `None` if nodes of pieces are summed one by one.
    points: Option<Points<S>>,
    sums: Vec<ComplexDual<S>>,
}

impl<'g, S: Scalar> Fourier<'g, S> {
    /// For harmonics 0 … `highest`.
    pub fn new(grid: &'g Grid, omega: f64, highest: usize) -> Self {
        let zero = ComplexDual::real(S::constant(0.0));
        let points = if highest < MANY_HARMONICS { None } else { Points::new(grid, highest) };
        Self { grid, omega, whole: Vec::new(), points, sums: vec![zero; highest + 1] }
    }

    /// Adds a signal on the whole cell `n` of the grid.
    pub fn add_whole(&mut self, n: usize, powers: Quintic<S>) {
        if let Some(points) = &mut self.points {
            points.add_whole(
                n,
                &powers,
                std::f64::consts::TAU / self.omega / self.grid.samples() as f64,
            );
            return;
        }
        if self.whole.is_empty() {
            self.whole.resize(self.grid.samples(), [S::constant(0.0); 6]);
        }
        self.whole[n] = powers;
    }

    /// Adds the signal on a part of a cell, from position `from` to `to`.
    ///
    /// The ends may have derivatives. By Leibniz's rule, each adds the signal there times the
    /// derivative of its time.
    pub fn add_part(&mut self, cell: &Cell<S>, from: S, to: S) {
        let ends = [from, to].map(S::value);
        let powers = restricted(&cell.powers, ends[0], ends[1]);
        let [from_s, to_s] = ends.map(|u| cell.from_s + u * cell.length_s);
        self.add_fixed(from_s, to_s - from_s, 1.0, &powers);
        for (end, at_s, sign) in [(from, from_s, -1.0), (to, to_s, 1.0)] {
            if (0..S::LANES).any(|lane| end.lane(lane) != 0.0) {
                let shift = (end - end.value()) * (sign * cell.length_s);
                self.add_point(at_s, shift * cell.number(end.value()));
            }
        }
    }

    /// Adds a signal between fixed times, as a polynomial in u of any degree. It begins at
    /// `from_s` with u = 0 and ends at u = `reach`; u = 1 is `length_s` later than u = 0.
    #[inline]
    pub fn add_fixed(&mut self, from_s: f64, length_s: f64, reach: f64, powers: &[S]) {
        let nodes = if powers.len() > 6 { &GAUSS_5[..] } else { self.nodes(reach * length_s) };
        for (node, weight) in nodes {
            let u = reach * (0.5 + 0.5 * node);
            let x = polynomial(powers, u) * (0.5 * weight * reach * length_s);
            self.add_point(from_s + length_s * u, x);
        }
    }

    /// Adds x·exp(−jkωt) at one time.
    #[inline]
    fn add_point(&mut self, at_s: f64, x: S) {
        let angle = self.omega * at_s;
        if let Some(points) = &mut self.points {
            points.add(angle / std::f64::consts::TAU, x);
            return;
        }
        let turn = Complex::from_polar(1.0, -angle);
        let mut at = Complex::new(1.0, 0.0);
        for sum in &mut self.sums {
            sum.re += x * at.re;
            sum.im += x * at.im;
            at *= turn;
        }
    }

    /// Quadrature nodes for a part of this length and a polynomial of at most degree 5.
    fn nodes(&self, length_s: f64) -> &'static [(f64, f64)] {
        let turned = self.omega * length_s * self.sums.len() as f64;
        match LARGEST_ANGLES.iter().filter(|most| turned > **most).count() {
            0 => &GAUSS_3,
            1 => &GAUSS_4,
            _ => &GAUSS_5,
        }
    }

    /// The integrals, k = 0 … `highest`.
    pub fn finish(mut self) -> Vec<ComplexDual<S>> {
        if let Some(points) = &self.points {
            points.add_to(self.grid, &mut self.sums);
        }
        if self.whole.is_empty() {
            return self.sums;
        }
        let used: Vec<usize> = (0..S::LANES)
            .filter(|lane| self.whole.iter().flatten().any(|power| power.lane(*lane) != 0.0))
            .collect();
        let values = self.filon(|power| power.value());
        let lanes: Vec<Vec<Complex>> =
            used.iter().map(|lane| self.filon(|power| power.lane(*lane))).collect();
        for (k, sum) in self.sums.iter_mut().enumerate() {
            let lane_of = |lane: usize| {
                used.iter().position(|l| *l == lane).map_or(Complex::default(), |i| lanes[i][k])
            };
            let here = values[k];
            *sum = *sum
                + ComplexDual {
                    re: S::with_lanes(here.re, |lane| lane_of(lane).re),
                    im: S::with_lanes(here.im, |lane| lane_of(lane).im),
                };
        }
        self.sums
    }

    /// The integrals over the whole cells, of the numbers that `part` takes from the coefficients.
    fn filon(&self, part: impl Fn(&S) -> f64) -> Vec<Complex> {
        let samples = self.grid.samples();
        let step_s = std::f64::consts::TAU / self.omega / samples as f64;
        // One complex FFT transforms two real sequences.
        let transforms: [Vec<Complex>; 3] = std::array::from_fn(|pair| {
            let mut signal: Vec<Complex> = self
                .whole
                .iter()
                .map(|powers| Complex::new(part(&powers[2 * pair]), part(&powers[2 * pair + 1])))
                .collect();
            self.grid.forward(&mut signal);
            signal
        });
        (0..self.sums.len())
            .map(|k| {
                let (n, mirrored) = (k % samples, (samples - k % samples) % samples);
                let moments = self.grid.moments(k);
                let mut sum = Complex::new(0.0, 0.0);
                for (pair, transform) in transforms.iter().enumerate() {
                    let (here, there) = (transform[n], transform[mirrored].conj());
                    let difference = here - there;
                    let even = 0.5 * (here + there);
                    let odd = 0.5 * Complex::new(difference.im, -difference.re);
                    sum += moments[2 * pair] * even + moments[2 * pair + 1] * odd;
                }
                step_s * sum
            })
            .collect()
    }
}
