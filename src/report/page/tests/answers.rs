//! What a page says of each sort of answer.

use servoscope_core::answers::ReadingDoubt;

use super::*;

#[test]
fn every_verdict_is_one_plain_sentence() {
    let sentences = [
        "This measurement shows no error in the simulation.",
        "The simulation lacks static friction; with it added, it matches the measurement",
        "but something remains unexplained.",
        "The simulation is wrong. No effect of the library improves it by more than chance.",
    ];
    for (answer, sentence) in diagnoses().iter().zip(sentences) {
        let text = read(&of(answer));
        assert!(text.contains(sentence), "{sentence}: {text}");
        assert!(text.contains("Diagnosis of RT-200, axis C"), "{text}");
        assert!(text.contains("measured 2026-03-04 10:20 UTC"), "{text}");
    }
}

#[test]
fn an_adequate_page_says_how_small_a_departure_would_have_been_noticed() {
    let page = of(&adequate());
    assert!(read(&page).contains("a departure of 0.43\u{a0}% would have been noticed."));
    assert!(!page.contains("card cause") && !page.contains("card gain"), "{page}");
}

#[test]
fn a_cause_has_its_physics_its_confidence_and_its_intervals() {
    let text = read(&of(&sample::explained()));
    for part in [
        "93\u{a0}%",
        "very likely",
        "Breakaway takes more torque than sliding.",
        "0.8014 ± 0.0065\u{a0}A",
        "not determined",
        "cannot tell it from Stribeck friction or presliding",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

// What to do next stays on the first screen.
#[test]
fn the_numbers_of_a_cause_that_is_but_possible_beside_a_likely_one_are_folded() {
    let mut answer = sample::explained();
    answer.causes.push(answer.causes[0].clone());
    let before_next = |answer: &Diagnosis| {
        let text = read(&of(answer));
        let (before, _) = text.split_once("What to do next").unwrap();
        before.matches("0.8014 ± 0.0065").count()
    };
    assert_eq!(before_next(&answer), 2);
    answer.causes[1].confidence = 0.2;
    assert_eq!(before_next(&answer), 1);
    assert_eq!(read(&of(&answer)).matches("0.8014 ± 0.0065").count(), 2);
}

#[test]
fn the_gain_is_said_and_where_it_is_not_measured_that_is_said() {
    let text = read(&of(&gained()));
    for part in [
        "3.90\u{a0}% → 1.24\u{a0}% of the response",
        "Residual ÷ 3.15",
        "95\u{a0}% interval 2.71 to 3.64",
        "Held out: every third frequency.",
        "held-out residual, %",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let text = read(&of(&sample::explained()));
    assert!(text.contains("the improvement on held-out data was not measured"), "{text}");
    assert!(!text.contains("held-out residual, %"), "{text}");
    let mut worse = gained();
    let gain = worse.gain.as_mut().unwrap();
    (gain.ratio, gain.interval95) = (0.9, [0.7, 1.1]);
    let text = read(&of(&worse));
    assert!(
        text.contains("Residual × 1.11") && text.contains("This improvement may be due to chance"),
        "{text}"
    );
}

#[test]
fn rivals_lose_for_a_reason_in_words() {
    let text = read(&of(&sample::explained()));
    assert!(text.contains("Static friction explains the data better."), "{text}");
    assert!(text.contains("Named as a cause."), "{text}");
    let experiment = "Measure at magnitude 1.25 A and 0.318 Hz: there the predictions of static \
                      friction and Stribeck friction differ most.";
    assert!(text.contains(experiment), "{text}");
}

#[test]
fn a_fault_of_the_measurement_is_told_before_all_else_with_what_mends_it() {
    let page = of(&sample::mended());
    let text = read(&page);
    let position = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part}: {text}"));
    assert!(position("The measurement has a fault") < position("Fault of the measurement"));
    assert!(position("To correct it: measure again what is listed") < position("What to do next"));
    assert!(!read(&of(&sample::diagnosis())).contains("Fault of the measurement"));
}

// What to do next stays on the first screen, however much there is to say of the measurement.
#[test]
fn doubts_of_a_measurement_are_folded_to_the_first_of_them() {
    let mut answer = sample::explained();
    let doubt = |sentence: &str| ReadingDoubt {
        check: "closed_loop".into(),
        sentence: sentence.into(),
        remedy: "add the line `# loop: closed`".into(),
    };
    answer.base.doubts = vec![doubt("the input varies"), doubt("the phase rises")];
    let page = of(&answer);
    let (start, end) = (page.find("<details class=\"card bad\"").unwrap(), "</details>");
    let card = &page[start..start + page[start..].find(end).unwrap()];
    let (summary, folded) = card.split_once("</summary>").unwrap();
    assert!(!summary.contains(" open") && summary.contains("The input varies"), "{summary}");
    assert!(!summary.contains("The phase rises") && folded.contains("The phase rises"), "{card}");
    assert_eq!(folded.matches("# loop: closed").count(), 2);
}
