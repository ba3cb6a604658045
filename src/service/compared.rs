//! A measurement beside what the models of an answer make of it.

use servoscope_core::answers::{Answer, Comparison, ConvergenceRow};
use servoscope_core::measurement::Measurement;

use crate::report::figures::{Extended, Subject};
use crate::report::with_causes;

use super::Numerics;

/// A measurement beside what the models of an answer make of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// The base model; why there is no comparison, where there is none.
    pub base: Result<Comparison, String>,
    /// The model with the causes; `None` where there is none, or no comparison.
    pub extended: Option<Comparison>,
    /// What the model with the causes is called.
    name: String,
}

impl Compared {
    /// Simulates the models of an answer on the inputs of the measurement they
    /// were fitted to. Faults of the measurement that the answer found are mended, but every row is
    /// kept. `measurement` may be why it cannot be read.
    pub fn of(
        numerics: &dyn Numerics,
        measurement: Result<&Measurement, String>,
        answer: &Answer,
    ) -> Self {
        let faults = answer.diagnosis().map_or(&[][..], |answer| &answer.measurement);
        let understood = measurement.and_then(|measurement| {
            numerics.understood(measurement, faults).map_err(|error| error.to_string())
        });
        let with = |model| {
            let measurement = understood.as_ref().map_err(String::clone)?;
            numerics.compare(measurement, model).map_err(|error| error.to_string())
        };
        let extended = answer.extended().and_then(|model| with(model).ok());
        Self { base: with(answer.base()), extended, name: with_causes(answer.causes()) }
    }

    /// What figures are drawn of.
    pub fn subject<'a>(
        &'a self,
        answer: &'a Answer,
        convergence: &'a [ConvergenceRow],
    ) -> Subject<'a> {
        let name = &self.name;
        let extended = answer.extended().zip(self.extended.as_ref());
        let extended = extended.map(|(identification, comparison)| Extended {
            name,
            identification,
            comparison,
        });
        Subject {
            comparison: self.base.as_ref().ok(),
            extended,
            convergence,
            ..Subject::of(answer)
        }
    }
}
