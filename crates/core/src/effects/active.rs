//! An effect that acts: with values for its parameters.

use super::effect::Effect;

/// An effect with values for its parameters.
#[derive(Debug, Clone)]
pub struct ActiveEffect {
    effect: &'static dyn Effect,
    values: Vec<f64>,
}

/// The values given are not those of the effect's parameters.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{id}` takes {wanted} parameters, not {given}")]
pub struct WrongParameters {
    /// The effect.
    pub id: &'static str,
    /// How many it has.
    pub wanted: usize,
    /// How many were given.
    pub given: usize,
}

impl ActiveEffect {
    /// An effect with values in the order of its parameters.
    ///
    /// # Errors
    /// When there are more or fewer values than parameters.
    pub fn new(effect: &'static dyn Effect, values: Vec<f64>) -> Result<Self, WrongParameters> {
        let (wanted, given) = (effect.parameters().len(), values.len());
        if wanted != given {
            return Err(WrongParameters { id: effect.id(), wanted, given });
        }
        Ok(Self { effect, values })
    }

    /// The same of as many values as there are parameters.
    pub(super) fn of(effect: &'static dyn Effect, values: Vec<f64>) -> Self {
        Self { effect, values }
    }

    /// The effect.
    pub fn effect(&self) -> &'static dyn Effect {
        self.effect
    }

    /// Its values, in the order of its parameters.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

impl PartialEq for ActiveEffect {
    fn eq(&self, other: &Self) -> bool {
        (self.effect.id(), &self.values) == (other.effect.id(), &other.values)
    }
}
