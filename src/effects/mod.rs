//! Effects a base model may lack, and how each enters the simulation.
//!
//! Adding an effect is one file here and one line in the list of modules.

mod static_friction;

pub use static_friction::StaticFriction;

use std::fmt::Debug;

use crate::plant::Plant;

/// A physical effect with its parameters.
pub trait Effect: Debug + Send + Sync {
    /// Identifier used on the wire and on the command line.
    fn id(&self) -> &'static str;

    /// Enters the simulation by altering the plant that is simulated.
    fn enter(&self, plant: Plant) -> Plant;
}

/// The plant with every effect in place.
pub fn enter(plant: &Plant, effects: &[Box<dyn Effect>]) -> Plant {
    effects.iter().fold(*plant, |plant, effect| effect.enter(plant))
}
