//! A plan of experiments, and what it is made from.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::{EffectSize, Identification};

/// A rough idea of an axis. The names and signs are those of identified parameters.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct RoughAxis {
    /// Pole −a of the mechanics, rad/s; negative.
    #[cfg_attr(feature = "openapi", schema(exclusive_maximum = 0.0))]
    pub pole: f64,
    /// Constant K, velocity units per input unit and second.
    pub constant: f64,
    /// Dry friction while the velocity is positive, input units.
    #[cfg_attr(feature = "openapi", schema(minimum = 0.0))]
    pub fc_plus: f64,
    /// Dry friction while the velocity is negative, input units.
    #[cfg_attr(feature = "openapi", schema(minimum = 0.0))]
    pub fc_minus: f64,
    /// Pole −p of an actuator of first order, rad/s; negative.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(exclusive_maximum = 0.0))]
    pub actuator_pole: Option<f64>,
    /// Natural frequency of an actuator of second order, rad/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0))]
    pub natural_frequency: Option<f64>,
    /// Damping ratio of that actuator.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0))]
    pub damping_ratio: Option<f64>,
}

/// What a plan is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(deny_unknown_fields)]
pub struct PlanRequest {
    /// A rough idea of the axis.
    pub axis: RoughAxis,
    /// Time that the experiments may take in all, settling included, s.
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0))]
    pub budget_s: f64,
    /// Limits, noise and seed.
    #[serde(default)]
    pub options: PlanOptions,
}

/// Limits, noise and seed of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(default, deny_unknown_fields)]
pub struct PlanOptions {
    /// Relative standard deviation of each parameter of the axis (log-normal), above 0 and at most 1.
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0, maximum = 1.0))]
    pub uncertainty: f64,
    /// Largest magnitude of the input, input units. Default: 8 times the larger friction level.
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0))]
    pub largest_magnitude: Option<f64>,
    /// Lowest frequency, rad/s. Default: 0.15 a.
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0))]
    pub lowest_rad_s: Option<f64>,
    /// Highest frequency, rad/s. Default: 10 a; with an actuator of second order 2.5 times its natural
    /// frequency.
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0))]
    pub highest_rad_s: Option<f64>,
    /// Largest velocity that is allowed, velocity units. Default: any.
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0))]
    pub largest_velocity: Option<f64>,
    /// Largest distance from the middle of the travel that is allowed, velocity units times second.
    /// Default: any.
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0))]
    pub largest_travel: Option<f64>,
    /// Additive noise: the standard deviation of re and im of a harmonic that is measured for one second,
    /// velocity units. It falls as 1/√time. Default: a thousandth of the response to a middle magnitude
    /// at the pole's frequency, when that is measured for 10/a.
    #[cfg_attr(feature = "openapi", schema(exclusive_minimum = 0.0))]
    pub noise_std: Option<f64>,
    /// Proportional noise: the standard deviation of re and im of a harmonic in one repeat, as a share
    /// of its size.
    #[cfg_attr(feature = "openapi", schema(minimum = 0.0, exclusive_maximum = 1.0))]
    pub noise_share: f64,
    /// Seed of the axes that are drawn and of the order.
    pub seed: u64,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            uncertainty: 0.25,
            largest_magnitude: None,
            lowest_rad_s: None,
            highest_rad_s: None,
            largest_velocity: None,
            largest_travel: None,
            noise_std: None,
            noise_share: 0.0,
            seed: 1,
        }
    }
}

impl RoughAxis {
    /// The axis of an identification.
    ///
    /// # Errors
    /// The name of the first parameter that the measurement did not determine.
    pub fn of(answer: &Identification) -> Result<Self, &'static str> {
        let value = |name: &str| answer.parameters.get(name).and_then(|found| found.value);
        let needed = |name: &'static str| value(name).ok_or(name);
        Ok(Self {
            pole: needed("pole")?,
            constant: needed("constant")?,
            fc_plus: needed("fc_plus")?,
            fc_minus: needed("fc_minus")?,
            actuator_pole: value("actuator_pole"),
            natural_frequency: value("natural_frequency"),
            damping_ratio: value("damping_ratio"),
        })
    }
}

/// A plan of experiments, what it can show, and how that compares with sweeps of the same duration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Plan {
    /// Version of the software that made it.
    pub software_version: String,
    /// What was asked for, every default filled in.
    pub request: PlanRequest,
    /// The experiments in the order in which they are to be made.
    pub experiments: Vec<PlannedExperiment>,
    /// Duration of all experiments, s.
    pub duration_s: f64,
    /// Highest harmonic that is to be measured.
    pub harmonics: usize,
    /// Mean over the effects of the probability that one is named, at sizes log-uniform from a thirtieth of
    /// the typical size up to it. The plan maximises it.
    pub score: f64,
    /// Predicted by a linearisation: how many effects are named with a probability of 0.9 or more at their typical size.
    pub nameable: usize,
    /// Every effect of the library.
    pub effects: Vec<PlannedEffect>,
    /// Logarithmic sweeps of at most the same duration: at the largest magnitude alone, and at three.
    pub sweeps: Vec<PlannedSweep>,
    /// Sentences for the reader: what was assumed, and what limits the plan.
    pub notes: Vec<String>,
}

/// One experiment of a plan: a cosine input.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct PlannedExperiment {
    /// Position in the order of acquisition, from 0.
    pub run: usize,
    /// Magnitude of the input, input units.
    pub magnitude: f64,
    /// Frequency, rad/s.
    pub omega_rad_s: f64,
    /// Periods to wait until the response has settled.
    pub settle_periods: usize,
    /// Periods of one repeat.
    pub measured_periods: usize,
    /// Repeats, one after the other without settling again.
    pub repeats: usize,
    /// Duration with settling, s.
    pub duration_s: f64,
    /// The effect whose score falls most if this experiment is left out; null if none falls.
    pub serves: Option<String>,
}

/// What a plan shows of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct PlannedEffect {
    /// Its id.
    pub effect: String,
    /// Its name.
    pub title: String,
    /// A typical size of it in this axis.
    pub typical: EffectSize,
    /// The smallest size that is noticed: the base model, refitted, would leave an excess χ² of 120;
    /// null if none of a plausible size is.
    pub noticed_from: Option<EffectSize>,
    /// The smallest size at which the best imitation would leave that excess; null if there is none.
    pub named_from: Option<EffectSize>,
    /// The effect that resembles it most in these experiments.
    pub closest_imitator: Option<String>,
    /// Probability that an effect of typical size is detected (√Δχ² above √30) and told from every
    /// other one.
    pub probability: f64,
    /// Mean of that probability over sizes log-uniform from a thirtieth of the typical size up to it.
    pub score: f64,
}

/// A logarithmic sweep to compare a plan with.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct PlannedSweep {
    /// Its magnitudes, input units, ascending; measured one after the other.
    pub magnitudes: Vec<f64>,
    /// Its frequencies, ascending at each magnitude, rad/s.
    pub frequencies_rad_s: Vec<f64>,
    /// Fewest repeats of a point. The first points have more where the rest of the time pays for it.
    pub repeats: usize,
    /// Its duration, s.
    pub duration_s: f64,
    /// Mean probability over all effects, at sizes up to the typical one.
    pub score: f64,
    /// Number of effects with a probability of 0.9 or more at their typical size.
    pub nameable: usize,
    /// Probability that each effect is detected and told apart, by id.
    pub probabilities: IndexMap<String, f64>,
    /// The experiments in their order, so that the sweep can be made.
    pub experiments: Vec<PlannedExperiment>,
}
