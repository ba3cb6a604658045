//! What an effect says of itself.

use std::fmt::Debug;

use crate::plant::Friction;

use super::axis::{Axis, Wide};
use super::parameter::{Parameter, Range, Scope};
use super::slot::Slot;

/// A physical effect.
pub trait Effect: Debug + Sync {
    /// Identifier used on the wire and on the command line.
    fn id(&self) -> &'static str;

    /// What it is in the machine, for a person.
    fn meaning(&self) -> &'static str;

    /// What it looks like in a response, for a person.
    fn signature(&self) -> &'static str;

    /// Ids of effects that may look like it.
    fn imitators(&self) -> &'static [&'static str];

    /// The place in the chain that it fills.
    fn slot(&self) -> Slot;

    /// Its parameters, in the order in which [`Self::enter`] takes them.
    fn parameters(&self) -> &'static [Parameter];

    /// Whether a measurement must say in which order it was acquired.
    fn needs_run(&self) -> bool {
        false
    }

    /// Whether the misfit has a valley for every radian that an angle in proportion
    /// to the travel turns further: a search must then scan finely. Such an effect
    /// is a torque; its parameters are a size, that proportion, and an angle.
    fn oscillates(&self) -> bool {
        false
    }

    /// Whether the mean of the velocity is zero with it, whatever friction does.
    fn settles(&self) -> bool {
        false
    }

    /// Makes the effect this many times as large to first order, its shape kept:
    /// parameters at which it vanishes move away from there. `ranges` are those of
    /// its parameters.
    fn resize(&self, values: &mut [f64], ranges: &[Range], factor: f64) {
        for (value, range) in values.iter_mut().zip(ranges) {
            match range.absent {
                Some(absent) if absent.is_infinite() => *value /= factor,
                Some(absent) => *value = absent + factor * (*value - absent),
                None => (),
            }
        }
    }

    /// The one of its parameters that is the rarer the smaller it is below its likely range.
    fn rarer_where_small(&self) -> Option<usize> {
        None
    }

    /// Values of its parameters that a search tries first; empty where a coarse grid over
    /// their likely ranges will do.
    fn start_points(&self, _scope: &Scope) -> Vec<Vec<f64>> {
        Vec::new()
    }

    /// Where some of its parameters do nothing, moves them to where all of them act: no
    /// derivative tells a fit that they may matter.
    fn escape_dead_zone(&self, _values: &mut [f64], _friction: &Friction) {}

    /// Enters the axis, by its parameters, in an experiment that stands at
    /// `run_share` (0 first, 1 last) of the acquisition.
    fn enter(&self, parameters: &[Wide], run_share: f64, axis: &mut Axis<Wide>);
}
