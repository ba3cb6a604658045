//! Fourier integrals of one period, piece by piece.

use std::f64::consts::TAU;

use super::stepping::Piece;
use crate::measurement::Complex;

/// Sums ∫ x(t) exp(−jkωt) dt over the pieces of a period.
pub(super) struct FourierSeries {
    steps: f64,
    elapsed_s: f64,
    integrals: Vec<Complex>,
}

impl FourierSeries {
    pub(super) fn new(highest: usize, steps: usize) -> Self {
        let integrals = vec![Complex::new(0.0, 0.0); highest + 1];
        Self { steps: steps as f64, elapsed_s: 0.0, integrals }
    }

    /// Simpson's rule; the value in the middle is the cubic's through both ends and
    /// slopes.
    pub(super) fn add(&mut self, piece: &Piece, state: usize) {
        let (start, end) = (piece.start[state], piece.end[state]);
        let slopes = piece.start_slope[state] - piece.end_slope[state];
        let middle = 0.5 * (start + end) + piece.duration_s / 8.0 * slopes;
        let middle_steps = 0.5 * (piece.from_steps + piece.to_steps);
        let weight = piece.duration_s / 6.0;
        for (value, time_steps) in [
            (weight * start, piece.from_steps),
            (4.0 * weight * middle, middle_steps),
            (weight * end, piece.to_steps),
        ] {
            let turn = Complex::from_polar(1.0, -TAU * time_steps / self.steps);
            let mut phasor = Complex::new(value, 0.0);
            for integral in &mut self.integrals {
                *integral += phasor;
                phasor *= turn;
            }
        }
        self.elapsed_s += piece.duration_s;
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
