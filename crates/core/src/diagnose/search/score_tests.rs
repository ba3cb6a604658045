//! Score tests: how much one more effect would explain, at many values of its parameters.
//!
//! Under the null hypothesis most parameters of an effect are not identified, and with large effects
//! the misfit has several minima. So the response with the effect is computed on a grid over the
//! likely ranges of its parameters. The part of its change that the fitted parameters cannot absorb
//! is the direction in which the effect would show. The product of that direction with the residuals
//! is the score (Rao 1948, doi:10.1017/S0305004100023987), with a finite change in place of a
//! derivative.
//!
//! An effect changes the response almost equally beside other small effects. The changes are
//! therefore computed once, beside the base model, and used for every model that the effect is added
//! to.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::effects::{ALL, Effect, Range};
use crate::identify::{FitSession, Model, SearchSettings};

use super::frequency_scan;
use super::frequency_scan::Pitch;
use super::grid;
use super::linearization::Linearization;
use crate::diagnose::residuals::subspace::Subspace;

/// Largest step of a base parameter from the fitted model to a starting point, in logarithms or input
/// scales: beyond it a linearisation that hardly determines the parameter says nothing.
const LONGEST_START_SHIFT: f64 = 0.3;

/// How an effect changes the response, at many values of its parameters.
pub(crate) struct Changes {
    /// The effect.
    pub effect: &'static dyn Effect,
    ranges: Vec<Range>,
    start_points: Vec<Place>,
    pitches: Vec<Pitch>,
}

/// Values of an effect's parameters, and the change of Ŷ/σ by them.
struct Place {
    values: Vec<f64>,
    change: DVector<f64>,
}

/// A starting point of an effect, with its score.
pub(crate) struct Probe {
    /// The model from which a fit may start.
    pub start: Model,
    /// Estimated decrease of χ².
    gain: f64,
}

/// The score tests of one effect at a linearization.
pub(crate) struct Probed {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Its starting points, in the order in which fits use them: the largest gain first.
    pub probes: Vec<Probe>,
    /// For each point of the grid, the subspace of directions in which the effect would show nearby.
    pub spans: Vec<Subspace>,
    /// The largest share of χ² that one of these subspaces takes up.
    energy: f64,
}

impl Probed {
    /// The largest decrease of χ² that the effect may reach.
    pub fn promise(&self) -> f64 {
        self.probes.first().map_or(self.energy, |probe| probe.gain.max(self.energy))
    }
}

impl Changes {
    /// The changes by an effect beside the linearization's model.
    pub fn of(
        session: &FitSession<'_>,
        linearization: &Linearization,
        effect: &'static dyn Effect,
    ) -> Self {
        let ranges = session.ranges(effect);
        let mut this = Self { effect, ranges, start_points: Vec::new(), pitches: Vec::new() };
        if effect.is_scanned() {
            this.pitches = frequency_scan::pitches(session, linearization, effect, &this.ranges);
            return this;
        }
        let Some(aim) = Aim::of(session, linearization, effect) else { return this };
        let before = &linearization.prediction + &aim.balancing;
        let extended = session.extend(&linearization.model, effect);
        let own = extended.parameters_of(extended.effects().len() - 1);
        let mut start_points = session.start_points(effect);
        if start_points.is_empty() {
            start_points = grid::of(effect, &this.ranges, session.search().grid_points);
        }
        let place = |values: Vec<f64>| {
            let mut extended = extended.clone();
            own.clone().zip(&values).for_each(|(i, value)| extended.set(i, *value));
            let change = session.predict(&extended)? - &before;
            Some(Place { values, change })
        };
        this.start_points = start_points.into_par_iter().filter_map(place).collect();
        this
    }

    /// The score tests of the effect at a linearization.
    pub fn probe(&self, session: &FitSession<'_>, linearization: &Linearization) -> Probed {
        let Some(aim) = Aim::of(session, linearization, self.effect) else {
            let (probes, spans) = Default::default();
            return Probed { effect: self.effect, probes, spans, energy: 0.0 };
        };
        let search = session.search();
        let (start_points, spans);
        if self.effect.is_scanned() {
            (start_points, spans) = frequency_scan::peaks(
                session.observer(),
                linearization,
                &aim.left,
                &self.ranges,
                &self.pitches,
            );
        } else {
            let scaled = |place| self.scaled(place, linearization, &aim.left, search);
            start_points = self.start_points.iter().filter_map(scaled).collect();
            let directions: Vec<DVector<f64>> = self
                .start_points
                .iter()
                .map(|place| linearization.fitted.complement(&place.change))
                .filter(|direction| direction.norm() > 0.0)
                .map(|direction| direction.normalize())
                .collect();
            spans = neighbourhoods(&directions, self.effect.parameters().len(), search);
        }
        let probes: Vec<Probe> = different_first(start_points, &linearization.fitted, search)
            .into_iter()
            .map(|Tried { values, change, gain }| {
                let mut start = session.extend(&linearization.model, self.effect);
                let own = start.parameters_of(start.effects().len() - 1);
                own.zip(&values).for_each(|(i, value)| start.set(i, *value));
                let left = &linearization.residuals - change - &aim.balancing;
                start.shift(linearization.steps(&left).into_iter(), LONGEST_START_SHIFT);
                Probe { start, gain: gain - aim.price }
            })
            .collect();
        let energy = spans.iter().map(|span| span.energy(&aim.left)).fold(0.0, f64::max);
        Probed { effect: self.effect, probes, spans, energy: energy - aim.price }
    }

