//! The parameters of effects as coordinates, appended to those of the base model.

use crate::effects::{self, ActiveEffect, Effect, Scope};

use super::parameters::{Coordinate, Coordinates};

impl Coordinates {
    /// These coordinates with the parameters of one more effect; `scope` is in the problem's units.
    pub fn with_effect(&self, effect: &'static dyn Effect, scope: &Scope) -> Self {
        let mut these = self.clone();
        for (index, parameter) in effect.parameters().iter().enumerate() {
            let range = (parameter.range)(scope);
            let transformed = |ends: [f64; 2]| match parameter.coordinate {
                effects::Coordinate::Linear | effects::Coordinate::Angle => ends,
                effects::Coordinate::Logarithmic => ends.map(f64::ln),
            };
            these.push(
                Coordinate::OfEffect { effect: self.effects.len(), parameter: index },
                transformed(range.bounds),
                transformed(range.likely),
            );
        }
        these.effects.push(effect);
        these
    }

    /// These coordinates without the effect at `index`, and the previous index of each one kept.
    pub fn without_effect(&self, index: usize) -> (Self, Vec<usize>) {
        let is_of = |i: &usize| matches!(self.list[*i], Coordinate::OfEffect { effect, .. } if effect == index);
        let kept: Vec<usize> = (0..self.len()).filter(|i| !is_of(i)).collect();
        let pick = |values: &[f64]| kept.iter().map(|i| values[*i]).collect();
        let renumbered = |i: &usize| match self.list[*i] {
            Coordinate::OfEffect { effect, parameter } if effect > index => {
                Coordinate::OfEffect { effect: effect - 1, parameter }
            }
            other => other,
        };
        let mut effects = self.effects.clone();
        effects.remove(index);
        let these = Self {
            list: kept.iter().map(renumbered).collect(),
            effects,
            lower: pick(&self.lower),
            upper: pick(&self.upper),
            search_lower: pick(&self.search_lower),
            search_upper: pick(&self.search_upper),
        };
        (these, kept)
    }

    /// The parameter value at a coordinate, and its derivative with respect to the coordinate.
    /// Coordinates of the base model are returned unchanged, with derivative 1.
    pub fn value(&self, i: usize, coordinate: f64) -> (f64, f64) {
        match self.list[i] {
            Coordinate::OfEffect { effect, parameter } => {
                match self.effects[effect].parameters()[parameter].coordinate {
                    effects::Coordinate::Linear | effects::Coordinate::Angle => (coordinate, 1.0),
                    effects::Coordinate::Logarithmic => (coordinate.exp(), coordinate.exp()),
                }
            }
            _ => (coordinate, 1.0),
        }
    }

    /// The coordinate at which an effect's parameter has this value.
    pub fn coordinate(&self, i: usize, value: f64) -> f64 {
        match self.list[i] {
            Coordinate::OfEffect { effect, parameter } => {
                match self.effects[effect].parameters()[parameter].coordinate {
                    effects::Coordinate::Linear | effects::Coordinate::Angle => value,
                    effects::Coordinate::Logarithmic => value.ln(),
                }
            }
            _ => value,
        }
    }

    /// The effects at a point, in the problem's units.
    pub fn effects_at(&self, point: &[f64]) -> Vec<ActiveEffect> {
        let mut next = self.base_len();
        self.effects
            .iter()
            .map(|effect| {
                let count = effect.parameters().len();
                let values = (next..next + count).map(|i| self.value(i, point[i]).0).collect();
                next += count;
                ActiveEffect::new(*effect, values).expect("one value a parameter")
            })
            .collect()
    }
}
