//! What a parameter of a machine must be.

/// What a parameter must be; it is finite in any case.
#[derive(Debug, Clone, Copy)]
pub enum Requirement {
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

impl Requirement {
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
