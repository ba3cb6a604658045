//! Steps by the Taylor series of the solution.
//!
//! x' = A·x + b·(τ − g(x)) + d with τ a quintic and g a law whose own Taylor series follows term by
//! term from that of its argument (automatic differentiation). The size of the last terms says how
//! long the step may be, so that no step is refused, and a switch is located on the series itself.
//! Between contacts of a joint with play the motion is as slow as the torque: there such steps are
//! long, where those of a fixed length would be bound by the contact's stiffness.

use crate::effects::MOST_TERMS;
use crate::plant::Scalar;

use super::runge_kutta::Vector;

/// Highest power of a series. A step's cost grows with it as its length does.
const ORDER: usize = MOST_TERMS - 1;

/// The same where the effort for a term grows with those before it.
const ORDER_BENT: usize = 9;

/// Powers of the longest polynomial in a step.
pub(super) const MOST_POWERS: usize = ORDER + 1;

/// A step.
pub(super) struct Series<S, const M: usize> {
    /// Powers of u from 0 to 1, all states each.
    terms: [Vector<S, M>; ORDER + 1],
    order: usize,
    pub length_s: f64,
    /// The share it covers of the length asked for.
    pub share: f64,
    /// State at its end.
    pub end: Vector<S, M>,
    /// Derivative by time at its end.
    pub end_slope: Vector<S, M>,
}

impl<S: Scalar, const M: usize> Series<S, M> {
    /// From `start` over `length_s` or less, so that no state errs by more than
    /// `allowed`, of equations that are `bent` or not; `next` makes the term that comes
    /// after those it is given.
    #[inline]
    pub fn new(
        start: &Vector<S, M>,
        length_s: f64,
        allowed: &[f64; M],
        bent: bool,
        mut next: impl FnMut(&[Vector<S, M>]) -> Vector<S, M>,
    ) -> Self {
        let order = if bent { ORDER_BENT } else { ORDER };
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
                term.iter_mut().for_each(|value| *value = *value * scale);
            }
            this.length_s *= share;
        }
        (this.end, this.end_slope) = this.at(1.0);
        this
    }

    /// The share of its length after which the last terms are as small as allowed; where
    /// two steps are due they are even.
    fn reach(&self, allowed: &[f64; M]) -> f64 {
        let share = |m: usize| {
            let errors = self.terms[m].iter().zip(allowed).map(|(t, a)| (t.value() / a).abs());
            let most = errors.fold(0.0, f64::max) as f32;
            if most <= 1.0 { 1.0 } else { most.powf(-1.0 / m as f32) }
        };
        match f64::from(share(self.order - 1).min(share(self.order))) {
            1.0.. => 1.0,
            0.5.. => 0.5,
            share => share,
        }
    }

    /// State at u, and its derivative by time.
    pub fn at(&self, u: f64) -> (Vector<S, M>, Vector<S, M>) {
        let (mut state, mut slope) = (self.terms[self.order], [S::constant(0.0); M]);
        for term in self.terms[..self.order].iter().rev() {
            for i in 0..M {
                slope[i] = slope[i] * u + state[i];
                state[i] = state[i] * u + term[i];
            }
        }
        slope.iter_mut().for_each(|value| *value = *value * (1.0 / self.length_s));
        (state, slope)
    }

    /// Whether state `i` cannot have met `level` within the step.
    #[inline]
    pub fn stays_beyond(&self, i: usize, level: f64) -> bool {
        let departs: f64 =
            self.terms[1..=self.order].iter().map(|term| term[i].value().abs()).sum();
        (self.terms[0][i].value() - level).abs() > departs
    }

    /// Part of state `i` over the step, as powers of u from 0 to 1.
    #[inline]
    pub fn powers<T: Scalar>(&self, i: usize, part: impl Fn(S) -> T) -> [T; ORDER + 1] {
        let mut powers = [T::constant(0.0); ORDER + 1];
        for (power, term) in powers.iter_mut().zip(&self.terms[..=self.order]) {
            *power = part(term[i]);
        }
        powers
    }
}
