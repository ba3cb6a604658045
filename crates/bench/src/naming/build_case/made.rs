//! A draw with its measurement and its true values.

use indexmap::IndexMap;
use serde::Serialize;
use servoscope_core::diagnose::DiagnoseError;
use servoscope_core::measurement::{Measurement, Record};
use servoscope_core::plant::{Actuator, Plant};

use super::MOST_ATTEMPTS;
use crate::machines::draw::{Draw, DrawError};
use crate::machines::noise::NoiseLaw;
use crate::machines::simulator::{Effect, Settings};
use crate::naming::dominance::Dominance;
use crate::naming::instrument::Instrument;
use crate::naming::mismeasurement::Mistake;
use crate::naming::rivals::{Nearest, Rivals};

/// An effect hidden in a machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hidden {
    /// Id of the effect or outsider.
    pub effect: &'static str,
    /// Its parameters by name.
    pub parameters: IndexMap<&'static str, f64>,
    /// Excess of the base model; in a pair, excess of the best fit with the other effect alone. In a
    /// machine with small effects, excess of the base model if the effect were alone in it.
    pub excess: f64,
    /// Whether it is one of the small effects beside dominant ones.
    pub small: bool,
}

impl Hidden {
    pub(in crate::naming) fn of(effect: &Effect, excess: f64) -> Self {
        let parameters = effect.parameters().into_iter().collect();
        Self { effect: effect.id(), parameters, excess, small: false }
    }
}

/// A draw with its measurement and its true values.
#[derive(Debug, Clone, PartialEq)]
pub struct Made {
    /// The hidden effects; empty for a clean draw.
    pub hidden: Vec<Hidden>,
    /// Excess of the base model of the true order; 0 if nothing is hidden.
    pub excess: f64,
    /// What the dominant effects make and leave of it, if there are small ones beside them.
    pub dominance: Option<Dominance>,
    /// True parameters of the plant by the names used in answers.
    pub plant: IndexMap<&'static str, f64>,
    /// The machine and the design of its measurement.
    pub machine: Draw,
    /// How it is measured.
    pub instrument: Instrument,
    /// The law of its noise.
    pub noise: NoiseLaw,
    /// The measurement for the diagnosis.
    pub measurement: Measurement,
    /// The samples of each of its experiments without the fault, if it is recorded.
    pub records: Vec<Record>,
    /// The fault of that measurement, if it has one.
    pub mistake: Option<Mistake>,
    /// Number of attempts, including this one.
    pub attempts: usize,
}

impl Made {
    /// Whether an effect is hidden in the machine.
    pub fn hides(&self, effect: &str) -> bool {
        self.hidden.iter().any(|hidden| hidden.effect == effect)
    }

    /// The table without noise, which states the noise that the measurement has; of a record, what a table
    /// of the same points would be.
    ///
    /// # Errors
    /// See [`DrawError`].
    pub fn exact(&self) -> Result<Measurement, DrawError> {
        self.instrument.responses(&self.machine, &Settings::default())?.stating(&self.noise)
    }

    /// The effect of the library that alone imitates the single hidden one best; `None` unless
    /// exactly one effect is hidden.
    ///
    /// # Errors
    /// See [`MakeError`].
    pub fn nearest_rival(&self) -> Result<Option<Nearest>, MakeError> {
        let [hidden] = self.hidden.as_slice() else { return Ok(None) };
        let rivals = Rivals::ask(&self.exact()?, self.machine.plant.actuator.order())?;
        Ok(rivals.nearest_to(hidden.effect))
    }
}

/// Why a draw cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MakeError {
    /// The observer asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// No attempt met the conditions.
    #[error("none of {MOST_ATTEMPTS} machines and shapes has the wanted excess")]
    Unreachable,
    /// The candidate needed to judge whether an effect is detectable, or an outsider imitated, is
    /// missing.
    #[error("the diagnosis of the noise-free response has no candidate `{effect}` to judge it by")]
    Unjudged {
        /// The missing candidate.
        effect: String,
    },
    /// The diagnosis of the noise-free response failed.
    #[error(transparent)]
    Diagnose(#[from] DiagnoseError),
    /// The machine has no measurement.
    #[error(transparent)]
    Draw(#[from] DrawError),
}

/// Parameters of a plant by the names used in answers.
pub(in crate::naming) fn truth(plant: &Plant) -> IndexMap<&'static str, f64> {
    let (a, k) = (plant.viscous_rate_rad_s, plant.constant);
    let mut truth = IndexMap::from([
        ("pole", -a),
        ("constant", k),
        ("dc_gain", k / a),
        ("fc_plus", plant.friction.fc_plus),
        ("fc_minus", plant.friction.fc_minus),
    ]);
    match plant.actuator {
        Actuator::Direct => {}
        Actuator::FirstOrder { corner_rad_s } => {
            truth.insert("actuator_pole", -corner_rad_s);
        }
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            truth.insert("natural_frequency", natural_frequency_rad_s);
            truth.insert("damping_ratio", damping_ratio);
        }
    }
    truth
}
