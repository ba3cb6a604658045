//! What the axis of an error shows, and what lies beyond it.

use super::super::bands::BAND;
use super::super::bode::Model;
use super::super::bode::curves::{Curve, Point, Ratio};
use super::super::canvas::{Anchor, Canvas};
use super::super::panel::Panel;
use super::super::series::counted;
use super::super::text::number;

/// Decibels of a gain that differs from another by a small share of it, per share.
pub(super) const DB_PER_SHARE: f64 = 20.0 * std::f64::consts::LOG10_E;

/// Deviations that the shaded band of the noise reaches.
pub(super) const NOISE_BAND: f64 = 2.0;

/// What one column shows of a ratio.
pub(super) struct Column<'a> {
    pub(super) name: &'a str,
    pub(super) error_name: &'a str,
    pub(super) value: fn(Ratio) -> f64,
    /// Of the ratio for each share by which noise moves it.
    pub(super) per_share: f64,
    pub(super) least_error: f64,
    pub(super) steps: &'static [f64],
    pub(super) range: [f64; 2],
}

/// Errors of a column by one of the models.
fn errors_of<'a>(
    column: &'a Column<'_>,
    curves: &'a [Curve],
    model: Model,
) -> impl Iterator<Item = f64> + 'a {
    let every = curves.iter().flat_map(|curve| &curve.points);
    every.filter_map(move |point| Some((column.value)(point.error(model(point))?).abs()))
}

/// The value that this share of all values does not exceed.
fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut sorted: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1) as f64;
    sorted.get((share * last).round() as usize).copied().unwrap_or(0.0)
}

/// How far the axis of an error reaches: all that the best model leaves where it is valid, and
/// nearly all that the base model does. What lies beyond is said.
pub(super) fn size(column: &Column<'_>, curves: &[Curve], bands: &[[f64; 2]]) -> f64 {
    let is_valid = |point: &&Point| {
        !bands.iter().any(|[from, to]| (*from..=*to).contains(&point.frequency_hz))
    };
    let every = || curves.iter().flat_map(|curve| &curve.points);
    let sizes = |model: Model, share: f64| {
        let error = |point: &Point| Some((column.value)(point.error(model(point))?).abs());
        let valid = quantile(every().filter(is_valid).filter_map(error), share);
        if valid > 0.0 { valid } else { quantile(every().filter_map(error), share) }
    };
    let before = sizes(|point| point.simulated, 0.95);
    let after = sizes(|point| point.extended, 1.0);
    let noise = quantile(every().filter_map(|point| point.noise), 0.5);
    let noise = 1.5 * NOISE_BAND * noise * column.per_share;
    1.2 * before.max(after).max(noise).max(column.least_error)
}

/// Says how far the errors go that the axis does not show.
pub(super) fn beyond(
    canvas: &mut Canvas,
    panel: &Panel,
    column: &Column<'_>,
    curves: &[Curve],
    size: f64,
) {
    let count = |model: Model| errors_of(column, curves, model).filter(|e| *e > size).count();
    let largest = |model: Model| errors_of(column, curves, model).fold(0.0, f64::max);
    let before: Model = |point| point.simulated;
    let after: Model = |point| point.extended;
    let hidden = count(before) + count(after);
    if hidden == 0 {
        return;
    }
    let most = number(largest(before).max(largest(after)), 2);
    let unit = if column.per_share == DB_PER_SHARE { " dB" } else { "°" };
    let points = counted(hidden, "point", "points");
    let text = format!("{points} off scale, up to {most}{unit}");
    canvas.text(panel.right, panel.top - 8.0, BAND, Anchor::End, &text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantile_is_a_value_of_those_given() {
        let values = || [4.0, 1.0, 3.0, 2.0, 5.0, f64::NAN].into_iter();
        assert_eq!([0.0, 0.5, 1.0].map(|share| quantile(values(), share)), [1.0, 3.0, 5.0]);
        assert_eq!(quantile(std::iter::empty(), 0.5), 0.0);
    }
}
