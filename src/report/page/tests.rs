//! What holds for every page, whatever it is of.

mod answers;

use std::collections::BTreeSet;

use roxmltree::{Document, Node, ParsingOptions};
use servoscope_core::answers::sample;
use servoscope_core::answers::{Candidate, Diagnosis, Verdict};

use super::*;

/// A page and the answer it was written of, with every figure that can be drawn.
fn written(answer: &Answer, measured: &Measured) -> String {
    let comparison = sample::comparison();
    page(&Content {
        answer,
        measured,
        comparison: Some(&comparison),
        extended: answer.extended().map(|_| &comparison),
        convergence: &[],
    })
}

fn of(answer: &Diagnosis) -> String {
    written(&answer.clone().into(), &measured())
}

fn measured() -> Measured {
    let text = |text: &str| Some(text.to_owned());
    Measured {
        machine: text("RT-200"),
        axis: text("C"),
        measured_at: text("2026-03-04T10:20:30Z"),
        input: "current".into(),
        input_unit: "A".into(),
        response: "velocity".into(),
        experiments: 18,
        magnitudes: vec![1.0, 2.0, 4.0],
        omegas_rad_s: vec![1.0, 50.0],
        harmonics: [0, 3],
        files: vec![DataFile { name: "c.csv".into(), bytes: 12, sha256: "00ff".into() }],
        ..Measured::default()
    }
}

fn adequate() -> Diagnosis {
    let mut answer = sample::diagnosis();
    answer.verdict = Verdict::Adequate;
    answer.discrepancy.noise_like = true;
    answer.discrepancy.patterns.clear();
    answer.discrepancy.sentence =
        "the simulation explains it; a departure of 0.43 % would have been noticed".into();
    answer
}

fn gained() -> Diagnosis {
    let mut answer = sample::explained();
    answer.gain = Some(sample::gain());
    answer.causes[0].gain = answer.gain.clone();
    answer.candidates[0].heldout_error = Some(0.0124);
    answer.limitations = vec!["harmonic 0 was not measured".into()];
    answer
}

/// One of each verdict.
fn diagnoses() -> [Diagnosis; 4] {
    let improved = Diagnosis { verdict: Verdict::Improved, ..sample::explained() };
    [adequate(), gained(), improved, sample::diagnosis()]
}

fn parsed(page: &str) -> Document<'_> {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    Document::parse_with_options(page, options).unwrap_or_else(|error| panic!("{error}: {page}"))
}

/// Everything a reader sees, styles and script aside.
fn read(page: &str) -> String {
    let document = parsed(page);
    let is_style = |node: &Node<'_, '_>| {
        node.ancestors().any(|n| n.has_tag_name("style") || n.has_tag_name("script"))
    };
    let texts = document.descendants().filter(|node| node.is_text() && !is_style(node));
    texts.filter_map(|node| node.text()).collect::<Vec<_>>().concat()
}

fn sections(page: &str) -> Vec<String> {
    let document = parsed(page);
    let found = document.descendants().filter(|node| node.has_tag_name("details"));
    found.map(|node| node.attribute("id").unwrap().to_owned()).collect()
}

fn check(page: &str) {
    let document = parsed(page);
    let mut ids = BTreeSet::new();
    for id in document.descendants().filter_map(|node| node.attribute("id")) {
        assert!(ids.insert(id), "two elements have the id {id}");
    }
    for node in document.descendants().filter(Node::is_element) {
        let name = node.tag_name().name();
        assert!(!["link", "img", "iframe", "object"].contains(&name), "<{name}>");
        for attribute in node.attributes() {
            let (key, value) = (attribute.name(), attribute.value());
            assert!(!key.starts_with("on") && key != "src", "{key}={value}");
            if key == "href" || key == "clip-path" || key == "aria-labelledby" {
                let value = value.trim_start_matches("url(").trim_end_matches(')');
                for target in value.split(' ').map(|id| id.trim_start_matches('#')) {
                    assert!(ids.contains(target), "{key}={value} leads nowhere");
                }
            }
        }
    }
    for outside in ["@import", "url(h", "url(\"", "url('", "url(/"] {
        assert!(!page.contains(outside), "{outside}");
    }
    let scripts = document.descendants().filter(|node| node.has_tag_name("script"));
    let texts: Vec<&str> = scripts.filter_map(|node| node.text()).collect();
    assert_eq!(texts, [script::inline().replace("<![CDATA[", "").replace("]]>", "").as_str()]);
    // A name space is a name, nothing is fetched from there.
    let named = page.matches("http://www.w3.org/2000/svg").count();
    assert_eq!(page.matches("http").count(), named, "something is fetched");
}

