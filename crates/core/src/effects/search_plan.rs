//! How a search tries an effect.

use crate::plant::Friction;

use super::parameter::{Range, Scope};

/// Where fits of an effect start.
#[derive(Debug, Clone, Copy)]
pub enum Starts {
    /// A coarse grid over the likely ranges of the parameters.
    Grid,
    /// A list of parameter values, for effects whose misfit has local minima that a coarse grid
    /// misses.
    Points(fn(&Scope) -> Vec<Vec<f64>>),
    /// A fine scan over the spatial frequency N of a torque sinusoidal in position. The misfit has
    /// about one local minimum for each radian of N times the travel. The parameters must be
    /// amplitude, N and phase, in this order.
    FrequencyScan,
}

/// How a search tries an effect. [`SearchPlan::DEFAULT`] suits most effects.
#[derive(Debug, Clone, Copy)]
pub struct SearchPlan {
    /// Where fits start.
    pub starts: Starts,
    /// Scales the effect's change of the response by a factor, to first order, and keeps its shape.
    /// Arguments: parameter values, their ranges, factor.
    pub resize: fn(&mut [f64], &[Range], f64),
    /// Index of a parameter whose prior density falls in proportion to its value below the likely
    /// range ([`Range::share_of_small`]).
    pub rare_when_small: Option<usize>,
    /// Whether only a measurement that states the order of acquisition can show the effect.
    pub needs_run: bool,
    /// Whether the effect makes the mean velocity zero, even with asymmetric friction.
    pub forces_zero_mean: bool,
    /// Moves the parameters out of a region where some of them have no influence, and hence no
    /// derivative that a fit could follow. Arguments: parameter values, friction of the plant.
    pub escape_dead_zone: Option<fn(&mut [f64], &Friction)>,
}

impl SearchPlan {
    /// Fits start from a grid. The effect is resized by scaling the distance of each parameter from
    /// [`Range::absent`].
    pub const DEFAULT: Self = Self {
        starts: Starts::Grid,
        resize: scale_distance_from_absence,
        rare_when_small: None,
        needs_run: false,
        forces_zero_mean: false,
        escape_dead_zone: None,
    };
}

/// Multiplies the distance of every parameter from [`Range::absent`] by `factor`, or divides the
/// parameter by `factor` if that value is infinite.
fn scale_distance_from_absence(values: &mut [f64], ranges: &[Range], factor: f64) {
    for (value, range) in values.iter_mut().zip(ranges) {
        match range.absent {
            Some(absent) if absent.is_infinite() => *value /= factor,
            Some(absent) => *value = absent + factor * (*value - absent),
            None => (),
        }
    }
}
