//! How a search tries an effect.

use crate::plant::Friction;

use super::parameter::{Range, Scope};

/// Where fits of an effect start.
#[derive(Debug, Clone, Copy)]
pub enum Starts {
    /// A coarse grid over the likely ranges of its parameters.
    Grid,
    /// These values of its parameters, for effects whose misfit has minima that a coarse grid
    /// misses.
    Points(fn(&Scope) -> Vec<Vec<f64>>),
    /// A fine scan of the second parameter, the spatial frequency of a torque that is sinusoidal
    /// in the position. The misfit has a minimum for every radian that its argument turns further
    /// over the travel. The first parameter is the torque's size, the third its phase.
    FrequencyScan,
}

/// How a search tries an effect. [`SearchPlan::DEFAULT`] suits most.
#[derive(Debug, Clone, Copy)]
pub struct SearchPlan {
    /// Where fits start.
    pub starts: Starts,
    /// Makes the effect `factor` times as large to first order and keeps its shape:
    /// `(values, ranges of the parameters, factor)`.
    pub resize: fn(&mut [f64], &[Range], f64),
    /// The parameter that is the rarer the smaller it is below its likely range, by its index.
    pub rare_when_small: Option<usize>,
    /// Whether a measurement must state the order of acquisition.
    pub needs_run: bool,
    /// Whether the mean of the velocity is zero with it, whatever friction does.
    pub forces_zero_mean: bool,
    /// Moves its parameters out of a region where some of them have no influence, and therefore
    /// no derivative that a fit could follow.
    pub escape_dead_zone: Option<fn(&mut [f64], &Friction)>,
}

impl SearchPlan {
    /// Starts from a grid; parameters at which the effect vanishes move away from there in
    /// proportion to its size.
    pub const DEFAULT: Self = Self {
        starts: Starts::Grid,
        resize: away_from_absence,
        rare_when_small: None,
        needs_run: false,
        forces_zero_mean: false,
        escape_dead_zone: None,
    };
}

/// Moves every parameter that has a value at which the effect vanishes away from that value, in
/// proportion to the factor.
fn away_from_absence(values: &mut [f64], ranges: &[Range], factor: f64) {
    for (value, range) in values.iter_mut().zip(ranges) {
        match range.absent {
            Some(absent) if absent.is_infinite() => *value /= factor,
            Some(absent) => *value = absent + factor * (*value - absent),
            None => (),
        }
    }
}
