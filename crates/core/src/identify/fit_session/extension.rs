//! Builds models with an effect added, removed or replaced, without fitting them.

use crate::effects::{Effect, Parameter, Range, WIDE_LANES};

use super::{FitSession, Model};
use crate::answers::Identification;
use crate::identify::prediction;

impl FitSession<'_> {
    /// The ranges of the parameters of an effect, in the problem's units.
    pub fn ranges(&self, effect: &dyn Effect) -> Vec<Range> {
        let scope = self.scope();
        effect.parameters().iter().map(|parameter| (parameter.range)(&scope)).collect()
    }

    /// Whether a model with one more effect can be tested: there must be more data than parameters
    /// (and the scale of the noise, if unknown), and no more parameters than derivatives can be
    /// computed for.
    pub fn can_decide(&self, model: &Model, effect: &dyn Effect) -> bool {
        let parameters = model.parameters() + effect.parameters().len();
        let scale = usize::from(!self.noise_known());
        self.data() > parameters + scale && parameters <= WIDE_LANES
    }

    /// Parameter values of an effect from which to start fits, in the problem's units.
    pub fn start_points(&self, effect: &dyn Effect) -> Vec<Vec<f64>> {
        effect.start_points(&self.scope())
    }

    /// Two models with another effect in the place of the one at `index`. Parameters that both effects
    /// have keep their values. The others are in the middle of their search range (first model) or
    /// at its lower end (second model). Not fitted.
    pub fn exchange(
        &self,
        (model, index): (&Model, usize),
        effect: &'static dyn Effect,
    ) -> [Model; 2] {
        let (lost, from) = (model.effects()[index], model.parameters_of(index));
        let middle = self.extend(&self.reduce(model, index), effect);
        let mut exchanged = [middle.clone(), middle];
        let own = exchanged[0].parameters_of(model.effects().len() - 1);
        for ((to, parameter), range) in own.zip(effect.parameters()).zip(self.ranges(effect)) {
            let is_same = |other: &Parameter| parameter.is_same(other);
            match lost.parameters().iter().position(is_same) {
                Some(i) => {
                    exchanged.iter_mut().for_each(|m| m.set(to, model.value(from.start + i)))
                }
                None => exchanged[1].set(to, range.likely[0]),
            }
        }
        exchanged
    }

    /// A model with one more effect, its parameters in the middle of their search ranges. Not
    /// fitted.
    pub fn extend(&self, model: &Model, effect: &'static dyn Effect) -> Model {
        let coordinates = model.coordinates.with_effect(effect, &self.scope());
        let mut point = model.point.clone();
        // `clamp` replaces NaN by the middle of the search range.
        point.resize(coordinates.len(), f64::NAN);
        coordinates.clamp(&mut point);
        Model { coordinates, point, cost: f64::NAN, evaluations: 0 }
    }

    /// A model with the values that an answer reports of the same plant and effects, in units of the
    /// measurement. `None` if the answer lacks one.
    pub fn at_reported(&self, model: &Model, answer: &Identification) -> Option<Model> {
        let plant = self.problem.in_scale(&prediction::reported_plant(answer).ok()?);
        let mut model = self.with_reported_effects(model, answer)?;
        let base = model.coordinates.point(&plant);
        let count = model.coordinates.base_len();
        model.point[..count].copy_from_slice(&base[..count]);
        Some(model)
    }

    /// A model with the values that an answer reports of the same effects, beside a plant that may be
    /// of another order. `None` if the answer lacks one.
    pub fn with_reported_effects(&self, model: &Model, answer: &Identification) -> Option<Model> {
        let reported = prediction::reported_effects(answer, self.problem.scales).ok()?;
        let mut model = model.clone();
        for (index, effect) in model.effects().to_vec().into_iter().enumerate() {
            let own = reported.iter().find(|own| own.effect().id() == effect.id())?;
            let values = own.values().to_vec();
            model.parameters_of(index).zip(values).for_each(|(i, value)| model.set(i, value));
        }
        model.cost = f64::NAN;
        Some(model)
    }

    /// A model without the effect at `index`. Not fitted.
    pub fn reduce(&self, model: &Model, index: usize) -> Model {
        let (coordinates, kept) = model.coordinates.without_effect(index);
        let point = kept.iter().map(|i| model.point[*i]).collect();
        Model { coordinates, point, cost: f64::NAN, evaluations: 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::find;
    use crate::identify::fixtures::{ACTUATORS, axis, stepped_sine};
    use crate::identify::request::IdentifyRequest;
    use crate::observer::Silent;

    #[test]
    fn an_effect_in_the_place_of_any_other_keeps_the_parameters_that_both_have() {
        let measurement = stepped_sine(&axis(ACTUATORS[0]), 3);
        let request = IdentifyRequest::default();
        let session = FitSession::new(&measurement, &request, &Silent).unwrap();
        let [play, joint, drag] =
            ["backlash", "flexible_mode", "quadratic_drag"].map(|id| find(id).unwrap());
        let values = |model: &Model, index: usize| -> Vec<f64> {
            model.parameters_of(index).map(|parameter| model.value(parameter)).collect()
        };
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a / b - 1.0).abs() < 1e-12);
        let mut pair = session.extend(&session.extend(session.base(), play), drag);
        let places = session.start_points(play);
        pair.parameters_of(0).zip(&places[0]).for_each(|(i, value)| pair.set(i, *value));
        let [first, _] = session.exchange((&pair, 0), joint);
        assert!(near(&values(&first, 1), &places[0][..3]), "{:?}", values(&first, 1));
        assert!(near(&values(&first, 0), &values(&pair, 1)), "the drag is as it was");
        let [_, lowest] = session.exchange((&first, 1), play);
        let gap = session.ranges(play)[3].likely[0];
        assert!(near(&values(&lowest, 1), &[&places[0][..3], &[gap]].concat()));
    }
}
