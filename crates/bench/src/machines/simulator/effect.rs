//! The effects beyond the base model, with their parameters.

mod known;

use std::collections::BTreeMap;

use super::outsider::Outsider;
use known::{KNOWN, Range, known_ids, known_parameters};

/// One effect with its parameters: one of those that a diagnosis can name, or an [`Outsider`].
/// Torques and friction levels are in input units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effect {
    /// Static levels above the Coulomb levels, at v = 0 only. It has no effect together with
    /// [`Effect::Presliding`], which has no sticking.
    StaticFriction {
        /// Fs⁺ ≥ Fc⁺, input units.
        fs_plus: f64,
        /// Fs⁻ ≥ Fc⁻, input units.
        fs_minus: f64,
    },
    /// f(v) = sgn(v)·Fc·[1 + (r−1)·exp(−(v/vs)²)], breakaway at the larger of r·Fc and Fs.
    Stribeck {
        /// r ≥ 1.
        fs_over_fc: f64,
        /// vs > 0, response units.
        stribeck_velocity: f64,
    },
    /// a becomes a(1+α) for v > 0 and a(1−α) for v < 0.
    ViscousAsymmetry {
        /// α in −1 … 1.
        alpha: f64,
    },
    /// A torque c·v·|v|.
    QuadraticDrag {
        /// c ≥ 0, input units per squared response unit.
        c: f64,
    },
    /// Dahl's bristle z' = v − |v|·σ·z/Fc(sgn v), f = σ·z, in place of set-valued friction.
    /// Together with [`Effect::Stribeck`] its level Fc follows the Stribeck curve.
    Presliding {
        /// σ > 0, input units/(response unit·s).
        sigma: f64,
    },
    /// All friction levels × (1 + δ·`run_share`).
    FrictionDrift {
        /// δ > −1.
        delta: f64,
    },
    /// Motor and load, inertia 1/K split (1−ρ):ρ, joined by a spring and a damper that act
    /// only while the twist is outside ± gap/2; the motor's velocity is measured.
    Backlash {
        /// ρ, between 0 and 1.
        load_inertia_fraction: f64,
        /// k > 0, input units/(response unit·s).
        stiffness: f64,
        /// c ≥ 0, input units per response unit.
        damping: f64,
        /// The whole gap, response units·s.
        gap: f64,
    },
    /// [`Effect::Backlash`] without a gap.
    FlexibleMode {
        /// ρ, between 0 and 1.
        load_inertia_fraction: f64,
        /// k > 0, input units/(response unit·s).
        stiffness: f64,
        /// c ≥ 0, input units per response unit.
        damping: f64,
    },
    /// A torque k·θ, θ = 0 at rest.
    Spring {
        /// k ≥ 0, input units/(response unit·s).
        stiffness: f64,
    },
    /// A torque k·θ + k₃·θ³, θ = 0 at rest.
    HardeningSpring {
        /// k ≥ 0, input units/(response unit·s).
        stiffness: f64,
        /// k₃ ≥ 0, input units/(response unit·s)³.
        cubic_stiffness: f64,
    },
    /// A torque T·sin(N·θ + φ), together with the constant torque that makes the mean of v
    /// zero; θ has zero mean.
    Cogging {
        /// T ≥ 0, input units.
        amplitude: f64,
        /// N > 0, rad/(response unit·s).
        cycles_per_unit: f64,
        /// φ, rad.
        phase: f64,
    },
    /// u(t − T).
    TransportDelay {
        /// T ≥ 0, s.
        delay: f64,
    },
    /// T·y' + y = v.
    SensorLag {
        /// T ≥ 0, s.
        time_constant: f64,
    },
    /// u clipped to ± limit.
    ActuatorSaturation {
        /// Limit > 0, input units.
        limit: f64,
    },
    /// u − clip(u, ± half width).
    ActuatorDeadZone {
        /// Half width ≥ 0, input units.
        half_width: f64,
    },
    /// (1+γ)u for u > 0, (1−γ)u for u < 0.
    GainAsymmetry {
        /// γ, between −1 and 1.
        gamma: f64,
    },
    /// A rate limiter in its periodic state: w' = ± rate until w meets u again, w = u while
    /// |u'| ≤ rate.
    SlewLimit {
        /// Rate > 0, input units per second.
        rate: f64,
    },
    /// An effect that no diagnosis can name.
    Outside(Outsider),
}

