//! A coarse grid over the likely ranges: the starting points of effects that list none of their own.

use crate::effects::{Coordinate, Effect, Range};

/// Sizes of an effect on the grid, as shares of the way from where it vanishes to the end of its
/// likely range: for effects with one, two, and more parameters. The other parameters set its shape.
const SIZES: [&[f64]; 3] = [&[0.05, 0.2, 0.5, 0.8], &[0.15, 0.6], &[0.15]];

/// At most `most` points: all combinations of a few values of each parameter.
pub(crate) fn of(effect: &dyn Effect, ranges: &[Range], most: usize) -> Vec<Vec<f64>> {
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
        if count <= most || step > 100.0 {
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

/// A few values of one parameter; logarithmic ones are spaced by about the factor `step`.
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
        (Coordinate::Linear | Coordinate::Angle, _) => {
            let count = if step < 10.0 { 4 } else { 2 };
            let at = |i: usize| low + (high - low) * (i as f64 + 0.5) / f64::from(count);
            (0..count as usize).map(at).collect()
        }
    }
}
