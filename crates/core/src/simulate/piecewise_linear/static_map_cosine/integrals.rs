//! Harmonics of a bent cosine and its integrals over a rest, piece by piece.

use crate::measurement::Complex;
use crate::plant::Scalar;

use super::BentCosine;
use crate::simulate::base::spectrum::weight;
use crate::simulate::piecewise_linear::drive::response;
use crate::simulate::signal::complex_dual::ComplexDual;

impl<S: Scalar> BentCosine<S> {
    /// Harmonics T₀ … T_H of the torque.
    pub fn lines(&self, highest: usize) -> Vec<ComplexDual<S>> {
        let mut input = vec![S::constant(0.0); highest + 1];
        // u is even: half a period gives half of every real integral.
        let half = 0.5 * self.period_s();
        for piece in self.pieces.iter().filter(|piece| piece.from_s < half) {
            let turns = Integrals::new(self.omega, piece.from_s, piece.end_s(), highest + 1);
            for (k, sum) in input.iter_mut().enumerate() {
                let [below, here, above] = turns.around(k);
                let cosine = 0.5 * self.magnitude * (below + above).re;
                *sum += piece.offset * here.re + piece.slope * cosine;
            }
        }
        let filtered = |(k, sum): (usize, S)| {
            let share = 2.0 * weight(k, self.period_s());
            response(&self.actuator, k as f64 * self.omega).scaled(sum * share)
        };
        input.into_iter().enumerate().map(filtered).collect()
    }

    /// Adds ∫ τ exp(−jkωt) dt between two instants of the period to `sums`.
    pub fn add_integrals(&self, (from_s, to_s): (f64, f64), sums: &mut [ComplexDual<S>]) {
        for piece in &self.pieces {
            let (start, end) = (from_s.max(piece.from_s), to_s.min(piece.end_s()));
            if end <= start {
                continue;
            }
            let turns = Integrals::new(self.omega, start, end, sums.len());
            for (k, sum) in sums.iter_mut().enumerate() {
                let [below, here, above] = turns.around(k);
                let turned =
                    (self.torque * below + self.torque.conj() * above).scaled(piece.slope * 0.5);
                *sum = *sum
                    + turned
                    + ComplexDual::new(piece.offset * here.re, piece.offset * here.im);
            }
            for (m, mode) in self.modes.iter().enumerate() {
                let left = |time_s: f64| {
                    let exponent = mode.rate.scaled(S::constant(time_s - piece.from_s));
                    piece.excited[m] * exponent.exp()
                };
                let (first, last) = (left(start), left(end));
                let one = Complex::new(1.0, 0.0);
                let (mut at_start, mut at_end) = (one, one);
                for (k, sum) in sums.iter_mut().enumerate() {
                    let through =
                        |rate: ComplexDual<S>, first: ComplexDual<S>, last: ComplexDual<S>| {
                            let by = ComplexDual::new(rate.re, rate.im - k as f64 * self.omega)
                                .inverse();
                            (last * at_end - first * at_start) * by
                        };
                    *sum = *sum
                        + if mode.count == 1.0 {
                            through(mode.rate, first, last)
                        } else {
                            // Re z is half of z and of its conjugate.
                            let half = S::constant(0.5);
                            (through(mode.rate, first, last)
                                + through(mode.rate.conj(), first.conj(), last.conj()))
                            .scaled(half)
                        };
                    at_start *= turns.start;
                    at_end *= turns.end;
                }
            }
        }
    }
}

/// ∫ exp(−jkωt) dt between two instants.
struct Integrals {
    /// exp(−jωt) at the first.
    start: Complex,
    /// And at the second.
    end: Complex,
    /// The integrals, k = −1 … `highest`.
    values: Vec<Complex>,
}

impl Integrals {
    fn new(omega: f64, from_s: f64, to_s: f64, highest: usize) -> Self {
        let start = Complex::from_polar(1.0, -omega * from_s);
        let end = Complex::from_polar(1.0, -omega * to_s);
        let mut values = vec![Complex::new(0.0, 0.0), Complex::new(to_s - from_s, 0.0)];
        let (mut at_start, mut at_end) = (start, end);
        for k in 1..=highest {
            let difference = at_start - at_end;
            let scale = 1.0 / (k as f64 * omega);
            values.push(Complex::new(difference.im * scale, -difference.re * scale));
            at_start *= start;
            at_end *= end;
        }
        values[0] = values[2].conj();
        Self { start, end, values }
    }

    /// At k − 1, k and k + 1.
    fn around(&self, k: usize) -> [Complex; 3] {
        [self.values[k], self.values[k + 1], self.values[k + 2]]
    }
}