/// Why an effect cannot be built from its id and parameters.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EffectError {
    /// No effect has this id.
    #[error("no effect is called `{id}`; there are {}", known_ids())]
    UnknownId {
        /// The unknown id.
        id: String,
    },
    /// The effect has no such parameter.
    #[error("`{id}` has no parameter `{parameter}`; it has {}", known_parameters(id))]
    UnknownParameter {
        /// The effect.
        id: &'static str,
        /// The unknown parameter.
        parameter: String,
    },
    /// A parameter was not given.
    #[error("`{id}` needs `{parameter}`; its parameters are {}", known_parameters(id))]
    Missing {
        /// The effect.
        id: &'static str,
        /// The missing parameter.
        parameter: &'static str,
    },
    /// A parameter has an invalid value.
    #[error("`{parameter}` of `{id}` is {value}: it must be finite and {requirement}")]
    Unusable {
        /// The effect.
        id: &'static str,
        /// Its parameter.
        parameter: &'static str,
        /// The value.
        value: f64,
        /// What it must be.
        requirement: &'static str,
    },
}

impl Effect {
    /// The id of the effect, as in requests and answers.
    pub fn id(&self) -> &'static str {
        match self {
            Self::Outside(outsider) => outsider.id(),
            named => KNOWN[named.place().0].0,
        }
    }

    /// Names and values of the parameters.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        if let Self::Outside(outsider) = self {
            return outsider.parameters();
        }
        let (place, values) = self.place();
        KNOWN[place].1.iter().map(|(name, _)| *name).zip(values).collect()
    }

    /// The effect with this id and these parameters, all of which must be given.
    ///
    /// # Errors
    /// See [`EffectError`]; its messages list the known ids and parameters.
    pub fn from_parameters(
        id: &str,
        parameters: &BTreeMap<String, f64>,
    ) -> Result<Self, EffectError> {
        let Some((id, known)) = KNOWN.into_iter().find(|(known, _)| *known == id) else {
            return Err(EffectError::UnknownId { id: id.to_owned() });
        };
        let is_known = |given: &str| known.iter().any(|(name, _)| *name == given);
        if let Some(parameter) = parameters.keys().find(|given| !is_known(given)).cloned() {
            return Err(EffectError::UnknownParameter { id, parameter });
        }
        let value = |&(parameter, _): &(&'static str, Range)| {
            let given = parameters.get(parameter).copied();
            given.ok_or(EffectError::Missing { id, parameter })
        };
        let values = known.iter().map(value).collect::<Result<Vec<_>, _>>()?;
        let effect = Self::of(id, &values);
        effect.check()?;
        Ok(effect)
    }

    /// Checks that all parameters are within their ranges.
    ///
    /// # Errors
    /// [`EffectError::Unusable`] names the first parameter that is not.
    pub fn check(&self) -> Result<(), EffectError> {
        if let Self::Outside(outsider) = self {
            return outsider.unusable().map_or(Ok(()), |(parameter, value, requirement)| {
                let id = outsider.id();
                Err(EffectError::Unusable { id, parameter, value, requirement })
            });
        }
        let (place, values) = self.place();
        let (id, known) = KNOWN[place];
        match known.iter().zip(values).find(|((_, range), value)| !range.contains(*value)) {
            Some((&(parameter, range), value)) => {
                Err(EffectError::Unusable { id, parameter, value, requirement: range.words() })
            }
            None => Ok(()),
        }
    }

    /// The effect with a known id, from the values of its parameters in the order of [`KNOWN`].
    fn of(id: &str, values: &[f64]) -> Self {
        match (id, values) {
            ("static_friction", &[fs_plus, fs_minus]) => Self::StaticFriction { fs_plus, fs_minus },
            ("stribeck", &[fs_over_fc, stribeck_velocity]) => {
                Self::Stribeck { fs_over_fc, stribeck_velocity }
            }
            ("viscous_asymmetry", &[alpha]) => Self::ViscousAsymmetry { alpha },
            ("quadratic_drag", &[c]) => Self::QuadraticDrag { c },
            ("presliding", &[sigma]) => Self::Presliding { sigma },
            ("friction_drift", &[delta]) => Self::FrictionDrift { delta },
            ("backlash", &[load_inertia_fraction, stiffness, damping, gap]) => {
                Self::Backlash { load_inertia_fraction, stiffness, damping, gap }
            }
            ("flexible_mode", &[load_inertia_fraction, stiffness, damping]) => {
                Self::FlexibleMode { load_inertia_fraction, stiffness, damping }
            }
            ("spring", &[stiffness]) => Self::Spring { stiffness },
            ("hardening_spring", &[stiffness, cubic_stiffness]) => {
                Self::HardeningSpring { stiffness, cubic_stiffness }
            }
            ("cogging", &[amplitude, cycles_per_unit, phase]) => {
                Self::Cogging { amplitude, cycles_per_unit, phase }
            }
            ("transport_delay", &[delay]) => Self::TransportDelay { delay },
            ("sensor_lag", &[time_constant]) => Self::SensorLag { time_constant },
            ("actuator_saturation", &[limit]) => Self::ActuatorSaturation { limit },
            ("actuator_dead_zone", &[half_width]) => Self::ActuatorDeadZone { half_width },
            ("gain_asymmetry", &[gamma]) => Self::GainAsymmetry { gamma },
            ("slew_limit", &[rate]) => Self::SlewLimit { rate },
            _ => unreachable!("every known id has its arm: a test builds them all"),
        }
    }

    /// Index in [`KNOWN`], and the values of the parameters in its order.
    fn place(&self) -> (usize, Vec<f64>) {
        match *self {
            Self::StaticFriction { fs_plus, fs_minus } => (0, vec![fs_plus, fs_minus]),
            Self::Stribeck { fs_over_fc, stribeck_velocity } => {
                (1, vec![fs_over_fc, stribeck_velocity])
            }
            Self::ViscousAsymmetry { alpha } => (2, vec![alpha]),
            Self::QuadraticDrag { c } => (3, vec![c]),
            Self::Presliding { sigma } => (4, vec![sigma]),
            Self::FrictionDrift { delta } => (5, vec![delta]),
            Self::Backlash { load_inertia_fraction, stiffness, damping, gap } => {
                (6, vec![load_inertia_fraction, stiffness, damping, gap])
            }
            Self::FlexibleMode { load_inertia_fraction, stiffness, damping } => {
                (7, vec![load_inertia_fraction, stiffness, damping])
            }
            Self::Spring { stiffness } => (8, vec![stiffness]),
            Self::HardeningSpring { stiffness, cubic_stiffness } => {
                (9, vec![stiffness, cubic_stiffness])
            }
            Self::Cogging { amplitude, cycles_per_unit, phase } => {
                (10, vec![amplitude, cycles_per_unit, phase])
            }
            Self::TransportDelay { delay } => (11, vec![delay]),
            Self::SensorLag { time_constant } => (12, vec![time_constant]),
            Self::ActuatorSaturation { limit } => (13, vec![limit]),
            Self::ActuatorDeadZone { half_width } => (14, vec![half_width]),
            Self::GainAsymmetry { gamma } => (15, vec![gamma]),
            Self::SlewLimit { rate } => (16, vec![rate]),
            Self::Outside(_) => unreachable!("its callers ask the outsider itself"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters(given: &[(&str, f64)]) -> BTreeMap<String, f64> {
        given.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
    }

    #[test]
    fn every_known_effect_is_built_from_its_names_and_gives_them_back() {
        for (id, known) in KNOWN {
            // Different values, each within its range.
            let value = |index: usize, range: &Range| match range {
                Range::AtLeastOne => 1.5,
                _ => 0.1 + 0.1 * index as f64,
            };
            let given: Vec<(&str, f64)> = known
                .iter()
                .enumerate()
                .map(|(index, (name, range))| (*name, value(index, range)))
                .collect();
            let effect = Effect::from_parameters(id, &parameters(&given)).unwrap();
            assert_eq!((effect.id(), effect.parameters()), (id, given));
        }
    }

    #[test]
    fn what_is_wrong_is_refused_with_what_is_known() {
        let refused = |id: &str, given: &[(&str, f64)]| {
            Effect::from_parameters(id, &parameters(given)).unwrap_err().to_string()
        };
        let unknown = refused("friction", &[]);
        assert!(unknown.contains("`friction`") && unknown.contains("slew_limit"), "{unknown}");
        let misspelt = refused("spring", &[("stifness", 1.0)]);
        assert_eq!(misspelt, "`spring` has no parameter `stifness`; it has stiffness");
        let missing = refused("stribeck", &[("fs_over_fc", 2.0)]);
        assert!(missing.starts_with("`stribeck` needs `stribeck_velocity`; "), "{missing}");
        let negative = refused("slew_limit", &[("rate", -1.0)]);
        assert_eq!(negative, "`rate` of `slew_limit` is -1: it must be finite and positive");
        assert!(refused("spring", &[("stiffness", f64::NAN)]).contains("finite"));
    }
}