#[test]
fn every_page_is_well_formed_and_needs_nothing_from_outside() {
    for answer in diagnoses() {
        check(&of(&answer));
    }
    let mut answer = sample::identification();
    for adequate in [Some(true), Some(false), None] {
        answer.fit.adequate = adequate;
        check(&written(&answer.clone().into(), &measured()));
    }
}

#[test]
fn a_page_with_everything_has_every_section_in_the_order_in_which_it_is_asked_for() {
    let page = of(&gained());
    let ids =
        ["sure", "rivals", "departure", "friction", "harmonics", "computed", "model", "provenance"];
    assert_eq!(sections(&page), ids);
    // Bode twice (once for a phone), friction, linearity, and spectrum and residuals before and after.
    assert_eq!(page.matches("<figure").count(), 8, "{page}");
    assert!(page.contains("servoscope-residuals-after"));
}

#[test]
fn each_folded_section_says_its_answer_in_short() {
    let page = of(&gained());
    let document = parsed(&page);
    let shorts = document.descendants().filter(|node| node.attribute("class") == Some("short"));
    let shorts: Vec<&str> = shorts.filter_map(|node| node.text()).collect();
    assert_eq!(shorts.len(), sections(&page).len());
    for part in ["residual ÷ 3.15", "Stribeck friction or presliding", "62\u{a0}%", "10.02"] {
        assert!(shorts.iter().any(|short| short.contains(part)), "{part}: {shorts:?}");
    }
}

#[test]
fn no_sentence_stands_on_a_page_twice() {
    for answer in [gained(), adequate(), sample::mended(), sample::diagnosis()] {
        let page = of(&answer);
        let document = parsed(&page);
        let texts = document.descendants().filter(|node| node.is_text());
        let of_text = |node: &Node<'_, '_>| {
            !node.ancestors().any(|n| ["svg", "style", "script"].iter().any(|t| n.has_tag_name(*t)))
        };
        let mut seen = BTreeSet::new();
        let texts = texts.filter(of_text).filter_map(|node| node.text()).collect::<Vec<_>>();
        for text in texts.iter().flat_map(|text| text.split(". ")) {
            let text = text.trim().trim_end_matches('.').to_lowercase();
            // A few words are a name.
            if text.split(' ').count() > 7 {
                assert!(seen.insert(text.clone()), "twice: {text}");
            }
        }
    }
}

#[test]
fn what_a_user_wrote_is_shown_not_obeyed() {
    const EVIL: &str = "</style><script>alert(1)</script> & \"quoted\" 'too' \u{1b}[0m";
    let evil = || Some(EVIL.to_owned());
    let mut answer = gained();
    answer.causes[0].explanation = EVIL.into();
    answer.causes[0].parameters[0].unit = EVIL.into();
    answer.discrepancy.sentence = EVIL.into();
    answer.discrepancy.patterns[0].sentence = EVIL.into();
    answer.limitations.push(EVIL.into());
    answer.candidates.push(Candidate { rejected: evil(), ..answer.candidates[0].clone() });
    let measured = Measured {
        name: evil(),
        machine: evil(),
        axis: evil(),
        measured_at: evil(),
        operator: evil(),
        labels: vec![(EVIL.into(), EVIL.into())],
        input: EVIL.into(),
        input_unit: EVIL.into(),
        notes: vec![EVIL.into()],
        files: vec![DataFile { name: EVIL.into(), bytes: 1, sha256: "0".into() }],
        ..measured()
    };
    let page = written(&answer.into(), &measured);
    check(&page);
    assert!(!page.contains("<script>") && !page.contains('\u{1b}'));
    assert!(
        read(&page).contains("</style><script>alert(1)</script> & \"quoted\" 'too' \u{fffd}[0m")
    );
}

#[test]
fn without_its_files_a_page_has_the_answer_and_no_figures_of_them() {
    let measured = Measured::default();
    let page = page(&Content {
        answer: &sample::explained().into(),
        measured: &measured,
        comparison: None,
        extended: None,
        convergence: &[],
    });
    check(&page);
    let text = read(&page);
    assert!(text.contains("Diagnosis of a servo axis") && text.contains("0.8014"), "{text}");
    assert!(!text.contains("Experiments"), "{text}");
}
