//! Title, verdict and the figures a reader takes away.

use maud::{Markup, html};

use servoscope_core::answers::{Answer, Diagnosis, Identification, Verdict};

use super::Content;
use super::words::{a, confidence, effect, joined, number, per_cent, sentence};

/// What the page is about.
pub(super) fn title(content: &Content<'_>) -> String {
    let what = match content.answer {
        Answer::Identification(_) => "Identification",
        Answer::Diagnosis(_) => "Diagnosis",
    };
    format!("{what} of {}", content.measured.subject())
}

/// Title, origin, verdict and key figures.
pub(super) fn header(content: &Content<'_>, title: &str) -> Markup {
    let Judgement { word, class, text, details } = judgement(content.answer);
    let origin = content.measured.origin();
    html! {
        header {
            h1 { (title) }
            @if !origin.is_empty() { p.origin { (origin.join(" · ")) } }
            div.verdict.(class) {
                p.word { (word) }
                p.lead { (text) }
                @for detail in details { p { (detail) } }
            }
            dl.facts {
                @for (value, name) in facts(content.answer) {
                    div { dt { (name) } dd { (value) } }
                }
            }
        }
    }
}

struct Judgement {
    word: &'static str,
    /// Of the style sheet.
    class: &'static str,
    text: String,
    details: Vec<String>,
}

fn judgement(answer: &Answer) -> Judgement {
    match answer {
        Answer::Identification(answer) => of_fit(answer),
        Answer::Diagnosis(answer) => of_diagnosis(answer),
    }
}

fn of_fit(answer: &Identification) -> Judgement {
    let (word, class, text) = match answer.fit.adequate {
        Some(true) => {
            ("Adequate", "good", "The model explains the measurement to within its noise.")
        }
        Some(false) => {
            ("Not adequate", "bad", "The model leaves more of the measurement than noise.")
        }
        None => (
            "Adequacy unknown",
            "open",
            "How well the model should explain the measurement cannot be said, because its noise \
             is not known.",
        ),
    };
    let detail = (answer.fit.adequate == Some(false)).then(|| {
        "Its parameters absorb what is missing. A diagnosis says where the model is wrong, and \
         why."
            .to_owned()
    });
    Judgement { word, class, text: text.to_owned(), details: detail.into_iter().collect() }
}

fn of_diagnosis(answer: &Diagnosis) -> Judgement {
    let causes = answer.causes.iter().map(|cause| a(&cause.effect)).collect();
    let causes = joined(causes, "and");
    let them = if answer.causes.len() > 1 { "them" } else { "it" };
    let (word, class, text) = match answer.verdict {
        Verdict::Adequate => (
            "Adequate",
            "good",
            "Nothing in this measurement speaks against the simulation.".into(),
        ),
        Verdict::Explained => (
            "Explained",
            "good",
            format!(
                "The simulation misses {causes}. With {them}, it explains the measurement to \
                 within the noise."
            ),
        ),
        Verdict::Improved => (
            "Improved",
            "part",
            format!(
                "The simulation seems to miss {causes}. With {them}, it comes closer to the \
                 measurement, and something remains unexplained."
            ),
        ),
        Verdict::Unexplained => (
            "Unexplained",
            "bad",
            "The simulation is wrong, and no known effect is the cause.".into(),
        ),
    };
    let text = match answer.measurement.len() {
        0 => text,
        1 => format!("The measurement has a fault, which is mended here. {text}"),
        count => format!("The measurement has {count} faults, which are mended here. {text}"),
    };
    let band = answer.valid_band.as_ref().map(|band| sentence(&band.sentence));
    let before = answer.linearity.as_ref().map(|found| sentence(&found.sentence));
    let found = sentence(&answer.discrepancy.sentence);
    let faults = answer.measurement.iter().map(|fault| sentence(&fault.sentence));
    let details = faults.chain(before).chain([found]).chain(band).collect();
    Judgement { word, class, text, details }
}

/// Values and what they are, most important first.
fn facts(answer: &Answer) -> Vec<(String, String)> {
    let base = answer.base();
    let mut facts = Vec::new();
    for cause in answer.causes() {
        let name = format!("{}: {}", effect(&cause.effect), confidence(cause.confidence));
        facts.push((crate::report::causes::per_cent(cause.confidence), name));
    }
    match answer.extended() {
        Some(extended) => {
            let [before, after] = [base, extended].map(|model| per_cent(model.fit.nrmse, 3));
            facts.push((format!("{before} → {after}"), "of the response left by the fit".into()));
        }
        None => {
            let name = "of the response left by the fit".to_owned();
            facts.push((per_cent(base.fit.nrmse, 3), name));
        }
    }
    if let Some(gain) = answer.diagnosis().and_then(|answer| answer.gain.as_ref()) {
        let value = format!("{} ×", number(gain.ratio, 3));
        facts.push((value, "smaller error on data held out".into()));
    }
    if let Some(each) = answer.model().fit.chi2_per_dof {
        facts.push((number(each, 3), "χ² per degree of freedom; 1 is noise".into()));
    }
    facts
}
