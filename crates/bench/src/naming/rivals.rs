//! How well a single effect of the library imitates the hidden effect, judged by the excess χ² that
//! it leaves of the noise-free response.

use serde::Serialize;

use servoscope_core::answers::{Candidate, IdentifyOptions, PlantRequest};
use servoscope_core::diagnose::{DiagnoseError, diagnose};
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::measurement::Measurement;
use servoscope_core::observer::Silent;

/// The candidates of a diagnosis of a noise-free response, and the cost of the base model.
#[derive(Debug, Clone, PartialEq)]
pub struct Rivals {
    base: f64,
    candidates: Vec<Candidate>,
}

/// The other effect that, alone and with everything else refitted, imitates the hidden effect best.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nearest {
    /// Its id.
    pub effect: String,
    /// Excess χ² that it leaves of the noise-free response. If neither model contains the other, a
    /// choice by likelihood between it and the hidden effect is wrong with probability
    /// Φ(−½√excess), the error between two simple hypotheses (Neyman and Pearson 1933, DOI
    /// 10.1098/rsta.1933.0009).
    pub excess: f64,
}

impl Rivals {
    /// Fits every effect alone to a noise-free response that states the standard deviation of its
    /// noise.
    ///
    /// # Errors
    /// See [`DiagnoseError`].
    pub fn ask(exact: &Measurement, order: u8) -> Result<Self, DiagnoseError> {
        let plant = Some(PlantRequest { actuator_order: order });
        let options =
            IdentifyOptions { most_effects: 1, keep_all: true, ..IdentifyOptions::default() };
        let request = IdentifyRequest { plant, options, ..IdentifyRequest::default() };
        let answer = diagnose(exact, &request, &Silent)?;
        Ok(Self { base: answer.base.fit.chi2.unwrap_or(f64::NAN), candidates: answer.candidates })
    }

    /// Excess χ² of the base model; NaN if its errors are not counted in noise.
    pub fn excess_alone(&self) -> f64 {
        self.base
    }

    /// Excess χ² of the best fit with this effect alone; `None` if it was not tried.
    pub fn excess_with(&self, effect: &str) -> Option<f64> {
        let of_effect = |candidate: &&Candidate| candidate.effect == effect;
        self.alone().filter(of_effect).map(|candidate| candidate.cost).reduce(f64::min)
    }

    /// The effect with the smallest excess, other than the hidden one; `None` if none was tried.
    pub fn nearest_to(&self, hidden: &str) -> Option<Nearest> {
        self.alone()
            .filter(|candidate| candidate.effect != hidden)
            .min_by(|left, right| left.cost.total_cmp(&right.cost))
            .map(|candidate| Nearest { effect: candidate.effect.clone(), excess: candidate.cost })
    }

    /// All candidates, each a single effect because [`Self::ask`] allows no more. None if the base
    /// model has no χ², because costs are then not χ².
    fn alone(&self) -> impl Iterator<Item = &Candidate> {
        self.candidates.iter().filter(|_| self.base.is_finite())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::sizing::Sizing;
    use super::*;
    use crate::naming::{Case, build_case};

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
    fn the_nearest_effect_is_the_other_one_that_leaves_least() {
        let found = rivals(5_000.0, &[("cogging", 4_000.0), ("spring", 900.0)]);
        assert_eq!(found.excess_with("cogging"), Some(4_000.0));
        assert_eq!(found.excess_with("stribeck"), None);
        let nearest = |effect: &str, excess| Some(Nearest { effect: effect.to_owned(), excess });
        assert_eq!(found.nearest_to("cubic_drag"), nearest("spring", 900.0));
        assert_eq!(found.nearest_to("spring"), nearest("cogging", 4_000.0));
        assert_eq!(rivals(10.0, &[]).nearest_to("spring"), None);
        assert_eq!(rivals(f64::NAN, &[("spring", 900.0)]).nearest_to("cogging"), None);
    }

    #[test]
    fn what_comes_nearest_to_a_lag_is_a_delay() {
        let case: Case = "single-50-sensor_lag-o0-0".parse().unwrap();
        let made = build_case(&case, 1, Sizing::Amount, &Silent).unwrap();
        let nearest = made.nearest_rival().unwrap().unwrap();
        assert_eq!(nearest.effect, "transport_delay");
        // The rival contains the base model, so its excess cannot be larger.
        assert!((0.0..made.excess).contains(&nearest.excess), "{nearest:?} of {}", made.excess);
    }
}
