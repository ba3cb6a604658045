//! A model: the base model, possibly with effects, at given parameter values.

use std::ops::Range as Span;

use crate::effects::Effect;

use crate::identify::parameters::Coordinates;
use crate::identify::refine::Refined;

/// The base model with some effects, at given values of all parameters.
#[derive(Debug, Clone)]
pub struct Model {
    pub(super) coordinates: Coordinates,
    pub(super) point: Vec<f64>,
    /// Sum of squared residuals; infinite if it has no response, NaN if it is not computed.
    pub cost: f64,
    /// Simulations of the whole measurement that were used to find it.
    pub evaluations: u64,
}

impl Model {
    /// The effects of the model.
    pub fn effects(&self) -> &[&'static dyn Effect] {
        &self.coordinates.effects
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        self.point.len()
    }

    /// Moves parameters by (index, step), each by at most `most` in its coordinate. The cost
    /// becomes unknown.
    pub fn shift(&mut self, steps: impl Iterator<Item = (usize, f64)>, most: f64) {
        for (i, step) in steps.filter(|(_, step)| step.is_finite()) {
            self.point[i] += step.clamp(-most, most);
        }
        self.coordinates.clamp(&mut self.point);
        self.cost = f64::NAN;
    }

    /// The indices of the parameters of the effect at `index`.
    pub fn parameters_of(&self, index: usize) -> Span<usize> {
        let count = |effect: &&dyn Effect| effect.parameters().len();
        let before: usize = self.effects()[..index].iter().map(count).sum();
        let begin = self.coordinates.base_len() + before;
        begin..begin + count(&self.effects()[index])
    }

    /// Sets a parameter to a value in the problem's units. The cost becomes unknown.
    pub fn set(&mut self, parameter: usize, value: f64) {
        self.point[parameter] = self.coordinates.coordinate(parameter, value);
        self.coordinates.clamp(&mut self.point);
        self.cost = f64::NAN;
    }

    /// By how much a parameter differs from that of a model with the same effects, in its coordinate.
    pub fn shift_from(&self, other: &Self, parameter: usize) -> f64 {
        self.point[parameter] - other.point[parameter]
    }

    /// The value of a parameter, in the problem's units.
    pub fn value(&self, parameter: usize) -> f64 {
        self.coordinates.value(parameter, self.point[parameter]).0
    }

    /// The model at the end of a fit that began with it.
    pub(super) fn refined(&self, refined: Refined) -> Self {
        Self {
            coordinates: self.coordinates.clone(),
            point: refined.point,
            cost: refined.cost,
            evaluations: self.evaluations + refined.evaluations,
        }
    }

    /// The model moved out of the dead zones of its effects, to where every parameter acts on the
    /// response; `None` if every one does already.
    pub(super) fn escaped(&self) -> Option<Self> {
        let friction = self.coordinates.plant(&self.point).friction;
        let mut escaped = self.clone();
        for (i, effect) in self.effects().iter().enumerate() {
            let Some(escape) = effect.search().escape_dead_zone else { continue };
            let own = self.parameters_of(i);
            let before: Vec<f64> = own.clone().map(|parameter| self.value(parameter)).collect();
            let mut values = before.clone();
            escape(&mut values, &friction);
            let moved =
                own.zip(before.into_iter().zip(values)).filter(|(_, (old, new))| old != new);
            moved.for_each(|(parameter, (_, value))| escaped.set(parameter, value));
        }
        (escaped.point != self.point).then_some(escaped)
    }

    /// Standard deviation of the prior of a coordinate: that of a uniform distribution over its
    /// search range.
    pub fn prior_std(&self, parameter: usize) -> f64 {
        let Coordinates { search_lower, search_upper, .. } = &self.coordinates;
        (search_upper[parameter] - search_lower[parameter]) / 12.0_f64.sqrt()
    }
}
