//! Fourier coefficients of one period, integrated piece by piece.

use super::stepping::Piece;
use crate::measurement::Complex;

/// Accumulates ∫ x(t) exp(−jkωt) dt over the pieces of a period.
pub(super) struct FourierSeries {
    omega_rad_s: f64,
    elapsed_s: f64,
    integrals: Vec<Complex>,
}

impl FourierSeries {
    pub(super) fn new(highest: usize, omega_rad_s: f64) -> Self {
        let integrals = vec![Complex::new(0.0, 0.0); highest + 1];
        Self { omega_rad_s, elapsed_s: 0.0, integrals }
    }

    /// Adds one piece by Simpson's rule, with x = `reading`(value of the state).
    pub(super) fn add<const N: usize>(
        &mut self,
        piece: &Piece<N>,
        state: usize,
        reading: impl Fn(f64) -> f64,
    ) {
        let duration_s = piece.to_s - piece.from_s;
        let weight = duration_s / 6.0;
        for (value, time_s) in [
            (weight * reading(piece.start[state]), piece.from_s),
            (4.0 * weight * reading(piece.middle(state)), 0.5 * (piece.from_s + piece.to_s)),
            (weight * reading(piece.end[state]), piece.to_s),
        ] {
            let turn = Complex::from_polar(1.0, -self.omega_rad_s * time_s);
            let mut phasor = Complex::new(value, 0.0);
            for integral in &mut self.integrals {
                *integral += phasor;
                phasor *= turn;
            }
        }
        self.elapsed_s += duration_s;
    }

    /// X₀, X₁ … of x(t) = Re Σ Xₖ exp(jkωt).
    pub(super) fn harmonics(&self) -> Vec<Complex> {
        let amplitude = |(k, integral): (usize, &Complex)| match k {
            0 => Complex::new(integral.re / self.elapsed_s, 0.0),
            _ => 2.0 * integral / self.elapsed_s,
        };
        self.integrals.iter().enumerate().map(amplitude).collect()
    }
}
