//! What one more effect would do, at many values of its parameters.
//!
//! Under the null hypothesis most parameters of an effect are not identified,
//! and with large effects the misfit has several valleys. So the response with
//! the effect is computed on a grid over where its parameters are likely; the
//! part of the change that the fitted parameters cannot take up is the direction
//! in which the effect would show, and its product with the residuals says how
//! much it would explain (the score of Rao 1948, doi:10.1017/S0305004100023987,
//! at finite size).
//!
//! Beside other effects that are as small, it changes the response by as much:
//! what was computed once serves for every model it may be added to.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::effects::{ALL, Coordinate, Effect, Range};
use crate::identify::{Model, Workbench};

use super::anchor::Anchor;
use super::scan::{self, Pitch};
use super::subspace::Subspace;

/// Places of an effect's parameters, at most.
const MOST_PLACES: usize = 24;

/// Shares of the way from where an effect vanishes to the end of its likely range, of
/// an effect with one parameter, with two, and with more, whose others say its shape.
const SIZES: [&[f64]; 3] = [&[0.05, 0.2, 0.5, 0.8], &[0.15, 0.6], &[0.15]];

/// Longest step of a parameter of the anchor on the way to a start.
const LONGEST_SHIFT: f64 = 0.3;

/// Cosine above which two places show the same.
const SAME: f64 = 0.9999;

/// Cosine below which a start shows something else than one before it.
const ELSE: f64 = 0.9;

/// By how much a change may be scaled up to fit the residuals.
const LARGEST_SCALE: f64 = 1.5;

/// The same of a start, at least: where an effect is absent its shape is lost.
const LEAST_SCALE: f64 = 0.02;

/// What an effect changes, at many values of its parameters.
pub(super) struct Changes {
    /// The effect.
    pub effect: &'static dyn Effect,
    ranges: Vec<Range>,
    places: Vec<Place>,
    pitches: Vec<Pitch>,
}

/// Values of an effect's parameters, and by how much they change Ŷ/σ.
struct Place {
    values: Vec<f64>,
    change: DVector<f64>,
}

/// An effect with values of its parameters, tried at an anchor.
pub(super) struct Probe {
    /// Where a fit may start.
    pub start: Model,
    /// By how much it would lower χ².
    gain: f64,
}

/// What trying an effect at an anchor showed.
pub(super) struct Probed {
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
    /// Those of an effect beside the anchor's model.
    pub fn of(workbench: &Workbench<'_>, anchor: &Anchor, effect: &'static dyn Effect) -> Self {
        let ranges = workbench.ranges(effect);
        let mut this = Self { effect, ranges, places: Vec::new(), pitches: Vec::new() };
        if effect.oscillates() {
            this.pitches = scan::pitches(workbench, anchor, effect, &this.ranges);
            return this;
        }
        let Some(aim) = Aim::of(workbench, anchor, effect) else { return this };
        let before = &anchor.prediction + &aim.balancing;
        let extended = workbench.extend(&anchor.model, effect);
        let own = extended.parameters_of(extended.effects().len() - 1);
        let mut places = workbench.places(effect);
        if places.is_empty() {
            places = grid(effect, &this.ranges);
        }
        let place = |values: Vec<f64>| {
            let mut extended = extended.clone();
            own.clone().zip(&values).for_each(|(i, value)| extended.set(i, *value));
            let change = workbench.predict(&extended)? - &before;
            Some(Place { values, change })
        };
        this.places = places.into_par_iter().filter_map(place).collect();
        this
    }

