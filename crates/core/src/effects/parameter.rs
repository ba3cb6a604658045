//! The parameters of effects: names, dimensions, admissible values and search ranges.

use crate::plant::Plant;

/// A physical dimension, as powers of the units of the upload.
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

    /// The dimension of the quotient `self`/`other`.
    pub const fn per(self, other: Self) -> Self {
        Self {
            input: self.input - other.input,
            velocity: self.velocity - other.velocity,
            time: self.time - other.time,
        }
    }

    /// Factor from scaled units to units of the upload, where the scaled units of input, velocity
    /// and time are `input`, `velocity` and `second` units of the upload.
    pub fn factor(self, input: f64, velocity: f64, second: f64) -> f64 {
        input.powi(self.input.into())
            * velocity.powi(self.velocity.into())
            * second.powi(self.time.into())
    }
}

/// The set of finite values that the definition of a parameter admits (contract, section 3).
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
    /// Above −1 and below 1.
    BelowOneInSize,
    /// Above 0 and below 1.
    Share,
}

impl Domain {
    /// Whether this value is admissible.
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

    /// The condition in words, for error messages.
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

/// The coordinate in which a parameter is searched and fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// The value itself: 0 or both signs are possible.
    Linear,
    /// The value itself, in radians: angles that differ by 2π are equivalent.
    Angle,
    /// The logarithm: the value is positive and its order of magnitude unknown.
    Logarithmic,
}

/// Scales of the data and of the base model, from which ranges follow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scope {
    /// The fitted base model.
    pub plant: Plant,
    /// Lowest frequency that was excited and observed, rad/s.
    pub omega_low: f64,
    /// Highest such frequency, rad/s.
    pub omega_high: f64,
    /// Whether an input has several lines, so that a resonance may serve a few of them and nothing else.
    pub has_spectra: bool,
    /// Smallest peak input at which the axis moved, input units.
    pub moving_level: f64,
    /// Largest peak input, input units.
    pub largest_level: f64,
    /// Largest rate of change of the input within the band, input units per second.
    pub steepest_input: f64,
    /// Largest velocity amplitude of any harmonic, velocity units.
    pub largest_velocity: f64,
    /// Largest position amplitude of any harmonic, velocity units times second.
    pub largest_travel: f64,
}

impl Scope {
    /// Mean of Fc⁺ and Fc⁻, but at least a thousandth of the largest input.
    pub fn friction_level(&self) -> f64 {
        let friction = self.plant.friction;
        (0.5 * (friction.fc_plus + friction.fc_minus)).max(1e-3 * self.largest_level)
    }
}

/// Where a parameter can lie in a given measurement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Hard bounds of a fit.
    pub bounds: [f64; 2],
    /// The search range: starting points lie in it, and it sets the width of the prior.
    pub likely: [f64; 2],
    /// The value, possibly infinite, at which the effect vanishes whatever the other parameters
    /// are; `None` if there is none.
    pub absent: Option<f64>,
}

impl Range {
    /// Prior density at a positive value, relative to the density in the likely range. Below the
    /// likely range it is proportional to the value.
    pub fn share_of_small(&self, value: f64) -> f64 {
        (value / self.likely[0]).min(1.0)
    }
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Name in the API.
    pub name: &'static str,
    /// Name in a sentence or a table.
    pub title: &'static str,
    /// Symbol and subscript.
    pub symbol: [&'static str; 2],
    /// Its dimension.
    pub dimension: Dimension,
    /// The values that its definition admits.
    pub domain: Domain,
    /// The coordinate in which it is searched.
    pub coordinate: Coordinate,
    /// Where it can lie in a measurement.
    pub range: fn(&Scope) -> Range,
}

impl Parameter {
    /// Whether it means the same as another effect's: name, dimension and coordinate are equal.
    pub fn is_same(&self, other: &Self) -> bool {
        (self.name, self.dimension, self.coordinate)
            == (other.name, other.dimension, other.coordinate)
    }
}
