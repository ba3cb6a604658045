//! Steps by the Taylor series of the solution.
//!
//! x' = A·x + b·(τ − g(x)) + d, where τ is a quintic and g a torque law. The Taylor series of g
//! follows term by term from that of its argument (automatic differentiation). The size of the last
//! terms gives the length of the step, so that no step is rejected, and switches are located on the
//! series itself. Inside the gap of a joint with play the motion is slow and the steps are long;
//! steps of fixed length would be limited by the contact's stiffness there too.

use super::runge_kutta::Vector;
use crate::effects::MOST_TERMS;

/// Order of a series. Both the cost and the length of a step grow with it.
const ORDER: usize = MOST_TERMS - 1;

/// Order with nonlinear torques, where the cost of a term grows with the number of terms before it.
const ORDER_NONLINEAR: usize = 9;

/// Most coefficients of a polynomial over a step.
pub(super) const MOST_POWERS: usize = ORDER + 1;

/// A step by Taylor series.
pub(super) struct Series<const M: usize> {
    /// Coefficients of the powers of u, which goes from 0 to 1 over the step; one vector per power.
    pub terms: [Vector<f64, M>; ORDER + 1],
    pub order: usize,
    pub length_s: f64,
    /// Share of the requested length that the step covers.
    pub share: f64,
    /// State at the end.
    pub end: Vector<f64, M>,
    /// Derivative by time at the end.
    pub end_slope: Vector<f64, M>,
}

impl<const M: usize> Series<M> {
    /// A step from `start` over at most `length_s`, in which no state errs by more than `allowed`.
    /// `next` computes the next term from the terms so far.
    #[inline]
    pub fn new(
        start: &Vector<f64, M>,
        length_s: f64,
        allowed: &[f64; M],
        nonlinear: bool,
        mut next: impl FnMut(&[Vector<f64, M>]) -> Vector<f64, M>,
    ) -> Self {
        let order = if nonlinear { ORDER_NONLINEAR } else { ORDER };
        let mut this = Self {
            terms: [*start; ORDER + 1],
            order,
            length_s,
            share: 1.0,
            end: *start,
            end_slope: *start,
        };
        for m in 0..order {
            this.terms[m + 1] = next(&this.terms[..=m]);
        }
        let share = this.reach(allowed);
        if share < 1.0 {
            this.share = share;
            let mut scale = 1.0;
            for term in &mut this.terms[1..=order] {
                scale *= share;
                term.iter_mut().for_each(|value| *value *= scale);
            }
            this.length_s *= share;
        }
        (this.end, this.end_slope) = this.at(1.0);
        this
    }

    /// The share of the length within which the last two terms are as small as `allowed`. A share
    /// between 0.5 and 1 becomes 0.5: two equal steps cover the length as well.
    fn reach(&self, allowed: &[f64; M]) -> f64 {
        let share = |m: usize| {
            let errors = self.terms[m].iter().zip(allowed).map(|(t, a)| (t / a).abs());
            let most = errors.fold(0.0, f64::max) as f32;
            if most <= 1.0 { 1.0 } else { most.powf(-1.0 / m as f32) }
        };
        match f64::from(share(self.order - 1).min(share(self.order))) {
            1.0.. => 1.0,
            0.5.. => 0.5,
            share => share,
        }
    }

    /// State at position u, and its derivative by time.
    pub fn at(&self, u: f64) -> (Vector<f64, M>, Vector<f64, M>) {
        let (mut state, mut slope) = (self.terms[self.order], [0.0; M]);
        for term in self.terms[..self.order].iter().rev() {
            for i in 0..M {
                slope[i] = slope[i] * u + state[i];
                state[i] = state[i] * u + term[i];
            }
        }
        slope.iter_mut().for_each(|value| *value *= 1.0 / self.length_s);
        (state, slope)
    }

    /// Whether state `i` certainly does not reach `level` within the step.
    #[inline]
    pub fn stays_beyond(&self, i: usize, level: f64) -> bool {
        let departs: f64 = self.terms[1..=self.order].iter().map(|term| term[i].abs()).sum();
        (self.terms[0][i] - level).abs() > departs
    }

    /// Coefficients of state `i` over the step.
    #[inline]
    pub fn powers(&self, i: usize) -> [f64; ORDER + 1] {
        let mut powers = [0.0; ORDER + 1];
        for (power, term) in powers.iter_mut().zip(&self.terms[..=self.order]) {
            *power = term[i];
        }
        powers
    }
}
