//! What an effect's parameters are, and where the data says they can lie.

use crate::plant::Plant;

/// A physical dimension as powers of the upload's units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimension {
    /// Power of the input's unit.
    pub input: i8,
    /// Power of the velocity's unit.
    pub velocity: i8,
    /// Power of the second.
    pub time: i8,
}

impl Dimension {
    /// A pure number.
    pub const NONE: Self = Self { input: 0, velocity: 0, time: 0 };
    /// Input units, such as a torque or a friction level.
    pub const INPUT: Self = Self { input: 1, ..Self::NONE };
    /// Velocity units.
    pub const VELOCITY: Self = Self { velocity: 1, ..Self::NONE };
    /// Velocity units times second.
    pub const POSITION: Self = Self { velocity: 1, time: 1, ..Self::NONE };
    /// Seconds.
    pub const TIME: Self = Self { time: 1, ..Self::NONE };

    /// The dimension of a quotient.
    pub const fn per(self, other: Self) -> Self {
        Self {
            input: self.input - other.input,
            velocity: self.velocity - other.velocity,
            time: self.time - other.time,
        }
    }

    /// Factor to units in which one input unit, one velocity unit and one
    /// second are as large as given.
    pub fn factor(self, input: f64, velocity: f64, second: f64) -> f64 {
        input.powi(self.input.into())
            * velocity.powi(self.velocity.into())
            * second.powi(self.time.into())
    }
}

/// Values that a parameter may have by its definition (contract, section 3); all are finite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Domain {
    /// Any number.
    Any,
    /// Above 0.
    Positive,
    /// 0 or more.
    NotNegative,
    /// 1 or more.
    AtLeastOne,
    /// Above −1.
    AboveMinusOne,
    /// Between −1 and 1.
    BelowOneInSize,
    /// Between 0 and 1.
    Share,
}

impl Domain {
    /// Whether a parameter may have this value.
    pub fn holds(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::Positive => value > 0.0,
                Self::NotNegative => value >= 0.0,
                Self::AtLeastOne => value >= 1.0,
                Self::AboveMinusOne => value > -1.0,
                Self::BelowOneInSize => value.abs() < 1.0,
                Self::Share => value > 0.0 && value < 1.0,
            }
    }

    /// The same in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Any => "a number",
            Self::Positive => "positive",
            Self::NotNegative => "at least 0",
            Self::AtLeastOne => "at least 1",
            Self::AboveMinusOne => "above -1",
            Self::BelowOneInSize => "between -1 and 1",
            Self::Share => "between 0 and 1",
        }
    }
}

/// How a parameter is searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// As it is: 0 or either sign is possible.
    Linear,
    /// As it is, in radians: a turn more is the same.
    Angle,
    /// As its logarithm: positive, and its order of magnitude is unknown.
    Logarithmic,
}

/// What the data and the base model say about scales.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scope {
    /// The base model, as fitted.
    pub plant: Plant,
    /// Lowest frequency excited and observed, rad/s.
    pub omega_low: f64,
    /// Highest such frequency, rad/s.
    pub omega_high: f64,
    /// Smallest input amplitude at which the axis moved, input units.
    pub moving_level: f64,
    /// Largest input amplitude, input units.
    pub largest_level: f64,
    /// Largest velocity amplitude, velocity units.
    pub largest_velocity: f64,
    /// Largest position amplitude, velocity units times second.
    pub largest_travel: f64,
}

impl Scope {
    /// Mean Coulomb level, at least a thousandth of the largest input.
    pub fn friction_level(&self) -> f64 {
        let friction = self.plant.friction;
        (0.5 * (friction.fc_plus + friction.fc_minus)).max(1e-3 * self.largest_level)
    }
}

/// Where a parameter can lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// What is possible at all.
    pub bounds: [f64; 2],
    /// Where a search looks first.
    pub likely: [f64; 2],
    /// The value at which the effect vanishes whatever its other parameters
    /// are, perhaps infinite; `None` where no value of this one does that.
    pub absent: Option<f64>,
}

impl Range {
    /// Prior density at a positive value that may be smaller than is likely, as a share of that
    /// within: what is ten times smaller is ten times as rare.
    pub fn share_of_small(&self, value: f64) -> f64 {
        (value / self.likely[0]).min(1.0)
    }
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Its name on the wire.
    pub name: &'static str,
    /// Its name in a sentence or a table.
    pub title: &'static str,
    /// Its symbol and subscript in the equation of the effect.
    pub symbol: [&'static str; 2],
    /// Its unit.
    pub dimension: Dimension,
    /// Values that it may have by its definition.
    pub domain: Domain,
    /// How it is searched.
    pub coordinate: Coordinate,
    /// Where it can lie, given what the data says.
    pub range: fn(&Scope) -> Range,
}

impl Parameter {
    /// Whether it means the same as another effect's.
    pub fn is_same(&self, other: &Self) -> bool {
        (self.name, self.dimension, self.coordinate)
            == (other.name, other.dimension, other.coordinate)
    }
}
