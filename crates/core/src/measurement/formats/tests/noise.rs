//! Every way in which a row may state its noise.
//!
//! Most rows have Y = 3 − 4j, so |Y| = 5, at magnitude 2.

use std::f64::consts::SQRT_2;

use super::*;

mod json;

/// 2·0.035 = 0.07 along the response; with 0.01 across it the rms is 0.05.
const GAIN_STD: &str = "0.035";
/// 5·ln(10)/20 times this is 0.07.
const GAIN_DB_STD: &str = "0.12160245493";
/// 5·π/180 times this is 0.01.
const PHASE_STD_DEG: &str = "0.11459155903";

/// Row 2 of a table with these columns of noise.
fn row(columns: &str, cells: &str) -> String {
    format!("magnitude,omega_rad_s,re,im,{columns}\n2,1,3,-4,{cells}\n")
}

fn stds(measurement: &Measurement) -> Vec<Option<f64>> {
    measurement.experiments().iter().flat_map(|e| &e.response).map(|h| h.std).collect()
}

/// Asserts the only deviation of a table, and returns the remarks.
///
/// The numbers above have ten digits.
#[track_caller]
fn states(text: &str, std: f64) -> Vec<String> {
    let measurement = ok(text);
    let [Some(found)] = stds(&measurement)[..] else { panic!("one deviation\n{text}") };
    assert!((found / std - 1.0).abs() < 1e-9, "{found}, not {std}\n{text}");
    measurement.notes().to_vec()
}

#[track_caller]
fn states_silently(text: &str, std: f64) {
    assert_eq!(states(text, std), [""; 0], "{text}");
}

#[track_caller]
fn states_with_remark(text: &str, std: f64, remark: &str) {
    let notes = states(text, std);
    assert!(notes.len() == 1 && notes[0].contains(remark), "{notes:?}");
}

#[test]
fn a_coherence_and_its_averages_state_a_deviation() {
    // √(0.2/(2·2·0.8)) = 1/4 and √(0.2/(2·8·0.8)) = 1/8 of 5.
    states_silently(&row("coherence,averages", "0.8,2"), 1.25);
    states_silently(&row("averages,coherence", "8,0.8"), 0.625);
    // Overlapping averages count in parts: √(0.5/(2·12.5·0.5)) = 1/5.
    states_silently(&row("coherence,averages", "0.5,12.5"), 1.0);
}

#[test]
fn averages_may_be_metadata_and_a_row_may_have_its_own() {
    states_silently(&format!("# averages: 2\n{}", row("coherence", "0.8")), 1.25);
    states_silently(&format!("# averages: 8\n{}", row("coherence,averages", "0.8,2")), 1.25);
    states_silently(&format!("# averages: 8\n{}", row("coherence,averages", "0.8,")), 0.625);
}

#[test]
fn a_coherence_counts_for_means_and_higher_harmonics_too() {
    let header = "magnitude,omega_rad_s,harmonic,re,im,coherence,averages\n";
    states_silently(&format!("{header}2,1,0,-2,0,0.8,2\n"), 0.5);
    states_silently(&format!("{header}2,1,3,-0.6,0.8,0.8,2\n"), 0.25);
}

#[test]
fn deviations_of_gain_and_phase_have_a_deviation_of_their_rms() {
    let gain_std = format!("{GAIN_STD},{PHASE_STD_DEG}");
    let gain_db_std = format!("{GAIN_DB_STD},{PHASE_STD_DEG}");
    states_silently(&row("gain_std,phase_std_deg", &gain_std), 0.05);
    states_silently(&row("gain_db_std,phase_std_deg", &gain_db_std), 0.05);
}

#[test]
fn a_deviation_of_gain_or_phase_alone_is_taken_for_both_and_said() {
    states_with_remark(&row("gain_std", GAIN_STD), 0.07, "gain_std without phase_std_deg");
    states_with_remark(&row("gain_db_std", GAIN_DB_STD), 0.07, "gain_db_std without phase_std_deg");
    let phase = row("gain_db_std,phase_std_deg", &format!(",{PHASE_STD_DEG}"));
    states_with_remark(&phase, 0.01, "phase_std_deg without gain_std or gain_db_std");
}

