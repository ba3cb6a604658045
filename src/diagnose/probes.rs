//! What one more effect would do, at many values of its parameters.
//!
//! Under the null hypothesis most parameters of an effect are not identified,
//! and with large effects the misfit has several valleys. So the response with
//! the effect is computed on a grid over where its parameters are likely; the
//! part of the change that the fitted parameters cannot take up is the direction
//! in which the effect would show, and its product with the residuals says how
//! much it would explain (the score of Rao 1948, doi:10.1017/S0305004100023987,
//! at finite size).

use nalgebra::{DMatrix, DVector};

use crate::effects::{Coordinate, Effect, Range};
use crate::identify::{Model, Workbench};

use super::anchor::Anchor;
use super::scan;
use super::subspace::Subspace;

/// Probes of an effect, at most.
const MOST_PROBES: usize = 32;

/// Shares of the way from where an effect vanishes to the end of its likely range.
const SIZES: [f64; 2] = [0.15, 0.6];

/// The same where the effect has one parameter.
const SIZES_ALONE: [f64; 4] = [0.05, 0.2, 0.5, 0.8];

/// Longest step of a parameter of the anchor on the way to a start.
const LONGEST_SHIFT: f64 = 0.3;

/// Cosine above which two probes show the same.
const SAME: f64 = 0.9999;

/// By how much a probe's change may be scaled up to fit the residuals.
const LARGEST_SCALE: f64 = 1.5;

/// The same of a start, at least: where an effect is absent its shape is lost.
const LEAST_SCALE: f64 = 0.02;

/// An effect with values of its parameters, tried at an anchor.
pub(super) struct Probe {
    /// Where a fit may start.
    pub start: Model,
    /// By how much it would lower χ².
    pub gain: f64,
}

/// What trying an effect at an anchor showed.
pub(super) struct Probed {
    /// The effect.
    pub effect: &'static dyn Effect,
    /// Its probes, that of the largest gain first.
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

/// Tries an effect at an anchor.
pub(super) fn probe(
    workbench: &Workbench<'_>,
    anchor: &Anchor,
    effect: &'static dyn Effect,
) -> Probed {
    let extended = workbench.extend(&anchor.model, effect);
    let own = extended.parameters_of(extended.effects().len() - 1);
    let ranges = workbench.ranges(effect);
    let (places, scanned) = match effect.oscillates() {
        true => scan::scan(workbench, anchor, effect, &extended, &ranges),
        false => (grid(effect, &ranges), Vec::new()),
    };
    let vanishes = ranges.iter().any(|range| range.absent.is_some());
    let mut directions = Vec::new();
    let mut probes: Vec<Probe> = places
        .into_iter()
        .filter_map(|values| {
            let mut model = extended.clone();
            own.clone().zip(&values).for_each(|(i, value)| model.set(i, *value));
            let change = workbench.predict(&model)? - &anchor.prediction;
            let direction = anchor.fitted.complement(&change);
            let (size, slope) = (direction.norm_squared(), direction.dot(&anchor.residuals));
            if !(size > 0.0 && size.is_finite()) {
                return None;
            }
            // What cannot be made smaller must fit as it is.
            let scale = if vanishes { (slope / size).clamp(0.0, LARGEST_SCALE) } else { 1.0 };
            let gain = scale * (2.0 * slope - scale * size);
            let mut values = values;
            effect.resize(&mut values, &ranges, scale.max(LEAST_SCALE));
            own.clone().zip(&values).for_each(|(i, value)| model.set(i, *value));
            let left = &anchor.residuals - change * scale;
            model.shift(anchor.steps(&left).into_iter(), LONGEST_SHIFT);
            directions.push(direction.normalize());
            Some(Probe { start: model, gain })
        })
        .collect();
    probes.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let spans = match scanned.is_empty() {
        true => neighbourhoods(&directions, effect.parameters().len()),
        false => scanned,
    };
    let energy = spans.iter().map(|span| span.energy(&anchor.residuals)).fold(0.0, f64::max);
    Probed { effect, probes, spans, energy }
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
    let sizes: &[f64] = if ranges.len() == 1 { &SIZES_ALONE } else { &SIZES };
    let mut step = 1.4_f64;
    loop {
        let axes: Vec<Vec<f64>> = effect
            .parameters()
            .iter()
            .zip(ranges)
            .map(|(parameter, range)| axis(parameter.coordinate, range, step, sizes))
            .collect();
        let count: usize = axes.iter().map(Vec::len).product();
        if count <= MOST_PROBES || step > 100.0 {
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
