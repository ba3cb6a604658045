//! The list of effects that a diagnosis tries.

use super::ALL;
use super::effect::Effect;

/// The effects that a diagnosis tries; by default [`ALL`]. Equal if the ids and their order are.
#[derive(Debug, Clone, Copy)]
pub struct Library(pub &'static [&'static dyn Effect]);

impl Library {
    /// Its effects.
    pub fn effects(self) -> &'static [&'static dyn Effect] {
        self.0
    }
}

impl Default for Library {
    fn default() -> Self {
        Self(ALL)
    }
}

impl PartialEq for Library {
    fn eq(&self, other: &Self) -> bool {
        self.0.iter().map(|effect| effect.id()).eq(other.0.iter().map(|effect| effect.id()))
    }
}
