//! The interface of an effect.

use std::fmt::Debug;

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::parameter::{Parameter, Scope};
use super::search_plan::{SearchPlan, Starts};
use super::slot::Slot;

/// A physical effect that the base model may lack.
pub trait Effect: Debug + Sync {
    /// Everything about the effect except how it enters the simulation.
    fn descriptor(&self) -> &'static Descriptor;

    /// Adds the effect, with these parameters, to the axis of one experiment. `run_share` is the
    /// position of the experiment in the acquisition: 0 for the first, 1 for the last.
    fn enter(&self, parameters: &[Wide], run_share: f64, axis: &mut Axis<Wide>);
}

impl<'a> dyn Effect + 'a {
    /// Identifier in the API and on the command line.
    pub fn id(&self) -> &'static str {
        self.descriptor().id
    }

    /// The part of the axis that it takes.
    pub fn slot(&self) -> Slot {
        self.descriptor().slot
    }

    /// Its parameters, in the order in which [`Effect::enter`] takes them.
    pub fn parameters(&self) -> &'static [Parameter] {
        self.descriptor().parameters
    }

    /// How a search tries it.
    pub fn search(&self) -> &'static SearchPlan {
        &self.descriptor().search
    }

    /// Whether fits start from a fine scan over a spatial frequency.
    pub fn is_scanned(&self) -> bool {
        matches!(self.search().starts, Starts::FrequencyScan)
    }

    /// Parameter values from which fits start; empty if fits start from a grid or a scan.
    pub fn start_points(&self, scope: &Scope) -> Vec<Vec<f64>> {
        match self.search().starts {
            Starts::Points(points) => points(scope),
            Starts::Grid | Starts::FrequencyScan => Vec::new(),
        }
    }

    /// The name under which one of its parameters is reported: `spring.stiffness`.
    pub fn key(&self, parameter: &Parameter) -> String {
        format!("{}.{}", self.id(), parameter.name)
    }
}
