//! The motion of an identified model beside a measured one that does not repeat.
//!
//! Where the upload does not say how the motion begins, the initial state is estimated from a first
//! stretch (`beginning`). That stretch is not compared, so that nothing compared was fitted.

mod beginning;

use crate::answers::{Identification, Unanswered};
use crate::effects::ActiveEffect;
use crate::measurement::{Beginning, Measurement, ResponseKind, Transient};
use crate::plant::Plant;
use crate::simulate;
use crate::simulate::{InitialState, NoResponse, SampledInput};

use super::prediction::{reported_effects, reported_plant};
use super::problem::Scales;
use super::request::IdentifyError;
pub use beginning::Begun;

/// Share of a motion that tells how it begins, at least and at most.
const STRETCH: [f64; 2] = [0.1, 0.3];

/// Time constants of the mechanics that it lasts, within these bounds: after them nothing is
/// left of the first velocity.
const TIME_CONSTANTS: f64 = 3.0;

/// Samples of a stretch that tells anything.
const FEWEST: usize = 8;

/// One motion and what a model makes of it, from where they are compared on.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// First sample that is compared.
    pub first: usize,
    /// As measured; of a position or an acceleration what differs from its mean.
    pub measured: Vec<f64>,
    /// As simulated, likewise.
    pub simulated: Vec<f64>,
    /// Whether it is said how the motion begins.
    pub given: bool,
    /// What it begins with beyond rest.
    pub beginning: Vec<Begun>,
}

/// Seconds at the beginning of a motion that are not compared, for a base model.
///
/// # Errors
/// [`IdentifyError::Unusable`] where the answer lacks a parameter of its model.
pub fn unscored_s(transient: &Transient, base: &Identification) -> Result<f64, IdentifyError> {
    let Beginning { velocity, settle_s, .. } = transient.beginning;
    let plant = reported_plant(base)?;
    let [least, most] = STRETCH.map(|share| share * transient.duration_s());
    Ok(settle_s.unwrap_or(match velocity {
        Some(_) => 0.0,
        None => (TIME_CONSTANTS / plant.viscous_rate_rad_s).clamp(least, most),
    }))
}

/// Follows every motion of a measurement with the model of a stored answer; `unscored_s` says
/// of each how many seconds are not compared.
///
/// # Errors
/// [`IdentifyError::Unusable`] where the answer lacks a parameter of its model.
pub fn follow(
    measurement: &Measurement,
    answer: &Identification,
    unscored_s: &[f64],
) -> Result<Vec<Result<Followed, Unanswered>>, IdentifyError> {
    let plant = reported_plant(answer)?;
    let units = Scales { omega: 1.0, input: 1.0, velocity: 1.0 };
    let effects = reported_effects(answer, units)?;
    let [from, to] = measurement.acquisition().unwrap_or_default();
    let all = measurement.transients().iter().zip(unscored_s).enumerate();
    let followed = all.map(|(experiment, (transient, unscored_s))| {
        let run =
            transient.run.map_or(0.0, |run| (run - from) / (to - from).max(f64::MIN_POSITIVE));
        let kind = measurement.metadata().response_kind;
        let model = Model { plant: &plant, effects: &effects, run_share: run, kind, transient };
        let followed = model.followed(*unscored_s);
        followed.map_err(|error| Unanswered {
            experiment,
            magnitude: None,
            omega_rad_s: None,
            reason: error.to_string(),
        })
    });
    Ok(followed.collect())
}

/// A model and the motion that it is to follow.
struct Model<'a> {
    plant: &'a Plant,
    effects: &'a [ActiveEffect],
    run_share: f64,
    kind: ResponseKind,
    transient: &'a Transient,
}

impl Model<'_> {
    fn followed(&self, unscored_s: f64) -> Result<Followed, NoResponse> {
        let Transient { input, output, beginning, step_s, .. } = self.transient;
        let first = ((unscored_s / step_s).ceil() as usize).min(output.len() - 1);
        let given = beginning.velocity.is_some();
        let mut initial = InitialState {
            velocity: beginning.velocity.unwrap_or(0.0),
            position: beginning.position.unwrap_or(0.0),
            ..InitialState::default()
        };
        let mut found = Vec::new();
        if !given && first >= FEWEST {
            (initial, found) = self.estimated(initial, first)?;
        }
        let simulated = self.response(input.len(), &initial)?;
        Ok(Followed {
            first,
            measured: self.compared(&output[first..]),
            simulated: self.compared(&simulated[first..]),
            given,
            beginning: found,
        })
    }

    /// The response over the first `count` samples.
    fn response(&self, count: usize, initial: &InitialState) -> Result<Vec<f64>, NoResponse> {
        let Transient { input, step_s, intersample, .. } = self.transient;
        let input =
            SampledInput { step_s: *step_s, values: &input[..count], between: *intersample };
        let motion = simulate::follow(self.plant, self.effects, self.run_share, &input, initial)?;
        Ok(match self.kind {
            ResponseKind::Velocity => motion.velocity,
            ResponseKind::Position => motion.position,
            ResponseKind::Acceleration => motion.acceleration,
        })
    }

    /// What is compared: of a position or an acceleration, as of their harmonics, no mean.
    fn compared(&self, response: &[f64]) -> Vec<f64> {
        let mean = match self.kind {
            ResponseKind::Velocity => 0.0,
            _ => response.iter().sum::<f64>() / response.len() as f64,
        };
        response.iter().map(|y| y - mean).collect()
    }
}
