//! What is not linear: what the data tell of it before any model, and the spectra.

use maud::html;

use super::figure::figure;
use super::words::sentence;
use super::{Content, Section};

/// How the sentence begins, now and in answers of earlier versions.
const BEGINS: [&str; 2] = ["from the data alone, without a model: ", "before any model: "];

pub(super) fn section(content: &Content<'_>) -> Option<Section> {
    let linearity = content.answer.diagnosis().and_then(|answer| answer.linearity.as_ref());
    let subject = content.subject("");
    let body = html! {
        @if linearity.is_some() {
            p { "A linear axis answers only at the frequencies that the input has. Symmetric \
                 friction, backlash and saturation add odd multiples; whatever differs between the \
                 two directions adds even ones." }
            (figure("linearity", &subject, "", "The response at lines of the input, and what \
                appears beside them: distortion above the noise."))
        }
        (figure("spectrum", &subject, "", "Harmonics of the response, measured and simulated with \
            the base model, above the noise."))
        (figure("spectrum-after", &subject, "-after", "Harmonics of the response, measured and \
                                                       simulated with the causes, above the noise."))
    };
    if body.0.is_empty() {
        return None;
    }
    let short = linearity.map_or_else(
        || "measured and simulated spectra".to_owned(),
        |found| {
            let said = BEGINS
                .iter()
                .fold(&*found.sentence, |said, begin| said.strip_prefix(begin).unwrap_or(said));
            sentence(said).trim_end_matches('.').to_owned()
        },
    );
    Section::new("harmonics", "Harmonics", short, body)
}
