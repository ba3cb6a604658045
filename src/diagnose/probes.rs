//! What one more effect would do, at many values of its parameters.
//!
//! Under the null hypothesis most parameters of an effect are not identified,
//! and with large effects the misfit has several valleys. So the response with
//! the effect is computed on a grid over where its parameters are likely; the
//! part of the change that the fitted parameters cannot take up is the direction
//! in which the effect would show, and its product with the residuals says how
//! much it would explain (the score of Rao 1948, doi:10.1017/S0305004100023987,
//! at finite size).

use std::ops::Range as Span;

use nalgebra::DVector;

use crate::effects::{Coordinate, Effect, Range};
use crate::identify::{Model, Workbench};

use super::anchor::Anchor;

/// Probes of an effect, at most.
const MOST_PROBES: usize = 32;

/// Shares of the way from where an effect vanishes to the end of its likely range.
const SIZES: [f64; 2] = [0.15, 0.6];

/// By how much a probe's change may be scaled up to fit the residuals.
const LARGEST_SCALE: f64 = 1.5;

/// An effect with values of its parameters, tried at an anchor.
pub(super) struct Probe {
    /// Where a fit may start.
    pub start: Model,
    /// Change of the response beyond what fitted parameters take up, in σ.
    pub direction: DVector<f64>,
    /// By how much it would lower χ².
    pub gain: f64,
}

/// Probes of one effect at an anchor, that of the largest gain first.
pub(super) fn probe(
    workbench: &Workbench<'_>,
    anchor: &Anchor,
    effect: &'static dyn Effect,
) -> Vec<Probe> {
    let extended = workbench.extend(&anchor.model, effect);
    let own = extended.parameters_of(extended.effects().len() - 1);
    let ranges = workbench.ranges(effect);
    let mut probes: Vec<Probe> = grid(effect, &ranges)
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
            let scale = (slope / size).clamp(0.0, LARGEST_SCALE);
            let gain = scale * (2.0 * slope - scale * size);
            shrink(&mut model, own.clone(), &ranges, scale);
            Some(Probe { start: model, direction, gain })
        })
        .collect();
    probes.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    probes
}

/// Moves parameters at which the effect vanishes towards there.
fn shrink(model: &mut Model, own: Span<usize>, ranges: &[Range], scale: f64) {
    for (i, range) in own.zip(ranges) {
        if let Some(absent) = range.absent {
            let value = model.value(i);
            model.set(i, absent + scale.max(0.02) * (value - absent));
        }
    }
}

/// Values to try: every combination of a few of each parameter.
fn grid(effect: &dyn Effect, ranges: &[Range]) -> Vec<Vec<f64>> {
    let mut step = 1.4_f64;
    loop {
        let axes: Vec<Vec<f64>> = effect
            .parameters()
            .iter()
            .zip(ranges)
            .map(|(parameter, range)| axis(parameter.coordinate, range, step))
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
fn axis(coordinate: Coordinate, range: &Range, step: f64) -> Vec<f64> {
    let [low, high] = range.likely;
    let ends = || [low, high].into_iter();
    match (coordinate, range.absent) {
        (_, Some(absent)) => ends()
            .filter(|end| (end - absent).abs() > 0.1 * (high - low))
            .flat_map(|end| SIZES.map(|size| absent + size * (end - absent)))
            .collect(),
        (Coordinate::Logarithmic, None) => {
            let ratio = (high / low).ln();
            let count = ((ratio / step.ln()).round() as usize).max(1);
            let at = |i: usize| low * (ratio * (i as f64 + 0.5) / count as f64).exp();
            (0..count).map(at).collect()
        }
        (Coordinate::Linear, None) => {
            let count = if step < 10.0 { 4 } else { 2 };
            let at = |i: usize| low + (high - low) * (i as f64 + 0.5) / f64::from(count);
            (0..count as usize).map(at).collect()
        }
    }
}