    /// Tries the effect at an anchor.
    pub fn probe(&self, workbench: &Workbench<'_>, anchor: &Anchor) -> Probed {
        let Some(aim) = Aim::of(workbench, anchor, self.effect) else {
            let (probes, spans) = Default::default();
            return Probed { effect: self.effect, probes, spans, energy: 0.0 };
        };
        let (places, spans);
        if self.effect.oscillates() {
            (places, spans) = scan::peaks(anchor, &aim.left, &self.ranges, &self.pitches);
        } else {
            let scaled = |place| self.scaled(place, anchor, &aim.left);
            places = self.places.iter().filter_map(scaled).collect();
            let directions: Vec<DVector<f64>> = self
                .places
                .iter()
                .map(|place| anchor.fitted.complement(&place.change))
                .filter(|direction| direction.norm() > 0.0)
                .map(|direction| direction.normalize())
                .collect();
            spans = neighbourhoods(&directions, self.effect.parameters().len());
        }
        let probes: Vec<Probe> = different_first(places, anchor)
            .into_iter()
            .map(|Tried { values, change, gain }| {
                let mut start = workbench.extend(&anchor.model, self.effect);
                let own = start.parameters_of(start.effects().len() - 1);
                own.zip(&values).for_each(|(i, value)| start.set(i, *value));
                let left = &anchor.residuals - change - &aim.balancing;
                start.shift(anchor.steps(&left).into_iter(), LONGEST_SHIFT);
                Probe { start, gain: gain - aim.price }
            })
            .collect();
        let energy = spans.iter().map(|span| span.energy(&aim.left)).fold(0.0, f64::max);
        Probed { effect: self.effect, probes, spans, energy: energy - aim.price }
    }

    /// A place, made as large as fits what is left best.
    fn scaled(&self, place: &Place, anchor: &Anchor, left: &DVector<f64>) -> Option<Tried> {
        let direction = anchor.fitted.complement(&place.change);
        let (size, slope) = (direction.norm_squared(), direction.dot(left));
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let scale = (slope / size).clamp(0.0, LARGEST_SCALE);
        let mut values = place.values.clone();
        self.effect.resize(&mut values, &self.ranges, scale.max(LEAST_SCALE));
        let gain = scale * (2.0 * slope - scale * size);
        Some(Tried { values, change: &place.change * scale, gain })
    }
}

/// What an effect would have to explain at an anchor.
struct Aim {
    /// What an effect changes however small it is: with one that settles, the mean of the
    /// velocity becomes zero.
    balancing: DVector<f64>,
    /// Residuals once that is so, less what the anchor's parameters take up.
    left: DVector<f64>,
    /// By how much they are larger for it, in χ².
    price: f64,
}

impl Aim {
    fn of(workbench: &Workbench<'_>, anchor: &Anchor, effect: &dyn Effect) -> Option<Self> {
        let before = anchor.fitted.complement(&anchor.residuals);
        if !effect.settles() {
            let balancing = DVector::zeros(before.len());
            return Some(Self { balancing, left: before, price: 0.0 });
        }
        // A ripple of no size only balances.
        let ripple = ALL.iter().find(|effect| effect.oscillates())?;
        let mut balanced = workbench.extend(&anchor.model, *ripple);
        let size = balanced.parameters_of(balanced.effects().len() - 1).start;
        balanced.set(size, 0.0);
        let balancing = workbench.predict(&balanced)? - &anchor.prediction;
        let left = anchor.fitted.complement(&(&anchor.residuals - &balancing));
        let price = left.norm_squared() - before.norm_squared();
        Some(Self { balancing, left, price })
    }
}

/// Values of an effect's parameters, what they change, and by how much that lowers χ².
pub(super) struct Tried {
    pub values: Vec<f64>,
    pub change: DVector<f64>,
    pub gain: f64,
}

