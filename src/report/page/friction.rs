//! Friction over velocity.

use maud::html;

use super::figure::figure;
use super::{Content, Section};
use crate::report::figures::Subject;
use crate::report::size::with_interval;

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let model = content.answer.model();
    let moved = Subject {
        identification: Some(model),
        comparison: content.extended.or(content.comparison),
        ..Subject::default()
    };
    let caption = match content.answer.causes().is_empty() {
        true => "Friction of the model over velocity, and the range in which the measurement moved.",
        false => {
            "Friction of the model with the causes over velocity, and the range in which the \
             measurement moved."
        }
    };
    let body = figure("friction", &moved, "", caption);
    if body.0.is_empty() {
        return None;
    }
    let level = |id: &str, way: &str| {
        let estimate = model.parameters.get(id)?;
        Some(format!("{}{way}", with_interval(estimate)))
    };
    let levels = [
        level("fc_plus", " forwards"),
        level("fc_minus", " backwards"),
        level("fc_mean", ", mean of both directions"),
    ];
    let short = levels.into_iter().flatten().collect::<Vec<_>>().join(", ");
    Section::new("friction", "Friction", short, html! { (body) })
}
