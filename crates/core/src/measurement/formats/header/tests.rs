//! Metadata: their keys and values.

use super::keys::quantity;
use super::*;
use crate::measurement::{Loop, Quantity, ResponseKind};

fn header(key: &str, value: &str) -> Header {
    let mut header = Header::default();
    assert_eq!(header.set(Some(1), key, value), Ok(true));
    header
}

#[test]
fn a_quantity_is_a_name_and_a_unit() {
    let of = |text| {
        let Quantity { name, unit } = quantity(text);
        (name, unit)
    };
    assert_eq!(of("current A"), ("current".into(), "A".into()));
    assert_eq!(of("torque N m"), ("torque".into(), "N m".into()));
    assert_eq!(of("motor current [A]"), ("motor current".into(), "A".into()));
    assert_eq!(of("force (N)"), ("force".into(), "N".into()));
    assert_eq!(of("voltage"), ("voltage".into(), String::new()));
}

#[test]
fn every_header_key_sets_its_own_field() {
    assert_eq!(header("name", "axis test").metadata.name.as_deref(), Some("axis test"));
    assert_eq!(header("machine", "mill 3").metadata.machine.as_deref(), Some("mill 3"));
    assert_eq!(header("axis", "X").metadata.axis.as_deref(), Some("X"));
    assert_eq!(header("operator", "Ada").metadata.operator.as_deref(), Some("Ada"));
    assert_eq!(header("label.shift", "night").metadata.labels["shift"], "night");
    assert_eq!(header("loop", "closed").metadata.feedback, Some(Loop::Closed));
    assert_eq!(header("settle_periods", "2").settle_periods, Some(2));
    assert_eq!(header("averages", "16").averages, Some(16.0));
    assert_eq!(header("magnitude", "0.5").magnitude, Some(0.5));
    assert!(header("inverted", "yes").inverted && !header("inverted", "no").inverted);
    assert_eq!(header("sample_s", "0.001").sample_s, Some(0.001));
    assert_eq!(header("decimal", "comma").decimal, Some(Mark::Comma));
    assert_eq!(header("column_names", "a, b c,").column_names.unwrap(), ["a", "b c", ""]);
    assert_eq!(header("column_names", "Gain, dB;;b").column_names.unwrap(), ["Gain, dB", "", "b"]);
    assert_eq!(header("period_s", "6.24").period_s, Some(6.24));
    assert!(header("period_s", "none").aperiodic);
    assert_eq!(header("intersample", "hold").intersample, Some(Intersample::Hold));
    assert_eq!(header("initial_velocity", "-0.5").beginning.velocity, Some(-0.5));
    assert_eq!(header("initial_position", "2").beginning.position, Some(2.0));
    assert_eq!(header("settle_s", "0").beginning.settle_s, Some(0.0));
    assert_eq!(header("response", "Position m").metadata.response_kind, ResponseKind::Position);
    let measured_at = header("measured_at", "2024-05-31T13:45:00+02:00").metadata.measured_at;
    assert_eq!(measured_at, Some("2024-05-31T11:45:00Z".parse().unwrap()));
}

#[test]
fn a_value_that_means_nothing_is_refused_with_its_line_and_key() {
    for (key, value) in [
        ("response", "temperature K"),
        ("response", "velocity rad"),
        ("response", "position [m/s]"),
        ("measured_at", "yesterday"),
        ("loop", "half"),
        ("reference", "tan"),
        ("amplitude", "loud"),
        ("period_s", "-1"),
        ("period_s", "NaN"),
        ("settle_periods", "1.5"),
        ("averages", "0"),
        ("averages", "inf"),
        ("averages", "many"),
        ("settle_periods", "1e300"),
        ("settle_s", "-1"),
        ("initial_velocity", "fast"),
        ("initial_position", "inf"),
        ("intersample", "cubic"),
        ("magnitude", "0"),
        ("decimal", "dot"),
        ("inverted", "half"),
        ("sample_s", "0"),
        ("sheet", ""),
        ("column_names", "a"),
    ] {
        let fault = Header::default().set(Some(7), key, value).unwrap_err().in_file("f.csv");
        assert_eq!((fault.line, fault.column.as_deref()), (Some(7), Some(key)), "{fault}");
    }
}

