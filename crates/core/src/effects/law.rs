//! Functions of velocity and position (torques, friction curves), with their derivatives.
//!
//! A [`Form`] is the function in `f64`. A [`Law`] is a form with parameters; it applies the chain
//! rule, so that it carries the derivatives of any [`Scalar`].

use std::fmt::Debug;

use crate::plant::Scalar;

use super::taylor_series::TaylorSeries;

/// Largest number of parameters of a law.
pub const LAW_PARAMETERS: usize = 3;

/// The value and the derivatives of a function of velocity and position.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Partials {
    /// Value of the function.
    pub value: f64,
    /// Derivative by v.
    pub by_velocity: f64,
    /// Derivative by θ.
    pub by_position: f64,
    /// Derivatives by the parameters.
    pub by_parameter: [f64; LAW_PARAMETERS],
}

/// A function without values for its parameters.
pub trait Form: Debug + Sync {
    /// The function at velocity v and position θ, in velocity and position units.
    fn at(&self, parameters: &[f64; LAW_PARAMETERS], velocity: f64, position: f64) -> Partials;

    /// Whether it depends on θ.
    fn uses_position(&self) -> bool;

    /// The velocity below which it varies strongly, if there is one.
    fn velocity_scale(&self, _parameters: &[f64; LAW_PARAMETERS]) -> Option<f64> {
        None
    }

    /// Whether it is linear in v and θ, without a constant.
    fn is_linear(&self) -> bool {
        false
    }

    /// Whether [`Form::extend`] computes its Taylor series. The form then depends on v or on θ, not
    /// on both.
    fn has_series(&self) -> bool {
        false
    }

    /// Computes coefficient `m` of the value and of every derivative, from the coefficients up to
    /// `m` of the argument and those below `m` of all others.
    fn extend(&self, _parameters: &[f64; LAW_PARAMETERS], _m: usize, _series: &mut TaylorSeries) {}

    /// Whether it is sinusoidal in θ; then its first parameters are amplitude and spatial
    /// frequency.
    fn ripples(&self) -> bool {
        false
    }

    /// Whether any two motions under the same input still approach each other with this torque. The
    /// periodic motion is then unique.
    fn contracts(&self) -> bool;
}

/// A form with values for its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Law<S> {
    form: &'static dyn Form,
    parameters: [S; LAW_PARAMETERS],
    values: [f64; LAW_PARAMETERS],
}

impl<S: Scalar> Law<S> {
    /// A form with its parameters. Those beyond `parameters` are set to 0.
    pub fn new(form: &'static dyn Form, parameters: &[S]) -> Self {
        let zero = S::constant(0.0);
        let parameters = std::array::from_fn(|i| parameters.get(i).copied().unwrap_or(zero));
        Self { form, parameters, values: parameters.map(S::value) }
    }

    /// Its form.
    pub fn form(&self) -> &'static dyn Form {
        self.form
    }

    /// Converts every parameter with `f`.
    pub fn map<T: Scalar>(&self, f: impl Fn(S) -> T) -> Law<T> {
        Law::new(self.form, &self.parameters.map(f))
    }

    /// The same law; if it is sinusoidal in θ, its amplitude is multiplied by `share`.
    pub(super) fn with_ripple(&self, share: f64) -> Self {
        let mut parameters = self.parameters;
        if self.form.ripples() {
            parameters[0] = parameters[0] * share;
        }
        Self::new(self.form, &parameters)
    }

    /// Size of the spatial frequency, rad per unit of θ; 0 if the law is not sinusoidal in θ.
    pub(super) fn ripple_rate(&self) -> f64 {
        if self.form.ripples() { self.values[1].abs() } else { 0.0 }
    }

    /// See [`Form::velocity_scale`].
    pub fn velocity_scale(&self) -> Option<f64> {
        self.form.velocity_scale(&self.values)
    }

    /// Taylor coefficient `m` of the law along a motion; the derivatives of the law follow beside it
    /// in `series`. `argument` is coefficient m of θ if the form uses θ, otherwise of v. The series
    /// must hold the coefficients below `m` already.
    #[inline]
    pub fn term(&self, series: &mut TaylorSeries, argument: f64, m: usize) -> f64 {
        series.argument[m] = argument;
        self.form.extend(&self.values, m, series);
        series.value[m]
    }

    /// The derivatives of Taylor coefficient `m`, as a number of value 0. `argument(i)` has the
    /// derivatives of coefficient i ≤ m of the argument; its value does not matter. `series` comes
    /// from [`Self::term`].
    ///
    /// The derivative of coefficient m is Σⱼ (∂f/∂x)ₘ₋ⱼ·xⱼ' + Σₚ (∂f/∂p)ₘ·p', where x is the
    /// argument, p a parameter, a prime the derivative along a lane, and j = 0 … m.
    #[inline]
    pub fn term_derivative(
        &self,
        series: &TaylorSeries,
        argument: impl Fn(usize) -> S,
        m: usize,
    ) -> S {
        let mut sum = S::constant(0.0);
        for (j, by) in series.by_argument[..=m].iter().rev().enumerate() {
            sum += argument(j) * *by;
        }
        if series.parameters_vary {
            for (by, parameter) in series.by_parameter.iter().zip(&self.parameters) {
                sum += *parameter * by[m];
            }
        }
        sum - sum.value()
    }

    /// The law at velocity v and position θ.
    #[inline]
    pub fn at(&self, velocity: S, position: S) -> S {
        let there = self.form.at(&self.values, velocity.value(), position.value());
        S::with_lanes(there.value, |lane| {
            let by_state =
                there.by_velocity * velocity.lane(lane) + there.by_position * position.lane(lane);
            let by_parameters = there.by_parameter.iter().zip(&self.parameters);
            by_parameters.fold(by_state, |sum, (slope, p)| sum + slope * p.lane(lane))
        })
    }
}
