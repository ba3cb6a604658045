//! Torques that are nonlinear in v or θ, and the terms of their Taylor series.

use crate::effects::{Law, TaylorSeries};
use crate::plant::Scalar;

use super::{Mechanics, Mode};
use crate::simulate::base::switching_times::Motion;
use crate::simulate::hybrid::runge_kutta::Vector;

/// A nonlinear torque, and the index of the state that it depends on.
pub(super) struct NonlinearTorque<S> {
    pub(super) law: Law<S>,
    pub(super) argument: usize,
}

impl<S: Scalar> Mechanics<S> {
    /// Empty Taylor series of the nonlinear torques, with or without derivatives by their
    /// parameters.
    pub fn series(&self, parameters_vary: bool) -> Vec<TaylorSeries> {
        self.nonlinear.iter().map(|_| TaylorSeries::new(parameters_vary)).collect()
    }

    /// The derivatives of Taylor term `m` of the nonlinear torques, as a number of value 0.
    /// `lanes(i, state)` has the derivatives of term i of a state.
    #[inline]
    pub fn nonlinear_derivative(
        &self,
        series: &[TaylorSeries],
        lanes: impl Fn(usize, usize) -> S,
        m: usize,
    ) -> S {
        let mut sum = S::constant(0.0);
        for (NonlinearTorque { law, argument }, series) in self.nonlinear.iter().zip(series) {
            sum += law.term_derivative(series, |i| lanes(i, *argument), m);
        }
        sum
    }
}

impl Mechanics<f64> {
    /// The sum of the next Taylor terms of the nonlinear torques, from the terms of the states.
    #[inline]
    pub fn nonlinear_term<const M: usize>(
        &self,
        mode: Mode,
        series: &mut [TaylorSeries],
        terms: &[Vector<f64, M>],
    ) -> f64 {
        let direction = if mode.motion == Motion::Backward { -1.0 } else { 1.0 };
        let m = terms.len() - 1;
        let mut sum = 0.0;
        for (NonlinearTorque { law, argument }, series) in self.nonlinear.iter().zip(series) {
            series.direction = direction;
            sum += law.term(series, terms[m][*argument], m);
        }
        sum
    }
}