#[test]
fn each_way_goes_with_each_form_of_the_response() {
    // 20·lg(2.5) dB.
    let forms = [
        ("re,im", "3,-4"),
        ("amplitude,phase_deg", "5,-53"),
        ("gain,phase_deg", "2.5,-53"),
        ("gain_db,phase_deg", "7.95880017344,-53"),
    ];
    let ways = [
        ("coherence,averages", "0.8,2".to_owned(), 1.25),
        ("gain_std,phase_std_deg", format!("{GAIN_STD},{PHASE_STD_DEG}"), 0.05),
        ("gain_db_std,phase_std_deg", format!("{GAIN_DB_STD},{PHASE_STD_DEG}"), 0.05),
    ];
    for (form, response) in forms {
        for (columns, cells, std) in &ways {
            states_silently(
                &format!(
                    "magnitude,omega_rad_s,{form},{columns}\n\
                    2,1,{response},{cells}\n"
                ),
                *std,
            );
        }
    }
}

#[test]
fn a_stated_share_of_the_response_is_the_same_in_every_convention() {
    for (convention, peak) in [("peak", 1.0), ("rms", SQRT_2), ("peak-to-peak", 0.5)] {
        let with = |text: String| format!("# amplitude: {convention}\n# reference: sin\n{text}");
        states_silently(&with(row("std", "0.05")), 0.05 * peak);
        states_silently(&with(row("coherence,averages", "0.8,2")), 1.25 * peak);
        for (columns, gain) in
            [("gain_std,phase_std_deg", GAIN_STD), ("gain_db_std,phase_std_deg", GAIN_DB_STD)]
        {
            let cells = format!("{gain},{PHASE_STD_DEG}");
            states_silently(&with(row(columns, &cells)), 0.05 * peak);
        }
        // A mean is the same in every convention.
        let mean = "magnitude,omega_rad_s,harmonic,re,im,coherence,averages\n2,1,0,-2,0,0.8,2\n";
        states_silently(&with(mean.into()), 0.5);
    }
}

#[test]
fn the_noise_of_a_repeat_is_that_of_the_single_repeat() {
    let text = "magnitude,omega_rad_s,repeat,re,im,coherence,averages\n\
        1,1,0,12,0,0.8,2\n1,1,1,16,0,0.8,2\n";
    // 3 and 4 of the repeats, √(3² + 4²)/2 of their mean.
    states_silently(text, 2.5);
}

#[test]
fn rows_of_one_table_may_state_noise_in_different_ways_or_not_at_all() {
    let m = ok(&format!(
        "magnitude,omega_rad_s,re,im,std,coherence,averages,phase_std_deg\n\
        2,1,3,-4,0.3,,9,\n2,2,3,-4,,0.8,2,\n2,3,3,-4,,,,{PHASE_STD_DEG}\n2,4,3,-4,,,2,\n"
    ));
    let stds = stds(&m);
    assert_eq!((stds[0], stds[3]), (Some(0.3), None));
    assert!((stds[1].unwrap() - 1.25).abs() < 1e-9 && (stds[2].unwrap() - 0.01).abs() < 1e-9);
}

#[test]
fn a_row_that_states_its_noise_twice_is_refused_with_both_columns() {
    for (columns, cells, column) in [
        ("std,coherence,averages", "0.1,0.9,2", "coherence"),
        ("coherence,averages,std", "0.9,2,0.1", "coherence"),
        ("std,gain_std", "0.1,0.1", "gain_std"),
        ("std,gain_db_std", "0.1,0.1", "gain_db_std"),
        ("std,phase_std_deg", "0.1,0.1", "phase_std_deg"),
        ("coherence,averages,gain_std", "0.9,2,0.1", "gain_std"),
        ("coherence,averages,gain_db_std", "0.9,2,0.1", "gain_db_std"),
        ("coherence,averages,phase_std_deg", "0.9,2,0.1", "phase_std_deg"),
        ("gain_std,gain_db_std", "0.1,0.1", "gain_db_std"),
        ("gain_std,phase_std_deg,gain_db_std", "0.1,0.1,0.1", "gain_db_std"),
    ] {
        let first = ["std", "coherence", "gain_std"]
            .into_iter()
            .find(|name| columns.split(',').any(|column| column == *name))
            .unwrap();
        let both = format!("{first} and {column} both state the noise");
        refused(&row(columns, cells), 2, column, &both);
    }
}