/// Places by their gain, those first that show something else than any of a larger gain: a fit
/// from beside another ends where that one does.
fn different_first(mut places: Vec<Tried>, anchor: &Anchor) -> Vec<Tried> {
    places.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut shown: Vec<DVector<f64>> = Vec::new();
    let (mut different, mut others) = (Vec::new(), Vec::new());
    for tried in places {
        let direction = anchor.fitted.complement(&tried.change).normalize();
        if shown.iter().all(|other| other.dot(&direction).abs() < ELSE) {
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
fn neighbourhoods(directions: &[DVector<f64>], parameters: usize) -> Vec<Subspace> {
    let cosine = |a: &DVector<f64>, b: &DVector<f64>| a.dot(b).abs();
    let mut different: Vec<&DVector<f64>> = Vec::new();
    for direction in directions {
        if different.iter().all(|other| cosine(direction, other) < SAME) {
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

/// Values to try: every combination of a few of each parameter.
fn grid(effect: &dyn Effect, ranges: &[Range]) -> Vec<Vec<f64>> {
    let sizes = SIZES[ranges.len().min(SIZES.len()) - 1];
    let mut step = if ranges.len() == 1 { 4.0_f64 } else { 1.4 };
    loop {
        let axes: Vec<Vec<f64>> = effect
            .parameters()
            .iter()
            .zip(ranges)
            .map(|(parameter, range)| axis(parameter.coordinate, range, step, sizes))
            .collect();
        let count: usize = axes.iter().map(Vec::len).product();
        if count <= MOST_PLACES || step > 100.0 {
            return axes.iter().fold(vec![Vec::new()], |points, axis| {
                let longer = |point: &Vec<f64>| {
                    let point = point.clone();
                    axis.iter().map(move |value| [&point[..], &[*value]].concat())
                };
                points.iter().flat_map(longer).collect()
            });
        }
        step *= 1.1;
    }
}

/// A few values of one parameter; logarithms in steps of about this factor.
fn axis(coordinate: Coordinate, range: &Range, step: f64, sizes: &[f64]) -> Vec<f64> {
    let [low, high] = range.likely;
    let ends = || [low, high].into_iter();
    match (coordinate, range.absent) {
        (Coordinate::Logarithmic, Some(absent)) if absent > 0.0 && absent.is_finite() => ends()
            .filter(|end| (end / absent).ln().abs() > 0.1 * (high / low).ln())
            .flat_map(|end| sizes.iter().map(move |size| absent * (end / absent).powf(*size)))
            .collect(),
        (_, Some(absent)) if absent.is_finite() => ends()
            .filter(|end| (end - absent).abs() > 0.1 * (high - low))
            .flat_map(|end| sizes.iter().map(move |size| absent + size * (end - absent)))
            .collect(),
        (Coordinate::Logarithmic, _) => {
            let ratio = (high / low).ln();
            let count = ((ratio / step.ln()).round() as usize).max(1);
            let at = |i: usize| low * (ratio * (i as f64 + 0.5) / count as f64).exp();
            (0..count).map(at).collect()
        }
        (Coordinate::Linear, _) => {
            let count = if step < 10.0 { 4 } else { 2 };
            let at = |i: usize| low + (high - low) * (i as f64 + 0.5) / f64::from(count);
            (0..count as usize).map(at).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{exact, noisy, request};
    use super::*;
    use crate::benchmark::draw::NoiseStatement;
    use crate::observer::Silent;

    #[test]
    fn what_shows_the_same_as_a_place_of_larger_gain_comes_after_what_shows_something_else() {
        let (measurement, request) = (noisy(&exact(), NoiseStatement::Std, 4), request());
        let workbench = Workbench::new(&measurement, &request, &Silent).unwrap();
        let anchor = Anchor::new(&workbench, workbench.base()).unwrap();
        let wave = |cycles: f64| {
            DVector::from_fn(anchor.residuals.len(), |row, _| (cycles * row as f64).sin())
        };
        let tried = |(change, gain)| Tried { values: Vec::new(), change, gain };
        let places = [(wave(2.0), 1.0), (wave(1.0), 3.0), (2.0 * wave(1.0), 2.0)].map(tried);
        let gains: Vec<f64> =
            different_first(places.into(), &anchor).iter().map(|tried| tried.gain).collect();
        assert_eq!(gains, [3.0, 1.0, 2.0]);
    }
}
