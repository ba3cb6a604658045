//! JSON uploads.

use super::*;

const ROW: &str = r#"{"magnitude":1,"omega_rad_s":2,"harmonic":1,"re":0.5,"im":-0.5}"#;

#[test]
fn rows_columns_experiments_and_a_bare_array_are_the_same_table() {
    let csv = ok("magnitude,omega_rad_s,harmonic,re,im\n1,2,1,0.5,-0.5\n");
    for text in [
        format!("[{ROW}]"),
        format!(r#"{{"rows":[{ROW}]}}"#),
        r#" {"columns":{"magnitude":[1],"omega_rad_s":[2],"harmonic":[1],"re":[0.5],"im":[-0.5]}}"#
            .to_owned(),
        r#"{"experiments":[{"magnitude":1,"omega_rad_s":2,
            "harmonics":[{"harmonic":1,"re":0.5,"im":-0.5,"std":null}]}]}"#
            .to_owned(),
    ] {
        assert_eq!(ok(&text).experiments(), csv.experiments(), "{text}");
    }
}

#[test]
fn metadata_stands_at_the_top_or_beside() {
    let m = ok(&format!(
        r#"{{"axis":"X","amplitude":"peak-to-peak","colour":["red"],
            "metadata":{{"response":"position m","labels":{{"shift":"night","bay":3}}}},
            "label.a":"b","rows":[{ROW}]}}"#
    ));
    let metadata = m.metadata();
    assert_eq!(metadata.axis.as_deref(), Some("X"));
    assert_eq!(metadata.response_kind, ResponseKind::Position);
    assert_eq!(metadata.labels.len(), 3);
    assert_eq!(metadata.labels["bay"], "3");
    assert_eq!(m.experiments()[0].magnitude, 0.5);
    assert_eq!(m.notes(), ["colour is unknown and not used"]);
}

#[test]
fn a_key_in_upper_case_is_metadata_in_json_too() {
    let m = ok(&format!(r#"{{"Response":"position m","Amplitude":1,"rows":[{ROW}]}}"#));
    assert_eq!(m.metadata().response_kind, ResponseKind::Position);
    assert_eq!(m.notes(), ["Amplitude is unknown and not used"]);
}

#[test]
fn records_and_tables_stand_side_by_side_in_their_order() {
    let csv = record(100, 3);
    let column = |index: usize| {
        let cells: Vec<&str> =
            csv.lines().skip(1).map(|row| row.split(',').nth(index).unwrap()).collect();
        // These numbers have one leading zero at most, so they are valid JSON.
        format!("[{}]", cells.join(","))
    };
    let (time, input, output) = (column(0), column(1), column(2));
    let sampled = format!(
        r#"{{"time_s":{time},"input":{input},"output":{output},"period_s":0.1,
            "settle_periods":1,"run":4}}"#
    );
    let table = r#"{"magnitude":3,"frequency_hz":1,"run":2,"note":"?","harmonics":[
        {"harmonic":0,"re":0.1},{"harmonic":1,"re":1,"im":2,"std":0.1,"u_re":3,"u_im":0}]}"#;
    let m = ok(&format!(r#"{{"experiments":[{sampled},{table},{table}]}}"#));
    let [first, second, third] = m.experiments() else { panic!("three experiments") };
    assert_eq!((first.repeats.len(), first.run), (2, Some(4.0)));
    assert_eq!((second.magnitude, second.run), (3.0, Some(2.0)));
    assert_eq!(second, third);
    assert_eq!(m.notes().iter().filter(|note| note.contains("note")).count(), 1);
    let columns = ok(&format!(
        r#"{{"period_s":0.1,"settle_periods":"1",
            "columns":{{"time_s":{time},"input":{input},"output":{output}}}}}"#
    ));
    assert_eq!(columns.experiments()[0].response, first.response);
}

#[test]
fn what_is_wrong_is_named_by_its_path() {
    let experiment = |inner: &str| format!(r#"{{"experiments":[{{"harmonics":[]}},{{{inner}}}]}}"#);
    let harmonics = r#""harmonics":[{"harmonic":1,"re":1,"im":"x"}]"#;
    for (text, column, word) in [
        (format!("[{ROW},{ROW}]"), "[1].harmonic", "already given at [0]"),
        (ROW.replace("-0.5", "\"a\""), "", "rows, columns and experiments"),
        (format!("[{}]", ROW.replace("-0.5", "\"a\"")), "[0].im", "a string"),
        (format!(r#"{{"rows":[{}]}}"#, ROW.replace('2', "-2")), "rows[0].omega_rad_s", "positive"),
        (format!(r#"{{"rows":[{ROW},3]}}"#), "rows[1]", "an object is needed"),
        (r#"{"rows":[]}"#.into(), "rows", "no row"),
        (r#"{"rows":{}}"#.into(), "rows", "an array is needed"),
        (format!(r#"{{"rows":[{ROW}],"columns":{{}}}}"#), "columns", "contradict"),
        (r#"{"columns":{"re":[1,2],"im":[1]}}"#.into(), "columns.im", "1 elements"),
        (r#"{"columns":{"re":[1],"im":[1]}}"#.into(), "columns.omega_rad_s", "missing"),
        (
            r#"{"columns":{"magnitude":[1],"omega_rad_s":[1],"re":[1],"im":[true]}}"#.into(),
            "columns.im[0]",
            "a boolean",
        ),
        (experiment(harmonics), "experiments[0].harmonics.re", "missing"),
        (
            format!(r#"{{"experiments":[{{"magnitude":1,"omega_rad_s":1,{harmonics}}}]}}"#),
            "experiments[0].harmonics[0].im",
            "a string",
        ),
        (r#"{"experiments":[{}]}"#.into(), "experiments[0]", "time_s,input,output or harmonics"),
        (r#"{"experiments":[]}"#.into(), "experiments", "empty"),
        (
            r#"{"experiments":[{"time_s":[0,1,1],"input":[1,2,3],"output":[1,2,3]}]}"#.into(),
            "experiments[0].time_s[2]",
            "does not increase",
        ),
        (
            r#"{"experiments":[{"time_s":[0],"input":[1],"output":[1],"period_s":-1}]}"#.into(),
            "experiments[0].period_s",
            "positive",
        ),
        (format!(r#"{{"loop":true,"rows":[{ROW}]}}"#), "loop", "a string or a number"),
        (format!(r#"{{"labels":{{"a\nb":"c"}},"rows":[{ROW}]}}"#), "label.a\nb", "line break"),
        (format!(r#"{{"metadata":{{"loop":"?"}},"rows":[{ROW}]}}"#), "metadata.loop", "open"),
    ] {
        refused(&text, None, column, word);
    }
}

#[test]
fn broken_json_is_refused_with_its_line() {
    refused("[\n{\"re\": 1,\n}]", 3, "", "not JSON");
    refused("[1e999]", 1, "", "out of range");
    refused(&"[".repeat(100_000), 1, "", "recursion limit");
}
