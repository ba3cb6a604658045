//! Ids and parameters of the effects that a diagnosis can name.

/// Allowed range of a parameter.
#[derive(Debug, Clone, Copy)]
pub(super) enum Range {
    Any,
    Positive,
    NotNegative,
    AtLeastOne,
    AboveMinusOne,
    BelowOneInSize,
    Share,
}

impl Range {
    /// Whether a value is within the range.
    pub(super) fn contains(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Range::Any => true,
                Range::Positive => value > 0.0,
                Range::NotNegative => value >= 0.0,
                Range::AtLeastOne => value >= 1.0,
                Range::AboveMinusOne => value > -1.0,
                Range::BelowOneInSize => value.abs() < 1.0,
                Range::Share => value > 0.0 && value < 1.0,
            }
    }

    /// The range in words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Range::Any => "a number",
            Range::Positive => "positive",
            Range::NotNegative => "at least 0",
            Range::AtLeastOne => "at least 1",
            Range::AboveMinusOne => "above -1",
            Range::BelowOneInSize => "between -1 and 1",
            Range::Share => "between 0 and 1",
        }
    }
}

const LOAD: (&str, Range) = ("load_inertia_fraction", Range::Share);
const JOINT: (&str, Range) = ("stiffness", Range::Positive);
const DAMPING: (&str, Range) = ("damping", Range::NotNegative);
const SPRING: (&str, Range) = ("stiffness", Range::NotNegative);

/// The id of every effect, with the names and ranges of its parameters.
pub(super) const KNOWN: [(&str, &[(&str, Range)]); 17] = [
    ("static_friction", &[("fs_plus", Range::NotNegative), ("fs_minus", Range::NotNegative)]),
    ("stribeck", &[("fs_over_fc", Range::AtLeastOne), ("stribeck_velocity", Range::Positive)]),
    ("viscous_asymmetry", &[("alpha", Range::BelowOneInSize)]),
    ("quadratic_drag", &[("c", Range::NotNegative)]),
    ("presliding", &[("sigma", Range::Positive)]),
    ("friction_drift", &[("delta", Range::AboveMinusOne)]),
    ("backlash", &[LOAD, JOINT, DAMPING, ("gap", Range::NotNegative)]),
    ("flexible_mode", &[LOAD, JOINT, DAMPING]),
    ("spring", &[SPRING]),
    ("hardening_spring", &[SPRING, ("cubic_stiffness", Range::NotNegative)]),
    (
        "cogging",
        &[
            ("amplitude", Range::NotNegative),
            ("cycles_per_unit", Range::Positive),
            ("phase", Range::Any),
        ],
    ),
    ("transport_delay", &[("delay", Range::NotNegative)]),
    ("sensor_lag", &[("time_constant", Range::NotNegative)]),
    ("actuator_saturation", &[("limit", Range::Positive)]),
    ("actuator_dead_zone", &[("half_width", Range::NotNegative)]),
    ("gain_asymmetry", &[("gamma", Range::BelowOneInSize)]),
    ("slew_limit", &[("rate", Range::Positive)]),
];

/// List of the known ids, for messages.
pub(super) fn known_ids() -> String {
    KNOWN.map(|(id, _)| id).join(", ")
}

/// List of the parameters of an effect, for messages.
pub(super) fn known_parameters(id: &str) -> String {
    let known = KNOWN.iter().find(|(known, _)| *known == id);
    let names = known.map(|(_, parameters)| parameters.iter().map(|(name, _)| *name));
    names.into_iter().flatten().collect::<Vec<_>>().join(", ")
}
