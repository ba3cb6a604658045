//! Nonlinear functions of the motion, with their derivatives.

use std::fmt::Debug;

use crate::plant::Scalar;

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

    /// A velocity below which it changes quickly, where there is one.
    pub fn velocity_scale(&self) -> Option<f64> {
        self.form.velocity_scale(&self.values)
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