#[test]
fn a_key_given_twice_with_two_values_is_refused() {
    let mut header = header("axis", "X");
    assert_eq!(header.set(Some(2), "axis", "X"), Ok(true));
    assert!(header.set(Some(3), "axis", "Y").is_err());
}

#[test]
fn what_is_given_beside_the_file_holds_and_a_note_says_so() {
    let mut given = Given::default();
    given.set("axis", "Y").unwrap();
    given.set("loop", "open").unwrap();
    let (mut header, mut notes) = (header("axis", "X"), Vec::new());
    header.take(&given, &mut notes).unwrap();
    assert_eq!(header.metadata.axis.as_deref(), Some("Y"));
    assert_eq!(header.metadata.feedback, Some(Loop::Open));
    assert!(notes.len() == 1 && notes[0].contains("not `X`"), "{notes:?}");
}

#[test]
fn metadata_has_a_size_and_what_is_unknown_is_only_passed_over() {
    let mut header = Header::default();
    let long = "x".repeat(MAX_METADATA + 1);
    assert!(header.set(Some(3), "machine", &long).is_err());
    assert!(header.set(None, "machine", &long[1..]).unwrap());
    assert!(header.set(None, &format!("label.{long}"), "north").is_err());
    assert!(header.set(None, "machine", "press\0").is_err());
    assert!(header.set(None, "label.site\0", "north").is_err());
    assert!(!header.set(None, "remark", &long).unwrap());
    let mut header = Header::default();
    for label in 0..MAX_LABELS {
        header.set(None, &format!("label.{label}"), "a").unwrap();
    }
    assert!(header.set(None, "label.more", "a").is_err());
}

#[test]
fn a_column_tells_what_the_metadata_does_not_and_may_not_contradict_it() {
    let mut silent = Header::default();
    silent.infer("response", "position mm", "Lage (mm)").unwrap();
    assert_eq!(silent.metadata.response_kind, ResponseKind::Position);
    assert_eq!(silent.metadata.response.unit, "mm");
    let mut without_unit = header("input", "force");
    without_unit.infer("input", "current [A]", "I (A)").unwrap();
    assert_eq!(without_unit.metadata.input, Quantity { name: "force".into(), unit: "A".into() });
    for (key, stated, told) in [
        ("response", "velocity rad/s", "position rad"),
        ("response", "position m", "position mm"),
        ("input", "current A", "current [mA]"),
    ] {
        let error = header(key, stated).infer(key, told, "c").unwrap_err().in_file("f");
        assert!(error.reason.contains(stated), "{error}");
    }
}

#[test]
fn upper_and_lower_case_of_a_key_do_not_matter() {
    assert_eq!(header("Response", "position mm").metadata.response_kind, ResponseKind::Position);
    assert_eq!(header("MAGNITUDE", "0,5").magnitude, Some(0.5));
    assert!(header("Period_s", "None").aperiodic);
    assert_eq!(header("Loop", "Closed").metadata.feedback, Some(Loop::Closed));
    assert_eq!(header("Label.Shift", "night").metadata.labels["Shift"], "night");
    assert!(header("Axis", "X").states("axis"));
    assert!(header("Axis", "X").set(None, "axis", "Y").is_err());
    assert!(Header::default().set(Some(1), "Response", "temperature K").is_err());
    assert!(Header::default().set(Some(1), "Amplitude", "loud").is_err());
}

#[test]
fn a_setting_of_an_instrument_is_no_metadata() {
    for (key, value) in [("Amplitude", "1 V"), ("Reference", "-10 dBm"), ("Loop", "3")] {
        assert_eq!(Header::default().set(Some(1), key, value), Ok(false), "{key}");
    }
    assert!(Header::default().set(Some(1), "amplitude", "1 V").is_err());
}

#[test]
fn an_unknown_key_is_said_to_be_unknown() {
    assert_eq!(Header::default().set(Some(1), "temperature", "25"), Ok(false));
}
