//! Refused files, with the location and reason of the error.

use super::*;

const HEADER: &str = "magnitude,omega_rad_s,harmonic,re,im\n";

#[track_caller]
fn row_refused(row: &str, column: &str, word: &str) {
    refused(&format!("# axis: X\n{HEADER}1,1,1,1,0\n\n{row}\n"), 5, column, word);
}

#[test]
fn a_cell_that_is_no_finite_number_is_refused() {
    row_refused("1,2,1,NaN,0", "re", "finite");
    row_refused("1,2,1,0,inf", "im", "finite");
    row_refused("1,2,1,0,1e999", "im", "finite");
    row_refused("1,2,1,O.5,0", "re", "`O.5` is not a number");
    row_refused("1,2,1,,0", "re", "missing");
    row_refused("1,2,1,,", "re", "missing");
    row_refused(",2,1,1,0", "magnitude", "missing");
}

#[test]
fn numbers_that_mean_nothing_are_refused() {
    row_refused("-1,2,1,1,0", "magnitude", "negative");
    row_refused("1,0,1,1,0", "omega_rad_s", "positive");
    row_refused("1,-3,1,1,0", "omega_rad_s", "positive");
    row_refused("1,2,-1,1,0", "harmonic", "integer");
    row_refused("1,2,1.5,1,0", "harmonic", "integer");
    row_refused("1,2,100001,1,0", "harmonic", "100000");
    row_refused("1,2,1e300,1,0", "harmonic", "large");
    row_refused("1,2,,1,0", "harmonic", "missing");
    refused("magnitude,frequency_hz,re,im\n1,0,1,0\n", 2, "frequency_hz", "positive");
    refused("magnitude,frequency_hz,re,im\n1,1e308,1,0\n", 2, "frequency_hz", "finite");
    for std in ["0", "-1"] {
        let text = format!("magnitude,omega_rad_s,re,im,std\n1,1,1,0,{std}\n");
        refused(&text, 2, "std", "positive");
    }
    refused("magnitude,omega_rad_s,amplitude,phase_deg\n1,1,-1,0\n", 2, "amplitude", "negative");
    refused("magnitude,omega_rad_s,repeat,re,im\n1,1,0.5,1,0\n", 2, "repeat", "integer");
    refused("magnitude,omega_rad_s,gain_db,phase_deg\n1,1,9e9,0\n", 2, "gain_db", "too large");
}

#[test]
fn a_row_given_twice_is_refused_whatever_its_run() {
    row_refused("1,1,1,2,0", "harmonic", "line 3");
    let text = "magnitude,omega_rad_s,run,re,im\n1,1,0,1,0\n1,1,1,1,0\n";
    refused(text, 3, "harmonic", "already given at line 2");
    let text = "magnitude,omega_rad_s,repeat,re,im\n1,1,0,1,0\n1,1,1,1,0\n1,1,1,1,0\n";
    refused(text, 4, "harmonic", "already given at line 3");
}

#[test]
fn a_mean_of_the_input_is_stated_once() {
    let text = "magnitude,omega_rad_s,harmonic,re,im,bias,u_re,u_im\n\
        1,1,0,1,0,3,3,0\n1,1,1,1,0,3,1,0\n";
    refused(text, 2, "bias", "give one of them");
    let text =
        "experiment,magnitude,omega_rad_s,harmonic,re,im,bias\n0,1,1,0,1,0,3\n0,1,1,1,1,0,2\n";
    refused(text, 3, "bias", "bias 2 differs from 3");
}

