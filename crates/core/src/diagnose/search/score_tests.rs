//! Score tests: what one more effect would explain, at many values of its parameters.
//!
//! Under the null hypothesis most parameters of an effect are not identified, and with large effects
//! the misfit has several minima. So the response with the effect is computed on a grid over where its
//! parameters are likely. The part of the change that the fitted parameters cannot take up is the
//! direction in which the effect would show; its product with the residuals says how much it would
//! explain (the score of Rao 1948, doi:10.1017/S0305004100023987, with a finite change in place of a
//! derivative).
//!
//! An effect changes the response nearly alike beside other small effects: what was computed once
//! serves for every model that it may be added to.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::effects::{ALL, Effect, Range};
use crate::identify::{FitSession, Model, SearchSettings};

use super::frequency_scan;
use super::frequency_scan::Pitch;
use super::grid;
use super::linearization::Linearization;
use crate::diagnose::residuals::subspace::Subspace;

/// What an effect changes, at many values of its parameters.
pub(crate) struct Changes {
    /// The effect.
    pub effect: &'static dyn Effect,
    ranges: Vec<Range>,
    start_points: Vec<Place>,
    pitches: Vec<Pitch>,
}

/// Values of an effect's parameters, and by how much they change Ŷ/σ.
struct Place {
    values: Vec<f64>,
    change: DVector<f64>,
}

/// An effect with values of its parameters, tried at a linearization.
pub(crate) struct Probe {
    /// Where a fit may start.
    pub start: Model,
    /// By how much it would lower χ².
    gain: f64,
}

/// What trying an effect at a linearization showed.
pub(crate) struct Probed {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Its probes, in the order in which fits start from them: that of the largest gain first.
    pub probes: Vec<Probe>,
    /// The directions in which it would show around each place of its parameters.
    pub spans: Vec<Subspace>,
    /// The most that such directions take up of the residuals.
    energy: f64,
}

impl Probed {
    /// By how much the effect may lower χ².
    pub fn promise(&self) -> f64 {
        self.probes.first().map_or(self.energy, |probe| probe.gain.max(self.energy))
    }
}

impl Changes {
    /// Those of an effect beside the linearization's model.
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

    /// Tries the effect at a linearization.
    pub fn probe(&self, session: &FitSession<'_>, linearization: &Linearization) -> Probed {
        let Some(aim) = Aim::of(session, linearization, self.effect) else {
            let (probes, spans) = Default::default();
            return Probed { effect: self.effect, probes, spans, energy: 0.0 };
        };
        let search = session.search();
        let (start_points, spans);
        if self.effect.is_scanned() {
            let most = search.ripple_starts;
            (start_points, spans) =
                frequency_scan::peaks(linearization, &aim.left, &self.ranges, &self.pitches, most);
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
                start.shift(linearization.steps(&left).into_iter(), search.longest_start_shift);
                Probe { start, gain: gain - aim.price }
            })
            .collect();
        let energy = spans.iter().map(|span| span.energy(&aim.left)).fold(0.0, f64::max);
        Probed { effect: self.effect, probes, spans, energy: energy - aim.price }
    }

    /// A place, made as large as fits what is left best.
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

/// What an effect would have to explain at a linearization.
struct Aim {
    /// What an effect changes however small it is: with one that settles, the mean of the
    /// velocity becomes zero.
    balancing: DVector<f64>,
    /// Residuals once that is so, less what the linearization's parameters take up.
    left: DVector<f64>,
    /// By how much they are larger for it, in χ².
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
        // A ripple of no size only balances.
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

/// Values of an effect's parameters, what they change, and by how much that lowers χ².
pub(crate) struct Tried {
    pub values: Vec<f64>,
    pub change: DVector<f64>,
    pub gain: f64,
}

/// Places by their gain, those first that show something else, beside what is `fitted`, than any
/// of a larger gain: a fit from beside another ends where that one does.
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

/// The spans of each direction with its nearest: an effect with p parameters,
/// refitted, follows noise in p directions around the best place.
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
        // Of the second, most is fitted; the rest shows what the first does.
        let start_points =
            [(unit(1), 3.0), (unit(1) + 5.0 * unit(0), 2.0), (unit(2), 1.0)].map(tried);
        let found = different_first(start_points.into(), &fitted, &SearchSettings::default());
        assert_eq!(found.iter().map(|tried| tried.gain).collect::<Vec<_>>(), [3.0, 1.0, 2.0]);
    }
}
