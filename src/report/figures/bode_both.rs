//! Frequency responses of two answers in one diagram: each as measured, and as its best model has it.

use servoscope_core::answers::Comparison;

use super::bode::curves::{Curve, curves};
use super::bode::panels;
use super::canvas::{Canvas, Marker};
use super::panel::{Key, Look, legend};
use super::series::{left_out, spread};
use super::{NothingToDraw, Subject, comparison};

/// What the two are called.
const SIDES: [&str; 2] = ["left", "right"];

/// Magnitudes that the legend names.
const MOST_KEYS: usize = 12;

pub(super) fn draw(both: [&Subject<'_>; 2]) -> Result<Canvas, NothingToDraw> {
    let [left, right] = both;
    let comparisons = [comparison(left)?, comparison(right)?];
    let [quantity, other] = comparisons.map(quantities);
    if quantity != other {
        return Err(NothingToDraw(format!(
            "the gains have different units: {quantity} on the left, {other} on the right"
        )));
    }
    let drawn = || SIDES.into_iter().zip(both).zip(comparisons);
    let all: Vec<Curve> =
        drawn().flat_map(|((side, subject), comparison)| best(side, subject, comparison)).collect();
    if all.is_empty() {
        return Err(NothingToDraw("no line of the response is a line of the input".into()));
    }
    let title = format!("Frequency response to {}, both", comparisons[0].response_quantity);
    let says =
        "Points are measured. Lines are the model of each, with the causes where any are named.";
    let mut canvas = Canvas::new("bode-both", &title, says, all.len());
    let measured = Key::new(Look::Marker(Marker::Circle), "key", "measured").toggling("measured");
    let simulated = Key::new(Look::Line("line"), "key", "simulated").toggling("after");
    let mut keys = vec![measured, simulated];
    keys.extend(spread(all.len(), MOST_KEYS).into_iter().map(|index| {
        let class = format!("s{index}");
        Key::new(Look::Line("line"), &class, &all[index].label).toggling(&class)
    }));
    legend(&mut canvas, &keys);
    panels(&mut canvas, comparisons[0], &all, &[]);
    for (side, comparison) in SIDES.into_iter().zip(comparisons) {
        if let Some(sentence) = left_out(comparison) {
            canvas.note(&format!("On the {side}: {sentence}"));
        }
    }
    Ok(canvas)
}

/// What a gain is the ratio of.
fn quantities(comparison: &Comparison) -> String {
    let unit = |unit: &str| if unit.is_empty() { "no unit".to_owned() } else { unit.to_owned() };
    let Comparison { response_quantity, response_unit, input_unit, .. } = comparison;
    format!("{response_quantity} ({}) over input ({})", unit(response_unit), unit(input_unit))
}

/// The curves of one side, with the model that explains its data best as the simulated one.
fn best(side: &str, subject: &Subject<'_>, comparison: &Comparison) -> Vec<Curve> {
    let mut found = curves(comparison, subject.extended.map(|extended| extended.comparison));
    for curve in &mut found {
        curve.label = format!("{side} {}", curve.label);
        for point in &mut curve.points {
            point.simulated = point.extended.take().or(point.simulated);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{diagnosed, extended, record, stepped};
    use super::super::{Theme, draw_both};
    use super::*;

    #[test]
    fn curves_of_both_are_drawn_with_the_best_model_of_each() {
        let (left, right) = (diagnosed(), extended());
        let svg = draw_both([&left.subject(), &right.subject()], Theme::Auto).unwrap();
        roxmltree::Document::parse(&svg).unwrap();
        assert!(svg.contains("id=\"servoscope-bode-both\""), "{svg}");
        let lines = svg.matches("class=\"line\"").count();
        let alone = left.draw("bode").matches("class=\"line\"").count() - 1;
        // Besides those of the curves: one for each curve in the legend, and that of the models.
        let curves = 2 * curves(&left.comparison, None).len();
        assert_eq!(lines, 2 * alone + curves + 1);
        assert!(!svg.contains("class=\"thin\""), "the base model is not among them");
        for side in SIDES {
            assert!(svg.contains(&format!("data-series=\"{side} ")), "{side}: {svg}");
        }
    }

    #[test]
    fn records_and_stepped_sines_are_drawn_together() {
        let (left, right) = (record(), stepped());
        let svg = draw_both([&left.subject(), &right.subject()], Theme::Light).unwrap();
        roxmltree::Document::parse(&svg).unwrap();
    }

    #[test]
    fn gains_of_different_units_are_not_drawn_over_each_other() {
        let (left, mut right) = (diagnosed(), diagnosed());
        right.comparison.input_unit = "N m".into();
        let refused = draw_both([&left.subject(), &right.subject()], Theme::Auto).unwrap_err();
        assert!(refused.0.contains("different units") && refused.0.contains("N m"), "{refused}");
    }
}
