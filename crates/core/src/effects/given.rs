//! Effects as a user states them: an id, and parameters by name.

use std::collections::BTreeMap;

use super::active::ActiveEffect;
use super::effect::Effect;
use super::{ALL, find};

/// Why an id and named parameters do not make an effect.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NoSuchEffect {
    /// No effect has this id.
    #[error("no effect is called `{id}`; there are {}", ids())]
    UnknownId {
        /// The id that was given.
        id: String,
    },
    /// The effect has no such parameter.
    #[error("`{id}` has no parameter `{parameter}`; it has {}", parameters(id))]
    UnknownParameter {
        /// The effect.
        id: &'static str,
        /// The name that was given.
        parameter: String,
    },
    /// A parameter is missing.
    #[error("`{id}` needs `{parameter}`; its parameters are {}", parameters(id))]
    Missing {
        /// The effect.
        id: &'static str,
        /// The missing parameter.
        parameter: &'static str,
    },
    /// A value is outside the domain of its parameter.
    #[error("`{parameter}` of `{id}` is {value}: it must be finite and {requirement}")]
    Unusable {
        /// The effect.
        id: &'static str,
        /// Its parameter.
        parameter: &'static str,
        /// The value that was given.
        value: f64,
        /// The values that are admissible, in words.
        requirement: &'static str,
    },
}

fn ids() -> String {
    ALL.iter().map(|effect| effect.id()).collect::<Vec<_>>().join(", ")
}

fn parameters(id: &str) -> String {
    let names = find(id).into_iter().flat_map(|effect| effect.parameters());
    names.map(|parameter| parameter.name).collect::<Vec<_>>().join(", ")
}

impl ActiveEffect {
    /// The effect with this id and these named parameters. Every parameter must be given.
    ///
    /// # Errors
    /// See [`NoSuchEffect`]; its messages list the known ids and parameters.
    pub fn from_names(id: &str, given: &BTreeMap<String, f64>) -> Result<Self, NoSuchEffect> {
        let effect: &'static dyn Effect =
            find(id).ok_or_else(|| NoSuchEffect::UnknownId { id: id.to_owned() })?;
        let (id, known) = (effect.id(), effect.parameters());
        if let Some(name) = given.keys().find(|name| known.iter().all(|own| own.name != **name)) {
            return Err(NoSuchEffect::UnknownParameter { id, parameter: name.clone() });
        }
        let mut values = Vec::with_capacity(known.len());
        for own in known {
            let parameter = own.name;
            let value = *given.get(parameter).ok_or(NoSuchEffect::Missing { id, parameter })?;
            if !own.domain.holds(value) {
                let requirement = own.domain.words();
                return Err(NoSuchEffect::Unusable { id, parameter, value, requirement });
            }
            values.push(value);
        }
        Ok(Self::of(effect, values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn given(id: &str, parameters: &[(&str, f64)]) -> Result<ActiveEffect, String> {
        let parameters = parameters.iter().map(|(name, value)| ((*name).to_owned(), *value));
        ActiveEffect::from_names(id, &parameters.collect()).map_err(|error| error.to_string())
    }

    #[test]
    fn values_are_taken_by_name_in_whatever_order() {
        let joint = [("stiffness", 3.0), ("damping", 0.5), ("load_inertia_fraction", 0.2)];
        let effect = given("flexible_mode", &joint).unwrap();
        assert_eq!(
            (effect.effect().id(), effect.values()),
            ("flexible_mode", &[0.2, 3.0, 0.5][..])
        );
    }

    #[test]
    fn a_wrong_id_name_or_value_is_refused_and_the_message_lists_the_known_ones() {
        let unknown = given("friction", &[]).unwrap_err();
        assert!(unknown.contains("`friction`") && unknown.contains("slew_limit"), "{unknown}");
        let misspelt = given("spring", &[("stifness", 1.0)]).unwrap_err();
        assert_eq!(misspelt, "`spring` has no parameter `stifness`; it has stiffness");
        let missing = given("stribeck", &[("fs_over_fc", 2.0)]).unwrap_err();
        assert!(missing.starts_with("`stribeck` needs `stribeck_velocity`; "), "{missing}");
        let negative = given("slew_limit", &[("rate", -1.0)]).unwrap_err();
        assert_eq!(negative, "`rate` of `slew_limit` is -1: it must be finite and positive");
        assert!(given("spring", &[("stiffness", f64::NAN)]).unwrap_err().contains("finite"));
    }
}
