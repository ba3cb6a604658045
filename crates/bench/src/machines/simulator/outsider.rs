//! Effects that the library of `servoscope-core` does not contain ("outsiders").
//!
//! They test whether a diagnosis wrongly names a known effect when the true cause is unknown to it.
//! All of them occur in practice: worn oil, warm magnets, a coarse converter.

/// An effect beyond the base model that is none of the named kinds of [`super::Effect`]. Torques
/// are in input units, velocities in response units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outsider {
    /// A torque c·v³, as of a fan or turbulent oil.
    CubicDrag {
        /// c ≥ 0, input units per cubed response unit.
        c: f64,
    },
    /// The torque decreases with speed to τ/(1 + κ·v²), as in a motor with field weakening.
    FieldWeakening {
        /// κ ≥ 0, per squared response unit.
        kappa: f64,
    },
    /// All friction levels × (1 + μ·|τ|), as if the drive's torque loads a bearing.
    LoadDependentFriction {
        /// μ ≥ 0, per input unit.
        mu: f64,
    },
    /// a becomes a(1+β) for the part of |v| beyond a knee, as if a seal begins to drag.
    KinkedViscosity {
        /// β ≥ 0.
        beta: f64,
        /// The knee, response units, positive.
        knee: f64,
    },
    /// The gain of the command × (1 + δ·`run_share`), as with magnets that warm up.
    GainDrift {
        /// δ > −1.
        delta: f64,
    },
    /// a × (1 + δ·`run_share`), as with oil that warms up.
    ViscousDrift {
        /// δ > −1.
        delta: f64,
    },
    /// A sensor that reads v/√(1 + (e·v)²).
    SensorCompression {
        /// e ≥ 0, per response unit.
        e: f64,
    },
    /// The command rounded to multiples of a step by a coarse converter.
    InputQuantisation {
        /// Step > 0, input units.
        step: f64,
    },
}

impl Outsider {
    /// The name used in reports.
    pub fn id(&self) -> &'static str {
        match self {
            Self::CubicDrag { .. } => "cubic_drag",
            Self::FieldWeakening { .. } => "field_weakening",
            Self::LoadDependentFriction { .. } => "load_dependent_friction",
            Self::KinkedViscosity { .. } => "kinked_viscosity",
            Self::GainDrift { .. } => "gain_drift",
            Self::ViscousDrift { .. } => "viscous_drift",
            Self::SensorCompression { .. } => "sensor_compression",
            Self::InputQuantisation { .. } => "input_quantisation",
        }
    }

    /// Names and values of its parameters.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        match *self {
            Self::CubicDrag { c } => vec![("c", c)],
            Self::FieldWeakening { kappa } => vec![("kappa", kappa)],
            Self::LoadDependentFriction { mu } => vec![("mu", mu)],
            Self::KinkedViscosity { beta, knee } => vec![("beta", beta), ("knee", knee)],
            Self::GainDrift { delta } | Self::ViscousDrift { delta } => vec![("delta", delta)],
            Self::SensorCompression { e } => vec![("e", e)],
            Self::InputQuantisation { step } => vec![("step", step)],
        }
    }

    /// The first parameter with an invalid value, that value, and the requirement in words.
    pub(super) fn unusable(&self) -> Option<(&'static str, f64, &'static str)> {
        let requirement = |name: &str| match (self, name) {
            (_, "knee" | "step") => (f64::MIN_POSITIVE, "positive"),
            (_, "delta") => (-1.0 + f64::EPSILON, "above -1"),
            _ => (0.0, "at least 0"),
        };
        self.parameters().into_iter().find_map(|(name, value)| {
            let (least, words) = requirement(name);
            (!(value.is_finite() && value >= least)).then_some((name, value, words))
        })
    }
}

/// The outsiders that act on the mechanics behind the actuator.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct OutsideMechanics {
    cubic_drag: f64,
    weakening: f64,
    load_friction: f64,
    /// a·β/K, input units per response unit.
    kink: f64,
    knee: f64,
}

impl OutsideMechanics {
    /// `None` if no outsider acts on the mechanics. `a_over_k` is a/K, input units per response
    /// unit.
    pub(super) fn of(outsiders: impl Iterator<Item = Outsider>, a_over_k: f64) -> Option<Self> {
        let mut outside = Self::default();
        for outsider in outsiders {
            match outsider {
                Outsider::CubicDrag { c } => outside.cubic_drag = c,
                Outsider::FieldWeakening { kappa } => outside.weakening = kappa,
                Outsider::LoadDependentFriction { mu } => outside.load_friction = mu,
                Outsider::KinkedViscosity { beta, knee } => {
                    (outside.kink, outside.knee) = (a_over_k * beta, knee);
                }
                _ => {}
            }
        }
        (outside != Self::default()).then_some(outside)
    }

    /// The torque that the motor delivers at velocity v.
    pub(super) fn torque(&self, torque: f64, v: f64) -> f64 {
        torque / (1.0 + self.weakening * v * v)
    }

    /// Factor of all friction levels.
    pub(super) fn friction_factor(&self, torque: f64) -> f64 {
        1.0 + self.load_friction * torque.abs()
    }

    /// Drag torque against the motion, with the sign of v.
    pub(super) fn drag(&self, v: f64) -> f64 {
        let beyond = (v.abs() - self.knee).max(0.0).copysign(v);
        self.cubic_drag * v * v * v + self.kink * beyond
    }

    /// Largest ∂(drag)/∂v at speeds up to `speed`.
    pub(super) fn steepest(&self, speed: f64) -> f64 {
        3.0 * self.cubic_drag * speed * speed + self.kink
    }
}
