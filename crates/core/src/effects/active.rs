//! An effect together with values for its parameters.

use super::effect::Effect;

/// An effect with values for its parameters.
#[derive(Debug, Clone)]
pub struct ActiveEffect {
    effect: &'static dyn Effect,
    values: Vec<f64>,
}

/// The number of values differs from the number of the effect's parameters.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{id}` takes {wanted} parameters, not {given}")]
pub struct WrongParameters {
    /// Id of the effect.
    pub id: &'static str,
    /// Number of its parameters.
    pub wanted: usize,
    /// Number of values given.
    pub given: usize,
}

impl ActiveEffect {
    /// An effect with values in the order of its parameters.
    ///
    /// # Errors
    /// [`WrongParameters`] if there are more or fewer values than parameters.
    pub fn new(effect: &'static dyn Effect, values: Vec<f64>) -> Result<Self, WrongParameters> {
        let (wanted, given) = (effect.parameters().len(), values.len());
        if wanted != given {
            return Err(WrongParameters { id: effect.id(), wanted, given });
        }
        Ok(Self { effect, values })
    }

    /// Like [`Self::new`], unchecked: the caller passes one value for each parameter.
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