#[test]
fn a_missing_column_is_named_with_its_alternatives() {
    refused("omega_rad_s,re,im\n1,1,0\n", 1, "magnitude", "u_re,u_im");
    refused("# a\nmagnitude,re,im\n1,1,0\n", 2, "omega_rad_s", "frequency_hz");
    refused("magnitude,omega_rad_s\n1,1\n", 1, "re", "gain_db,phase_deg");
    refused("magnitude,omega_rad_s,re\n1,1,0\n", 1, "im", "missing");
    refused("magnitude,omega_rad_s,gain\n1,1,0\n", 1, "phase_deg", "missing");
    refused("magnitude,omega_rad_s,re,im,u_re\n1,1,0,0,0\n", 1, "u_im", "missing");
    refused("time_s,input\n0,1\n", 1, "output", "missing");
    refused("a,b\n0,1\n", 1, "", "no known column");
}

#[test]
fn contradictory_columns_are_refused() {
    let rows = "1,1,1,1,1\n";
    let all = |columns: &str| format!("magnitude,{columns}\n{rows}");
    refused(&all("omega_rad_s,frequency_hz,re,im"), 1, "frequency_hz", "contradict");
    refused(&all("omega_rad_s,re,im,gain"), 1, "gain", "two forms");
    refused(&all("omega_rad_s,gain,gain_db,phase_deg"), 1, "gain_db", "two forms");
    refused(&all("omega_rad_s,re,im,phase_deg"), 1, "phase_deg", "two forms");
    refused(&all("magnitude,omega_rad_s,re,im"), 1, "magnitude", "twice");
}

#[test]
fn a_gain_of_a_higher_harmonic_is_refused() {
    for form in ["gain", "gain_db"] {
        let text = format!("magnitude,omega_rad_s,harmonic,{form},phase_deg\n1,1,3,1,0\n");
        refused(&text, 2, form, "harmonic 3");
    }
}

#[test]
fn files_without_data_are_refused() {
    refused("", None, "", "empty");
    refused("\n\n# axis: X\n", None, "", "empty");
    refused("# axis: X\nmagnitude,omega_rad_s,re,im\n\n# end\n", 2, "", "no row");
    refused("time_s,input,output\n", 1, "", "no row");
    let error = read(&[]).unwrap_err();
    assert!(error.reason.contains("no experiment"), "{error}");
}

#[test]
fn a_ragged_row_is_refused() {
    row_refused("1,2,1,1", "", "4 fields, the header 5");
    row_refused("1,2,1,1,0,9", "", "6 fields, the header 5");
}

#[test]
fn one_experiment_has_one_magnitude_and_one_frequency() {
    let header = "experiment,magnitude,omega_rad_s,harmonic,re,im\n0,1,1,1,1,0\n";
    refused(&format!("{header}0,2,1,2,1,0\n"), 3, "magnitude", "differs from 1");
    refused(&format!("{header}0,1,2,2,1,0\n"), 3, "omega_rad_s", "differs from 1");
    refused(&format!("{header},1,1,2,1,0\n"), 3, "experiment", "missing");
}

#[test]
fn repeats_with_different_harmonics_are_refused() {
    let text = "magnitude,omega_rad_s,repeat,harmonic,re,im\n\
        1,1,0,0,1,0\n1,1,0,1,1,0\n1,1,1,1,1,0\n";
    refused(text, 4, "repeat", "harmonics [1] of the response, repeat 0");
}

#[test]
fn an_experiment_needs_a_response_and_an_input() {
    let text = "magnitude,omega_rad_s,harmonic,re,im,u_re,u_im\n1,1,1,,,1,0\n";
    refused(text, 2, "", "no response");
    let text = "magnitude,omega_rad_s,harmonic,re,im,u_re,u_im\n,1,1,1,0,,\n";
    refused(text, 2, "magnitude", "neither magnitude nor input");
    let text = "magnitude,omega_rad_s,harmonic,re,im,u_re,u_im\n1,1,1,1,0,1,\n";
    refused(text, 2, "u_im", "missing");
}

#[test]
fn inputs_that_would_fill_the_memory_are_refused() {
    let mut text = String::from("magnitude,omega_rad_s,harmonic,re,im,u_re,u_im\n");
    for n in 1..100 {
        text += &format!("1,{n},100000,1,0,1,0\n");
    }
    let (line, _, reason) = fault(&text);
    assert!(line.is_some() && reason.contains("10000000"), "{reason}");
}

