//! What the data tell before any model.

use maud::html;

use super::figure::figure;
use super::words::sentence;
use super::{Content, Section};

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let found = content.answer.diagnosis()?.linearity.as_ref()?;
    let body = html! {
        p.lead { (sentence(&found.sentence)) }
        p { "A linear axis answers only at the frequencies that the input has. Symmetric friction, \
             play and saturation answer at odd multiples as well, whatever differs between the two \
             directions at even ones." }
        (figure("linearity", &content.subject(""), "", "The response at lines of the input, and \
            what appears beside them: distortion above the noise."))
    };
    Section::new("linearity", "What the data tell before any model", body)
}
