//! Figures with their captions.

use maud::{Markup, PreEscaped, html};

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
