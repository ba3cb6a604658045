//! A model at some values of its parameters.

use std::ops::Range as Span;

use crate::effects::Effect;

use crate::identify::parameters::Coordinates;

/// The base model with some effects, at some values of all parameters.
#[derive(Debug, Clone)]
pub struct Model {
    pub(super) coordinates: Coordinates,
    pub(super) point: Vec<f64>,
    /// Sum of squared residuals; infinite where it has no response.
    pub cost: f64,
    /// Simulations of the whole measurement that led here.
    pub evaluations: u64,
}

impl Model {
    /// Its effects.
    pub fn effects(&self) -> &[&'static dyn Effect] {
        &self.coordinates.effects
    }

    /// Number of parameters.
    pub fn parameters(&self) -> usize {
        self.point.len()
    }

    /// Moves the first parameters by these steps, each at most `most`.
    pub fn shift(&mut self, steps: impl Iterator<Item = (usize, f64)>, most: f64) {
        for (i, step) in steps.filter(|(_, step)| step.is_finite()) {
            self.point[i] += step.clamp(-most, most);
        }
        self.coordinates.clamp(&mut self.point);
        self.cost = f64::NAN;
    }

    /// Which of the parameters belong to the effect at `index`.
    pub fn parameters_of(&self, index: usize) -> Span<usize> {
        let count = |effect: &&dyn Effect| effect.parameters().len();
        let before: usize = self.effects()[..index].iter().map(count).sum();
        let begin = self.coordinates.base_len() + before;
        begin..begin + count(&self.effects()[index])
    }

    /// Sets a parameter to a value in the problem's scales.
    pub fn set(&mut self, parameter: usize, value: f64) {
        self.point[parameter] = self.coordinates.coordinate(parameter, value);
        self.coordinates.clamp(&mut self.point);
        self.cost = f64::NAN;
    }

    /// The value of a parameter in the problem's scales.
    pub fn value(&self, parameter: usize) -> f64 {
        self.coordinates.value(parameter, self.point[parameter]).0
    }

    /// The same where every parameter acts; `None` where they do already.
    pub(super) fn roused(&self) -> Option<Self> {
        let friction = self.coordinates.plant(&self.point).friction;
        let mut roused = self.clone();
        for (i, effect) in self.effects().iter().enumerate() {
            let Some(escape) = effect.search().escape_dead_zone else { continue };
            let own = self.parameters_of(i);
            let before: Vec<f64> = own.clone().map(|parameter| self.value(parameter)).collect();
            let mut values = before.clone();
            escape(&mut values, &friction);
            let moved =
                own.zip(before.into_iter().zip(values)).filter(|(_, (old, new))| old != new);
            moved.for_each(|(parameter, (_, value))| roused.set(parameter, value));
        }
        (roused.point != self.point).then_some(roused)
    }

    /// Standard deviation, before the data is seen, of each coordinate: that of
    /// a uniform law over the range where a search looks first.
    pub fn prior_std(&self, parameter: usize) -> f64 {
        let Coordinates { search_lower, search_upper, .. } = &self.coordinates;
        (search_upper[parameter] - search_lower[parameter]) / 12.0_f64.sqrt()
    }
}