    /// A point of the grid, scaled to the size that fits the residuals best.
    fn scaled(
        &self,
        place: &Place,
        linearization: &Linearization,
        left: &DVector<f64>,
        search: &SearchSettings,
    ) -> Option<Tried> {
        let direction = linearization.fitted.complement(&place.change);
        let (size, slope) = (direction.norm_squared(), direction.dot(left));
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let scale = (slope / size).clamp(0.0, search.largest_scale);
        let mut values = place.values.clone();
        (self.effect.search().resize)(&mut values, &self.ranges, scale.max(search.smallest_scale));
        let gain = scale * (2.0 * slope - scale * size);
        Some(Tried { values, change: &place.change * scale, gain })
    }
}

/// The residuals that an effect would have to explain at a linearization.
struct Aim {
    /// The change by the effect at size zero: an effect that forces a zero mean velocity changes
    /// the response by that alone.
    balancing: DVector<f64>,
    /// The residuals after that change, less what the linearization's parameters absorb.
    left: DVector<f64>,
    /// The increase of χ² by that change.
    price: f64,
}

impl Aim {
    fn of(
        session: &FitSession<'_>,
        linearization: &Linearization,
        effect: &dyn Effect,
    ) -> Option<Self> {
        let before = linearization.fitted.complement(&linearization.residuals);
        if !effect.search().forces_zero_mean {
            let balancing = DVector::zeros(before.len());
            return Some(Self { balancing, left: before, price: 0.0 });
        }
        // A ripple of size zero does nothing but force the mean to zero.
        let ripple = ALL.iter().find(|effect| effect.is_scanned())?;
        let mut balanced = session.extend(&linearization.model, *ripple);
        let size = balanced.parameters_of(balanced.effects().len() - 1).start;
        balanced.set(size, 0.0);
        let balancing = session.predict(&balanced)? - &linearization.prediction;
        let left = linearization.fitted.complement(&(&linearization.residuals - &balancing));
        let price = left.norm_squared() - before.norm_squared();
        Some(Self { balancing, left, price })
    }
}

/// Values of an effect's parameters, the change by them, and the estimated decrease of χ².
pub(crate) struct Tried {
    pub values: Vec<f64>,
    pub change: DVector<f64>,
    pub gain: f64,
}

/// Orders points by their gain, but puts those first whose direction differs from all points of
/// larger gain: two fits that start in the same direction usually end in the same minimum. Directions
/// are compared outside the subspace `fitted`.
fn different_first(
    mut start_points: Vec<Tried>,
    fitted: &Subspace,
    search: &SearchSettings,
) -> Vec<Tried> {
    let most = 1.0 - search.different_direction;
    start_points.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut shown: Vec<DVector<f64>> = Vec::new();
    let (mut different, mut others) = (Vec::new(), Vec::new());
    for tried in start_points {
        let direction = fitted.complement(&tried.change).normalize();
        if shown.iter().all(|other| other.dot(&direction).abs() < most) {
            shown.push(direction);
            different.push(tried);
        } else {
            others.push(tried);
        }
    }
    different.append(&mut others);
    different
}

/// For each direction, the subspace of it and its nearest neighbours: refitting an effect with p
/// parameters follows noise in p directions around the best point.
fn neighbourhoods(
    directions: &[DVector<f64>],
    parameters: usize,
    search: &SearchSettings,
) -> Vec<Subspace> {
    let most = 1.0 - search.same_direction;
    let cosine = |a: &DVector<f64>, b: &DVector<f64>| a.dot(b).abs();
    let mut different: Vec<&DVector<f64>> = Vec::new();
    for direction in directions {
        if different.iter().all(|other| cosine(direction, other) < most) {
            different.push(direction);
        }
    }
    different
        .iter()
        .map(|direction| {
            let mut nearest = different.clone();
            nearest.sort_by(|a, b| cosine(b, direction).total_cmp(&cosine(a, direction)));
            nearest.truncate(parameters);
            let columns: Vec<DVector<f64>> = nearest.into_iter().cloned().collect();
            Subspace::of(&DMatrix::from_columns(&columns))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_shows_the_same_as_a_place_of_larger_gain_comes_after_what_shows_something_else() {
        let unit = |row: usize| DVector::from_fn(3, |i, _| if i == row { 1.0 } else { 0.0 });
        let fitted = Subspace::of(&DMatrix::from_columns(&[unit(0)]));
        let tried = |(change, gain)| Tried { values: Vec::new(), change, gain };
        // Most of the second change is absorbed; the rest has the direction of the first.
        let start_points =
            [(unit(1), 3.0), (unit(1) + 5.0 * unit(0), 2.0), (unit(2), 1.0)].map(tried);
        let found = different_first(start_points.into(), &fitted, &SearchSettings::default());
        assert_eq!(found.iter().map(|tried| tried.gain).collect::<Vec<_>>(), [3.0, 1.0, 2.0]);
    }
}
