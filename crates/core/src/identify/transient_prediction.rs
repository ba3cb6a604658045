//! Simulates an identified model along a measured motion that does not repeat.
//!
//! If the upload does not state the initial state, it is estimated from a first stretch of the
//! record (`beginning`). That stretch is not compared, so that nothing that is compared was used in
//! the estimate.

mod beginning;
mod first_samples;

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

/// Smallest and largest share of a motion that serves to estimate its initial state (tuned).
const FITTED_SHARE: [f64; 2] = [0.1, 0.3];

/// Length of that stretch, in time constants of the mechanics, within the limits of
/// [`FITTED_SHARE`]. After three time constants the initial velocity has decayed to 5 %.
const TIME_CONSTANTS: f64 = 3.0;

/// Fewest samples from which an initial state is estimated (tuned); below it the axis begins at
/// rest.
const FEWEST_SAMPLES: usize = 8;

/// One motion, measured and simulated, from the first compared sample on.
#[derive(Debug, Clone, PartialEq)]
pub struct Followed {
    /// Index of the first sample that is compared.
    pub first: usize,
    /// The measured response; for a position or an acceleration, less its mean.
    pub measured: Vec<f64>,
    /// The simulated response, likewise.
    pub simulated: Vec<f64>,
    /// Whether the upload states how the motion begins.
    pub given: bool,
    /// The estimated initial state; empty if the axis begins at rest or as given.
    pub beginning: Vec<Begun>,
}

/// Seconds at the beginning of a motion that are not compared, for a base model.
///
/// # Errors
/// [`IdentifyError::Unusable`] if the answer lacks a parameter of its model.
pub fn unscored_s(transient: &Transient, base: &Identification) -> Result<f64, IdentifyError> {
    let Beginning { velocity, settle_s, .. } = transient.beginning;
    let plant = reported_plant(base)?;
    let [least, most] = FITTED_SHARE.map(|share| share * transient.duration_s());
    Ok(settle_s.unwrap_or(match velocity {
        Some(_) => 0.0,
        None => (TIME_CONSTANTS / plant.viscous_rate_rad_s).clamp(least, most),
    }))
}

/// Simulates the model of a stored answer along every motion of a measurement. `unscored_s` holds,
/// for each motion, the seconds at its beginning that are not compared.
///
/// # Errors
/// [`IdentifyError::Unusable`] if the answer lacks a parameter of its model.
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

/// A model, and the motion that it is compared with.
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
        if !given && first >= FEWEST_SAMPLES {
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

    /// The simulated response over the first `count` samples.
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

    /// Removes the mean of a position or an acceleration, whose harmonic 0 is not compared either.
    fn compared(&self, response: &[f64]) -> Vec<f64> {
        let mean = match self.kind {
            ResponseKind::Velocity => 0.0,
            _ => response.iter().sum::<f64>() / response.len() as f64,
        };
        response.iter().map(|y| y - mean).collect()
    }
}
