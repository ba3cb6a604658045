//! What a measurement says before it is diagnosed, and what it can show.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::NoiseSource;

/// A measurement looked at before anything is diagnosed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Inspection {
    /// What looks wrong with the measurement; empty if nothing does.
    pub doubts: Vec<ReadingDoubt>,
    /// Which effects the measurement can show; null where the base model cannot be fitted to it.
    pub detectability: Option<Detectability>,
    /// Why the base model cannot be fitted; null where it can.
    pub obstacle: Option<String>,
}

/// Something that looks wrong with a measurement.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ReadingDoubt {
    /// Name of the check: `one_direction`, `rising_phase`, `position_as_velocity`, `closed_loop` or
    /// `amplitude`.
    pub check: String,
    /// What the data show.
    pub sentence: String,
    /// What to do about it.
    pub remedy: String,
}

/// Which effects a measurement can show, at which size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Detectability {
    /// Where the standard deviations come from; `estimated`: from what the base model leaves, so that
    /// an effect in the data counts as noise.
    pub noise: NoiseSource,
    /// What the base model leaves of the response (NRMSE).
    pub nrmse: f64,
    /// χ² of the base model per degree of freedom; null if the noise is not known. Well above 1: there
    /// is something to diagnose.
    pub chi2_per_dof: Option<f64>,
    /// The excess χ² from which an effect counts as detectable (contract, section 2).
    pub least_excess: f64,
    /// Every effect of the library.
    pub effects: Vec<DetectableEffect>,
}

/// From which size a measurement shows an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct DetectableEffect {
    /// Its id.
    pub effect: String,
    /// Its name.
    pub title: String,
    /// The smallest size at which the base model, refitted, would be seen to be wrong; null if it is
    /// not seen at any plausible size.
    pub detected_from: Option<EffectSize>,
    /// The smallest size at which no other effect of the library would explain it; null if there is
    /// none.
    pub named_from: Option<EffectSize>,
    /// The effect that resembles it most in this measurement; null if it is not seen.
    pub closest_imitator: Option<String>,
    /// Why it is not seen; null if it is.
    pub reason: Option<String>,
}

/// An effect of a certain size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct EffectSize {
    /// All its parameters.
    pub parameters: IndexMap<String, SizedParameter>,
    /// Names of those that set its size; the others have typical values for the machine.
    pub set_by: Vec<String>,
    /// How much it changes the response, relative to the response (rms over all that is compared).
    pub change: f64,
}

/// The value of one parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct SizedParameter {
    /// Value.
    pub value: f64,
    /// Unit; empty for a pure number.
    pub unit: String,
}
