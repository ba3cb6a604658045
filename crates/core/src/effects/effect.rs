//! The interface of an effect.

use std::fmt::Debug;

use super::axis::{Axis, Wide};
use super::descriptor::Descriptor;
use super::parameter::{Parameter, Scope};
use super::search_plan::{SearchPlan, Starts};
use super::slot::Slot;

/// A physical effect.
pub trait Effect: Debug + Sync {
    /// Everything about it but how it enters the simulation.
    fn descriptor(&self) -> &'static Descriptor;

    /// Enters the axis, by its parameters, in an experiment that stands at `run_share` (0 first,
    /// 1 last) of the acquisition.
    fn enter(&self, parameters: &[Wide], run_share: f64, axis: &mut Axis<Wide>);
}

impl<'a> dyn Effect + 'a {
    /// Identifier on the wire and on the command line.
    pub fn id(&self) -> &'static str {
        self.descriptor().id
    }

    /// The place in the chain that it fills.
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

    /// Values of its parameters from which fits start; empty where these are a grid or a scan.
    pub fn start_points(&self, scope: &Scope) -> Vec<Vec<f64>> {
        match self.search().starts {
            Starts::Points(points) => points(scope),
            Starts::Grid | Starts::FrequencyScan => Vec::new(),
        }
    }

    /// Under which name a parameter of it is reported.
    pub fn key(&self, parameter: &Parameter) -> String {
        format!("{}.{}", self.id(), parameter.name)
    }
}