#[test]
fn a_coherence_without_averages_is_refused_with_what_to_add() {
    for text in [row("coherence", "0.9"), row("coherence,averages", "0.9,")] {
        refused(&text, 2, "averages", "add the column averages");
        refused(&text, 2, "averages", "`# averages: 16`");
    }
    ok(&row("coherence", ""));
}

#[test]
fn noise_that_means_nothing_is_refused() {
    for value in ["0", "-1"] {
        for column in ["std", "gain_std", "gain_db_std", "phase_std_deg"] {
            refused(&row(column, value), 2, column, "not positive");
        }
        refused(&row("coherence,averages", &format!("{value},2")), 2, "coherence", "not positive");
        refused(&row("coherence,averages", &format!("0.9,{value}")), 2, "averages", "not positive");
        refused(&row("std,averages", &format!("1,{value}")), 2, "averages", "not positive");
        let metadata = format!("# averages: {value}\n{}", row("coherence", "0.9"));
        refused(&metadata, 1, "averages", "positive");
    }
    refused(&row("coherence,averages", "1.0001,2"), 2, "coherence", "above 1");
    refused(&row("coherence,averages", "98,2"), 2, "coherence", "per cent");
    refused(&row("coherence,averages", "1e-200,2"), 2, "coherence", "too large");
    for column in ["std", "gain_std", "gain_db_std", "phase_std_deg"] {
        refused(&row(column, "1e300"), 2, column, "too large");
    }
}

#[test]
fn a_deviation_of_a_gain_or_a_phase_that_a_harmonic_lacks_is_refused() {
    let of = |harmonic: usize, column: &str| {
        format!("magnitude,omega_rad_s,harmonic,re,im,{column}\n2,1,{harmonic},1,0,0.1\n")
    };
    for column in ["gain_std", "gain_db_std"] {
        refused(&of(0, column), 2, column, "harmonic 0 has none");
        refused(&of(3, column), 2, column, "harmonic 3 has none");
    }
    refused(&of(0, "phase_std_deg"), 2, "phase_std_deg", "no phase");
    states(&of(3, "phase_std_deg"), 0.1_f64.to_radians());
    let zero = "magnitude,omega_rad_s,re,im,gain_std\n0,1,1,0,0.1\n";
    refused(zero, 2, "magnitude", "above 0");
    let unknown = "omega_rad_s,re,im,gain_std,u_re,u_im\n1,1,0,0.1,1,0\n";
    refused(unknown, 2, "magnitude", "above 0");
}

#[test]
fn a_coherence_of_one_states_no_noise_and_that_is_said_once() {
    // √(0.5/(2·8·0.5)) is exactly 1/4.
    let m = ok("magnitude,omega_rad_s,re,im,coherence,averages\n\
        2,1,3,-4,1,8\n2,2,3,-4,0.5,8\n2,3,3,-4,1.0000,8\n");
    assert_eq!(stds(&m), [None, Some(1.25), None]);
    let [note] = m.notes() else { panic!("{:?}", m.notes()) };
    assert!(note.contains("a coherence of 1 "), "{note}");
}

#[test]
fn noise_relative_to_a_response_of_zero_says_nothing_and_that_is_said_once() {
    let header = "magnitude,omega_rad_s,re,im,coherence,averages,gain_db_std,gain_std";
    let m = ok(&format!("{header}\n2,1,0,0,0.8,2,,\n2,2,0,0,,,0.1,\n2,3,0,0,,,,0.1\n"));
    assert_eq!(stds(&m), [None, None, Some(0.2)]);
    let of_zero = m.notes().iter().filter(|note| note.contains("a response of 0")).count();
    assert_eq!((of_zero, m.notes().len()), (1, 2), "{:?}", m.notes());
}

#[test]
fn averages_without_coherence_are_not_used_and_that_is_said() {
    states_with_remark(&row("std,averages", "0.1,2"), 0.1, "averages without coherence");
}

#[test]
fn a_row_of_the_input_alone_states_no_noise() {
    let m = ok("omega_rad_s,harmonic,re,im,u_re,u_im,coherence,averages\n\
        1,1,3,-4,1,0,0.5,8\n1,2,,,0.1,0,0.5,8\n");
    assert_eq!(stds(&m), [Some(1.25)]);
    assert!(m.notes().is_empty(), "{:?}", m.notes());
}
