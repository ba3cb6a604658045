//! Nonlinear functions of the motion, with their derivatives.

use std::fmt::Debug;

use crate::plant::Scalar;

use super::taylor_series::TaylorSeries;

/// Most parameters of one law.
pub const LAW_PARAMETERS: usize = 3;

/// A function of velocity and position, and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Partials {
    /// The function.
    pub value: f64,
    /// Its derivative by v.
    pub by_velocity: f64,
    /// Its derivative by θ.
    pub by_position: f64,
    /// Its derivatives by the parameters.
    pub by_parameter: [f64; LAW_PARAMETERS],
}

/// The form of a law, its parameters aside.
pub trait Form: Debug + Sync {
    /// The function at velocity v and position θ, response units.
    fn at(&self, parameters: &[f64; LAW_PARAMETERS], velocity: f64, position: f64) -> Partials;

    /// Whether it depends on θ.
    fn uses_position(&self) -> bool;

    /// A velocity below which it changes quickly, where there is one.
    fn velocity_scale(&self, _parameters: &[f64; LAW_PARAMETERS]) -> Option<f64> {
        None
    }

    /// Whether it is linear in v and θ, and 0 with them.
    fn is_linear(&self) -> bool {
        false
    }

    /// Whether [`Form::extend`] knows its power series; it depends on one of v and θ
    /// alone, then.
    fn has_series(&self) -> bool {
        false
    }

    /// Term `m` of every series of a jet, from its argument up to there and the terms
    /// before.
    fn extend(&self, _parameters: &[f64; LAW_PARAMETERS], _m: usize, _jet: &mut TaylorSeries) {}

    /// Whether it ripples over θ, in proportion to its first parameter and as often as
    /// its second says.
    fn ripples(&self) -> bool {
        false
    }

    /// Whether, with it, any two motions under the same input still approach
    /// each other, so that the periodic one is unique.
    fn contracts(&self) -> bool;
}

/// A form with its parameters.
#[derive(Debug, Clone, Copy)]
pub struct Law<S> {
    form: &'static dyn Form,
    parameters: [S; LAW_PARAMETERS],
    values: [f64; LAW_PARAMETERS],
}

impl<S: Scalar> Law<S> {
    /// A form with its parameters; those it does not have are 0.
    pub fn new(form: &'static dyn Form, parameters: &[S]) -> Self {
        let zero = S::constant(0.0);
        let parameters = std::array::from_fn(|i| parameters.get(i).copied().unwrap_or(zero));
        Self { form, parameters, values: parameters.map(S::value) }
    }

    /// Its form.
    pub fn form(&self) -> &'static dyn Form {
        self.form
    }

    /// The same law with every parameter passed through `f`.
    pub fn map<T: Scalar>(&self, f: impl Fn(S) -> T) -> Law<T> {
        Law::new(self.form, &self.parameters.map(f))
    }

    /// This share of it, if it ripples over θ.
    pub(super) fn with_ripple(&self, share: f64) -> Self {
        let mut parameters = self.parameters;
        if self.form.ripples() {
            parameters[0] = parameters[0] * share;
        }
        Self::new(self.form, &parameters)
    }

    /// Radians by which it ripples for one unit of θ: its second parameter.
    pub(super) fn ripple_rate(&self) -> f64 {
        if self.form.ripples() { self.values[1].abs() } else { 0.0 }
    }

    /// A velocity below which it changes quickly, where there is one.
    pub fn velocity_scale(&self) -> Option<f64> {
        self.form.velocity_scale(&self.values)
    }

    /// What follows the law along a motion.
    pub fn jet(&self) -> TaylorSeries {
        let varies = |p: &S| (0..S::LANES).any(|lane| p.lane(lane) != 0.0);
        TaylorSeries::new(self.parameters.iter().any(varies))
    }

    /// The last term of the law along a motion whose argument (θ where the form uses
    /// it, v otherwise) has these terms, of which the jet knows all but the last.
    #[inline]
    pub fn term(&self, jet: &mut TaylorSeries, argument: impl Fn(usize) -> S, m: usize) -> S {
        jet.argument[m] = argument(m).value();
        self.form.extend(&self.values, m, jet);
        let mut sum = S::constant(0.0);
        if S::LANES > 0 {
            for (j, by) in jet.by_argument[..=m].iter().rev().enumerate() {
                sum += argument(j) * *by;
            }
            if jet.parameters_vary {
                for (by, parameter) in jet.by_parameter.iter().zip(&self.parameters) {
                    sum += *parameter * by[m];
                }
            }
        }
        // The terms above carry the derivatives; their sum is not the law.
        sum + (jet.value[m] - sum.value())
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
