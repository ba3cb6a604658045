//! A step taken, whichever way: both ends and what lies between.

use crate::plant::Scalar;

use super::super::wave::{Quintic, through};
use super::runge_kutta::{Stages, Vector};

/// What a step knows beyond its ends.
enum Between<S, const M: usize> {
    /// A Runge–Kutta step's stages.
    Stages(Stages<S, M>),
    /// Nothing.
    Ends,
    /// Second derivatives at both ends.
    Curvatures([Vector<S, M>; 2]),
}

/// A step of a motion.
pub(super) struct Step<S, const M: usize> {
    length_s: S,
    start: Vector<S, M>,
    /// State at its end.
    pub end: Vector<S, M>,
    /// Derivatives by time at both ends.
    slopes: [Vector<S, M>; 2],
    between: Between<S, M>,
}

impl<S: Scalar, const M: usize> Step<S, M> {
    /// Of stages from `start`, where the derivative is `slope`.
    #[inline]
    pub fn of_stages(
        start: &Vector<S, M>,
        slope: &Vector<S, M>,
        length_s: S,
        stages: Stages<S, M>,
    ) -> Self {
        let (end, slopes) = (stages.end, [*slope, *stages.end_slope()]);
        Self { length_s, start: *start, end, slopes, between: Between::Stages(stages) }
    }

    /// Of exact ends with their derivatives by time.
    #[inline]
    pub fn of_ends(ends: [Vector<S, M>; 2], slopes: [Vector<S, M>; 2], length_s: S) -> Self {
        let [start, end] = ends;
        Self { length_s, start, end, slopes, between: Between::Ends }
    }

    /// Adds second derivatives at both ends.
    pub fn bend(&mut self, curvatures: [Vector<S, M>; 2]) {
        self.between = Between::Curvatures(curvatures);
    }

    /// Derivative at the end.
    pub fn end_slope(&self) -> &Vector<S, M> {
        &self.slopes[1]
    }

    /// Whether state `i` cannot have met `level` within the step: from values at
    /// both ends a cubic departs by 4/27 of what its slopes there make, at most.
    #[inline]
    pub fn stays_beyond(&self, i: usize, level: f64) -> bool {
        let (start, end) = (self.start[i].value() - level, self.end[i].value() - level);
        let slopes = self.slopes[0][i].value().abs() + self.slopes[1][i].value().abs();
        let departs = 0.2 * slopes * self.length_s.value();
        start * end > 0.0 && start.abs().min(end.abs()) > departs
    }

    /// State `i` over the step, as powers of u from 0 to 1.
    #[inline]
    pub fn powers(&self, i: usize) -> Quintic<S> {
        let (begin, finish) = match &self.between {
            Between::Stages(stages) => return stages.powers(i),
            Between::Curvatures([begin, finish]) => (begin[i], finish[i]),
            Between::Ends => {
                // The cubic: its own second derivatives.
                let h = self.length_s;
                let mean = (self.end[i] - self.start[i]) / h * 3.0;
                let [first, last] = [self.slopes[0][i], self.slopes[1][i]];
                let scale = S::constant(2.0) / h;
                ((mean - first * 2.0 - last) * scale, (first + last * 2.0 - mean) * scale)
            }
        };
        let (h, square) = (self.length_s, self.length_s * self.length_s);
        let [first, last] = &self.slopes;
        through(
            [self.start[i], first[i] * h, begin * square],
            [self.end[i], last[i] * h, finish * square],
        )
    }
}
