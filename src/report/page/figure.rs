//! Figures with their captions.

use maud::{Markup, PreEscaped, html};

use super::Content;
use super::words::with_causes;
use crate::report::figures::{self, Format, Subject};

/// The figure of this name with a caption; nothing where there is nothing to
/// draw. `suffix` tells several figures of one name apart.
pub(super) fn figure(name: &str, subject: &Subject<'_>, suffix: &str, caption: &str) -> Markup {
    let Ok(svg) = figures::draw_beside(name, subject, Format::default(), suffix) else {
        return html! {};
    };
    html! {
        figure {
            div.scroll { (PreEscaped(svg)) }
            figcaption { (caption) }
        }
    }
}

/// The figure of the first screen: the response before and after, and its errors; and the same for a
/// phone, of which the style sheet shows one. Nothing where there is nothing to draw.
pub(super) fn first(content: &Content<'_>) -> Markup {
    let name = with_causes(content.answer.causes());
    let subject = content.subject(&name);
    let wide = figures::draw_beside("bode-errors", &subject, Format::default(), "");
    let phone = figures::draw_for_phone(&subject, Format::default());
    html! {
        @if let (Ok(wide), Ok(phone)) = (wide, phone) {
            figure.first { div.scroll { (PreEscaped(wide)) } }
            figure.phone { div.scroll { (PreEscaped(phone)) } }
        }
    }
}
