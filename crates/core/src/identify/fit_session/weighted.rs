//! Sessions on the same measurement with weights from elsewhere.

use crate::answers::{Identification, IdentifyOptions, NetworkOptions, PlantRequest};
use crate::observer::Observer;

use super::{FitAccuracy, FitSession, Model};
use crate::identify::noise::Weights;
use crate::identify::prediction;
use crate::identify::request::{IdentifyError, IdentifyRequest};

impl<'a> FitSession<'a> {
    /// Fits the base model as another request asks, such as with another actuator order, with the
    /// weights of this session, so that the costs of both compare.
    ///
    /// # Errors
    /// See [`IdentifyError`].
    pub fn beside<'b>(
        &self,
        request: &'b IdentifyRequest,
        observer: &'b dyn Observer,
    ) -> Result<FitSession<'b>, IdentifyError>
    where
        'a: 'b,
    {
        self.again(request, Some(&self.fitted.weights), observer)
    }

    /// Fits the base model with the weights that another request asks for, from the fits of this
    /// session.
    ///
    /// # Errors
    /// See [`IdentifyError`].
    pub fn weighted_as<'b>(
        &self,
        request: &'b IdentifyRequest,
        observer: &'b dyn Observer,
    ) -> Result<FitSession<'b>, IdentifyError>
    where
        'a: 'b,
    {
        self.again(request, None, observer)
    }

    /// Whether the weights that follow from what the model of an answer to the same measurement leaves
    /// hardly differ from those of this session, or do not depend on a model.
    ///
    /// # Errors
    /// See [`IdentifyError`].
    pub fn has_weights_of(&self, answer: &Identification) -> Result<bool, IdentifyError> {
        if self.noise_known() || !self.fitted.weights.depend_on_model {
            return Ok(true);
        }
        let weights = prediction::weights_of(self.measurement, &self.problem, answer)?;
        Ok(weights.resemble(&self.fitted.weights))
    }

    /// Fits the base model with the weights that follow from what the model of an answer to the same
    /// measurement leaves.
    ///
    /// # Errors
    /// See [`IdentifyError`].
    pub fn weighted_by(
        &self,
        answer: &Identification,
        observer: &'a dyn Observer,
    ) -> Result<Self, IdentifyError> {
        let weights = prediction::weights_of(self.measurement, &self.problem, answer)?;
        self.again(self.request, Some(&weights), observer)
    }

    /// The model of an answer to the same measurement that was found with other weights, fitted again
    /// with those of this session. `None` if the answer lacks a parameter.
    ///
    /// # Errors
    /// See [`IdentifyError`].
    pub fn fitted_again(
        &self,
        answer: &Identification,
        observer: &dyn Observer,
    ) -> Result<Option<Model>, IdentifyError> {
        let (Ok(plant), Ok(reported)) = (
            prediction::reported_plant(answer),
            prediction::reported_effects(answer, self.problem.scales),
        ) else {
            return Ok(None);
        };
        let plant = Some(PlantRequest { actuator_order: plant.actuator.order() });
        let request = IdentifyRequest { plant, ..*self.request };
        let session = self.beside(&request, observer)?;
        let base = session.base().clone();
        let start = reported.iter().fold(base, |model, own| session.extend(&model, own.effect()));
        let refit = |model| session.refine(&model, FitAccuracy::Settle);
        Ok(session.at_reported(&start, answer).map(refit))
    }

    /// The base model, searched for anew by the colony alone, with the weights of this session. The
    /// network would take as long again, and is no surer.
    ///
    /// # Errors
    /// See [`IdentifyError`].
    pub fn searched_anew(&self) -> Result<Model, IdentifyError> {
        let network = NetworkOptions { enabled: false, ..self.request.options.network };
        let options = IdentifyOptions { network, ..self.request.options };
        let request = IdentifyRequest { options, ..*self.request };
        let (weights, problem) = (&self.fitted.weights, self.problem.clone());
        let from = (Some(weights), &[][..]);
        let found = FitSession::solved(self.measurement, &request, self.observer, problem, from)?;
        Ok(found.base)
    }

    /// Fits the base model from the fits of this session, with the given weights or, without any,
    /// with those that the request asks for.
    fn again<'b>(
        &self,
        request: &'b IdentifyRequest,
        weights: Option<&Weights>,
        observer: &'b dyn Observer,
    ) -> Result<FitSession<'b>, IdentifyError>
    where
        'a: 'b,
    {
        let from = (weights, &self.orders[..]);
        FitSession::solved(self.measurement, request, observer, self.problem.clone(), from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{IdentifyOptions, PlantRequest, Weighting};
    use crate::effects::find;
    use crate::identify::fixtures::{ACTUATORS, axis, stepped_sine};
    use crate::identify::summary::Intervals;
    use crate::observer::Silent;

    /// Requests of one order, with the weights of the noise and with equal ones.
    fn requests(actuator_order: u8) -> [IdentifyRequest; 2] {
        let plant = Some(PlantRequest { actuator_order });
        let by_noise = IdentifyRequest { plant, ..IdentifyRequest::default() };
        let options = IdentifyOptions { weights: Weighting::Response, ..by_noise.options };
        [by_noise, IdentifyRequest { options, ..by_noise }]
    }

    // Both are refined thoroughly.
    #[test]
    fn a_fit_with_other_weights_starts_from_the_known_fits_and_is_as_good_as_one_without_them() {
        let measurement = stepped_sine(&axis(ACTUATORS[2]), 3);
        let [by_noise, equal] = requests(1);
        let first = FitSession::new(&measurement, &by_noise, &Silent).unwrap();
        let known = first.weighted_as(&equal, &Silent).unwrap();
        let anew = FitSession::new(&measurement, &equal, &Silent).unwrap();
        assert!((known.base().cost / anew.base().cost - 1.0).abs() < 1e-6);
        let stages = |session: &FitSession<'_>| -> Vec<String> {
            session.fitted.stages.iter().map(|stage| stage.name.clone()).collect()
        };
        assert!(stages(&anew).contains(&"network".into()), "{:?}", stages(&anew));
        assert!(!stages(&known).contains(&"network".into()), "{:?}", stages(&known));
    }

    // Neither knows of the actuator; a fit settles to 1e-5 of its cost.
    #[test]
    fn an_answer_found_with_equal_weights_is_fitted_again_as_well_as_with_those_of_the_noise() {
        let measurement = stepped_sine(&axis(ACTUATORS[1]), 3);
        let [by_noise, equal] = requests(0);
        let first = FitSession::new(&measurement, &by_noise, &Silent).unwrap();
        let drag = find("quadratic_drag").unwrap();
        let with = |session: &FitSession<'_>| {
            session.refine(&session.extend(session.base(), drag), FitAccuracy::Thorough)
        };
        let second = first.weighted_as(&equal, &Silent).unwrap();
        let answer = second.judge(&with(&second), Intervals::Curvature).unwrap().identification;
        let again = first.fitted_again(&answer, &Silent).unwrap().unwrap();
        let best = with(&first).cost;
        assert!((again.cost / best - 1.0).abs() < 1e-3, "{} {best}", again.cost);
        let mut incomplete = answer;
        incomplete.parameters.shift_remove("constant");
        assert!(first.fitted_again(&incomplete, &Silent).unwrap().is_none());
    }
}
