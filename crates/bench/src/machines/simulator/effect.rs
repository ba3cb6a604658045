//! An effect of a machine: its physics, with values for its parameters.

use std::fmt;

use super::parts::Parts;
use super::physics::{ALL, Physics};

/// Most parameters of one effect.
const MOST_PARAMETERS: usize = 4;

/// One effect with its parameters. Torques and levels are in input units.
#[derive(Clone, Copy)]
pub struct Effect {
    physics: &'static Physics,
    values: [f64; MOST_PARAMETERS],
}

/// A value that no machine has.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("`{parameter}` of `{id}` is {value}: it must be finite and {requirement}")]
pub struct Unusable {
    /// The effect.
    pub id: &'static str,
    /// Its parameter.
    pub parameter: &'static str,
    /// The value.
    pub value: f64,
    /// What it must be.
    pub requirement: &'static str,
}

impl Effect {
    /// The effect of this id with values in the order of its parameters.
    ///
    /// # Panics
    /// If no physics has this id, or as many parameters.
    pub fn of(id: &str, values: &[f64]) -> Self {
        let physics = ALL.iter().find(|physics| physics.id == id);
        let physics = physics.unwrap_or_else(|| panic!("the simulator has no `{id}`"));
        assert_eq!(values.len(), physics.parameters.len(), "parameters of `{id}`");
        let mut all = [0.0; MOST_PARAMETERS];
        all[..values.len()].copy_from_slice(values);
        Self { physics, values: all }
    }

    /// The effect of this id with parameters by name.
    ///
    /// # Panics
    /// If no physics has this id, or these parameters.
    pub fn new<'a>(id: &str, named: impl IntoIterator<Item = (&'a str, f64)>) -> Self {
        let physics = ALL.iter().find(|physics| physics.id == id);
        let known = physics.unwrap_or_else(|| panic!("the simulator has no `{id}`")).parameters;
        let mut values = vec![None; known.len()];
        for (name, value) in named {
            let place = known.iter().position(|(known, _)| *known == name);
            values[place.unwrap_or_else(|| panic!("`{id}` has no `{name}`"))] = Some(value);
        }
        let values: Option<Vec<f64>> = values.into_iter().collect();
        Self::of(id, &values.unwrap_or_else(|| panic!("a parameter of `{id}` is missing")))
    }

    /// The id under which the effect is known everywhere.
    pub fn id(&self) -> &'static str {
        self.physics.id
    }

    /// Values of the parameters, in their order.
    pub fn values(&self) -> &[f64] {
        &self.values[..self.physics.parameters.len()]
    }

    /// Names and values of the parameters.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        let names = self.physics.parameters.iter().map(|(name, _)| *name);
        names.zip(self.values().iter().copied()).collect()
    }

    /// The value of a parameter.
    ///
    /// # Panics
    /// If it has no such parameter.
    pub fn value(&self, name: &str) -> f64 {
        let place = self.physics.parameters.iter().position(|(known, _)| *known == name);
        self.values[place.unwrap_or_else(|| panic!("`{}` has no `{name}`", self.id()))]
    }

    /// Whether a machine may have these values.
    ///
    /// # Errors
    /// Names the first value that no machine has.
    pub fn check(&self) -> Result<(), Unusable> {
        let pairs = self.physics.parameters.iter().zip(self.values());
        match pairs.into_iter().find(|((_, range), value)| !range.holds(**value)) {
            Some((&(parameter, range), &value)) => {
                Err(Unusable { id: self.id(), parameter, value, requirement: range.words() })
            }
            None => Ok(()),
        }
    }

    /// Sets the parts of a machine that it changes.
    pub(super) fn enter(&self, parts: &mut Parts) {
        (self.physics.enter)(self.values(), parts);
    }
}

impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        self.id() == other.id() && self.values == other.values
    }
}

impl fmt::Debug for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.id())?;
        f.debug_map().entries(self.parameters()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_is_built_from_its_names_and_gives_them_back() {
        for Physics { id, parameters, .. } in ALL {
            let values = (1..).map(|i| 0.1 * f64::from(i));
            let named: Vec<(&str, f64)> =
                parameters.iter().map(|(name, _)| *name).zip(values).collect();
            let effect = Effect::new(id, named.iter().rev().copied());
            assert_eq!((effect.id(), effect.parameters()), (*id, named));
        }
    }

    #[test]
    fn a_value_that_no_machine_has_is_refused_by_its_name() {
        let refused = |rate: f64| Effect::of("slew_limit", &[rate]).check().unwrap_err();
        assert_eq!(
            refused(-1.0).to_string(),
            "`rate` of `slew_limit` is -1: it must be finite and positive"
        );
        assert!(refused(f64::NAN).to_string().contains("finite"));
        assert_eq!(Effect::of("slew_limit", &[1.0]).check(), Ok(()));
    }
}