#[test]
fn mixed_units_are_refused() {
    let with = |metadata: &str| format!("{metadata}\nmagnitude,omega_rad_s,re,im\n1,1,1,0\n");
    let two = |a: &str, b: &str| {
        let (a, b) = (with(a), with(b));
        read(&[
            Source { name: "a.csv", bytes: a.as_bytes() },
            Source { name: "b.csv", bytes: b.as_bytes() },
        ])
        .map(|_| ())
    };
    for (a, b, key) in [
        ("# input: current A", "# input: current mA", "input"),
        ("# input: current A", "# input: force N", "input"),
        ("# response: velocity rad/s", "# response: velocity rpm", "response"),
        ("# response: velocity rad/s", "# response: position rad", "response"),
    ] {
        let error = two(a, b).unwrap_err();
        assert_eq!((error.file.as_str(), error.line), ("b.csv", Some(1)), "{error}");
        assert_eq!(error.column.as_deref(), Some(key));
        assert!(error.reason.contains("mixed units"), "{error}");
    }
    // Velocity is the default, so a file without `response` contradicts a position.
    assert!(two("# response: position m", "# axis: X").is_err());
    assert!(two("# input: current A", "# axis: X").is_ok());
}

#[test]
fn metadata_that_means_nothing_is_refused_with_its_line() {
    let with = |line: &str| format!("# axis: X\n{line}\n{HEADER}1,1,1,1,0\n");
    refused(&with("# response: temperature K"), 2, "response", "velocity, position");
    refused(&with("# measured_at: yesterday"), 2, "measured_at", "RFC 3339");
    refused(&with("# amplitude: loud"), 2, "amplitude", "rms");
    refused(&with("# axis: Y"), 2, "axis", "twice");
}

#[test]
fn text_in_another_encoding_is_refused() {
    let bytes = |bytes: &[u8]| read(&[Source { name: "x", bytes }]).unwrap_err();
    let error = bytes(b"# \xC2\xB0\nmagnitude,\xFF\n");
    assert_eq!(error.line, Some(2));
    assert!(error.reason.contains("UTF-8"));
    assert!(bytes(b"\xFF\xFEm").reason.contains("UTF-16"));
    refused("re,im\r1,2\r", 1, "", "carriage return");
}

#[test]
fn sums_of_the_largest_numbers_are_refused_not_infinite() {
    let text = "magnitude,omega_rad_s,repeat,re,im\n1,1,0,1.7e308,0\n1,1,1,1.7e308,0\n";
    assert!(of(text).is_err());
}

#[test]
fn more_experiments_than_a_measurement_has_are_refused_before_they_are_read() {
    let count = crate::measurement::formats::MAX_EXPERIMENTS;
    // One sample each, of which none could be read.
    let rows: String = (0..=count).map(|n| format!("{n},{n},1,1\n")).collect();
    let text = format!("segment,time_s,input,output\n{rows}");
    refused(&text, count as u64 + 2, "segment", "more than the 20000");
    let experiments = vec!["{}"; count + 1].join(",");
    let json = format!("{{\"experiments\": [{experiments}]}}");
    let error = read(&[Source { name: "a.json", bytes: json.as_bytes() }]).unwrap_err();
    assert!(error.reason.contains("more than the 20000"), "{error}");
}

#[test]
fn a_line_without_an_end_and_metadata_without_one_are_refused_before_they_fill_the_memory() {
    refused(&format!("re,im\n{}\n", "0,".repeat(500_001)), 2, "", "more than 1000000 bytes");
    refused(&"0,".repeat(500_001), 1, "", "more than 1000000 bytes");
    let metadata = "# key: \n".repeat(10_001);
    refused(&format!("{metadata}{HEADER}1,1,1,1,0\n"), 10_001, "", "10000 lines of metadata");
}
