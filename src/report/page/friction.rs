//! Friction over velocity.

use maud::html;

use super::figure::figure;
use super::{Content, Section};
use crate::report::size::with_interval;

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let model = content.answer.model();
    let subject = content.subject("");
    let body = match content.extended {
        None => figure(
            "friction",
            &subject,
            "",
            "Friction of the model over velocity, and the range in which the measurement moved.",
        ),
        Some(_) => figure(
            "friction-after",
            &subject,
            "-after",
            "Friction of the model with the causes over velocity, and the range in which the \
             measurement moved.",
        ),
    };
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
