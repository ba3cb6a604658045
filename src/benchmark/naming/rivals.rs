//! How well a single effect of the library explains a noise-free response.

use crate::answers::{Candidate, IdentifyOptions, PlantRequest};
use crate::diagnose::{DiagnoseError, diagnose};
use crate::identify::IdentifyRequest;
use crate::measurement::Measurement;
use crate::observer::Silent;

/// The candidates of a diagnosis of a noise-free response, with the cost of the base model
/// that they extend.
#[derive(Debug, Clone, PartialEq)]
pub struct Rivals {
    base: f64,
    candidates: Vec<Candidate>,
}

impl Rivals {
    /// Asks what each effect alone makes of a noise-free response that tells the deviation
    /// of its noise.
    ///
    /// # Errors
    /// See [`DiagnoseError`].
    pub fn ask(exact: &Measurement, order: u8) -> Result<Self, DiagnoseError> {
        let plant = Some(PlantRequest { actuator_order: order });
        let options = IdentifyOptions { most_effects: 1, ..IdentifyOptions::default() };
        let request = IdentifyRequest { plant, options, ..IdentifyRequest::default() };
        let answer = diagnose(exact, &request, &Silent)?;
        Ok(Self { base: answer.base.fit.chi2.unwrap_or(f64::NAN), candidates: answer.candidates })
    }

    /// Excess χ² of the best fit with this effect alone; `None` where it was not tried.
    pub fn excess_with(&self, effect: &str) -> Option<f64> {
        let of_effect = |candidate: &&Candidate| candidate.effect == effect;
        self.alone().filter(of_effect).map(|candidate| candidate.cost).reduce(f64::min)
    }

    /// The effect that alone explains most, and its excess; `None` where none was tried.
    pub fn nearest(&self) -> Option<(&str, f64)> {
        self.alone()
            .map(|candidate| (candidate.effect.as_str(), candidate.cost))
            .min_by(|left, right| left.1.total_cmp(&right.1))
    }

    /// Every effect alone beside the base model, where costs are χ².
    fn alone(&self) -> impl Iterator<Item = &Candidate> {
        self.candidates.iter().filter(|_| self.base.is_finite())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) fn rivals(base: f64, costs: &[(&str, f64)]) -> Rivals {
        let candidate = |(effect, cost): &(&str, f64)| Candidate {
            effect: (*effect).to_owned(),
            cost: *cost,
            delta_chi2: base - cost,
            criterion: *cost,
            heldout_error: None,
            rejected: Some("hand-made".into()),
        };
        Rivals { base, candidates: costs.iter().map(candidate).collect() }
    }

    #[test]
    fn the_nearest_effect_is_the_one_that_leaves_least() {
        let found = rivals(5_000.0, &[("cogging", 4_000.0), ("spring", 900.0)]);
        assert_eq!(found.excess_with("cogging"), Some(4_000.0));
        assert_eq!(found.excess_with("stribeck"), None);
        assert_eq!(found.nearest(), Some(("spring", 900.0)));
        assert_eq!(rivals(10.0, &[]).nearest(), None);
        assert_eq!(rivals(f64::NAN, &[("spring", 900.0)]).nearest(), None);
    }
}
