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

/// The figure of the first screen: the response before and after, and its errors. Nothing where
/// there is nothing to draw.
pub(super) fn first(content: &Content<'_>) -> Markup {
    let name = with_causes(content.answer.causes());
    let drawn = figures::draw_beside("bode-errors", &content.subject(&name), Format::default(), "");
    html! {
        @if let Ok(svg) = drawn {
            figure.first { div.scroll { (PreEscaped(svg)) } }
        }
    }
}
