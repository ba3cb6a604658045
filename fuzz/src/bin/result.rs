//! Results as `show`, `validate` and `rerun` read them back: refused, or shown in every form and
//! tried on a measurement. What was read can be written and read again.
#![no_main]

use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use servoscope::report;
use servoscope::report::figures::{self, Theme};
use servoscope::report::page::{Content, page};
use servoscope::service::{BuiltIn, Compared, Numerics as _, measured};
use servoscope_core::answers::Answer;
use servoscope_core::measurement::Measurement;
use servoscope_core::measurement::formats::{Source, read};
use servoscope_core::observer::Silent;

const TABLE: Source<'_> = Source {
    name: "axis.csv",
    bytes: b"magnitude,omega_rad_s,harmonic,re,im\n\
        1,2,1,0.35,-0.08\n1,8,1,0.22,-0.19\n2,2,1,1.28,-0.27\n2,8,1,0.81,-0.66\n",
};

static MEASUREMENT: LazyLock<Measurement> =
    LazyLock::new(|| read(&[TABLE]).expect("it is a table"));

fuzz_target!(|text: &[u8]| {
    let Ok(text) = std::str::from_utf8(text) else { return };
    let answer = match Answer::from_json(text) {
        Ok(answer) => answer,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return;
        }
    };
    let written = serde_json::to_string(&answer).expect("it is JSON");
    assert_eq!(Answer::from_json(&written).expect("it was read before"), answer);

    let _ = report::summary(&answer, 80);
    let _ = report::answer(&answer, 80);
    let compared = Compared::of(&BuiltIn, Ok(&MEASUREMENT), &answer);
    let subject = compared.subject(&answer, &[]);
    for name in figures::names() {
        if let Err(error) = figures::draw(name, &subject, Theme::Auto) {
            assert!(!error.to_string().is_empty());
        }
    }
    let _ = page(&Content {
        answer: &answer,
        measured: &measured(Some(&MEASUREMENT), &[TABLE]),
        comparison: compared.base.as_ref().ok(),
        extended: compared.extended.as_ref(),
        convergence: &[],
    });
    match BuiltIn.validate(&answer, &MEASUREMENT, &Silent) {
        Ok(validation) => assert!(!report::validation(&validation).is_empty()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
