//! Written files read back as the same measurement.

use super::*;
use crate::measurement::{Complex, Metadata};

fn round_trip(measurement: &Measurement) -> Measurement {
    let mut text = Vec::new();
    write_harmonic_csv(measurement, &mut text).unwrap();
    ok(std::str::from_utf8(&text).unwrap())
}

/// Asserts equality up to the rounding errors of adding mean and deviation and separating them.
fn assert_same(a: &Measurement, b: &Measurement) {
    let close = |a: Complex, b: Complex, size: f64| (a - b).norm() <= 1e-14 * size;
    assert_eq!(a.metadata(), b.metadata());
    assert_eq!(a.experiments().len(), b.experiments().len());
    for (a, b) in a.experiments().iter().zip(b.experiments()) {
        assert_eq!(
            (a.magnitude, a.omega_rad_s, a.run, a.from_record, a.input_mean_measured),
            (b.magnitude, b.omega_rad_s, b.run, b.from_record, b.input_mean_measured)
        );
        assert_eq!((a.input.len(), a.repeats.len()), (b.input.len(), b.repeats.len()));
        let size = |values: &[Complex]| values.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let input_size = size(&a.input);
        let all = |a: &[Complex], b: &[Complex], size: f64| {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| close(*a, *b, size))
        };
        assert!(all(&a.input, &b.input, input_size));
        let values: Vec<Complex> = a.response.iter().map(|h| h.value).collect();
        let response_size = size(&values);
        for (a, b) in a.response.iter().zip(&b.response) {
            assert_eq!(a.order, b.order);
            assert!(close(a.value, b.value, response_size));
            match (a.std, b.std) {
                (Some(a), Some(b)) => assert!((a / b - 1.0).abs() < 1e-14),
                (a, b) => assert_eq!(a, b),
            }
        }
        for (a, b) in a.repeats.iter().zip(&b.repeats) {
            assert!(all(&a.input, &b.input, input_size));
            assert!(all(&a.response, &b.response, response_size));
        }
    }
}

#[test]
fn a_plain_table_reads_back_bit_by_bit() {
    let m = ok("# input: motor current [A]\n# response: velocity rad/s\n# loop: closed\n\
        # measured_at: 2024-05-31T13:45:00.5Z\n# label.b: x: y\n# name: test\n\
        magnitude,omega_rad_s,harmonic,re,im\n\
        0.1,0.3,0,1e-300,0\n0.1,0.3,1,0.333333333333333333,-2e22\n0.2,0.3,5,0.1,0.7\n");
    let again = round_trip(&m);
    assert_eq!((m.metadata(), m.experiments()), (again.metadata(), again.experiments()));
    let mut text = Vec::new();
    write_harmonic_csv(&m, &mut text).unwrap();
    let header = "magnitude,omega_rad_s,experiment,harmonic,re,im\n";
    assert!(String::from_utf8(text).unwrap().contains(header));
}

#[test]
fn repeats_inputs_deviations_and_runs_read_back() {
    assert_same_again(
        "magnitude,omega_rad_s,harmonic,re,im,std,repeat,run,u_re,u_im\n\
        1,1,0,0.1,0,0.1,0,3,0.01,0\n1,1,1,1,2,0.1,0,3,1,0.1\n1,1,2,,,,0,3,0.2,0.1\n\
        1,1,0,0.2,0,0.2,1,3,0.02,0\n1,1,1,1.1,2,0.1,1,3,1.1,0.1\n1,1,2,,,,1,3,0.3,0.1\n\
        2,1,1,1,2,,0,,,\n",
    );
    assert_same_again(
        "magnitude,omega_rad_s,re,im,repeat\n1,1,0.1,0.7,0\n1,1,0.2,0.1,1\n1,1,0.4,0.1,2\n",
    );
}

#[test]
fn noise_that_is_stated_by_coherence_is_written_as_std() {
    // √(0.5/(2·8·0.5)) = 1/4 of 5.
    let m = ok("magnitude,omega_rad_s,re,im,coherence,averages\n1,1,3,-4,0.5,8\n1,2,1,0,1,8\n");
    let mut text = Vec::new();
    write_harmonic_csv(&m, &mut text).unwrap();
    let rows = "harmonic,re,im,std\n1,1,0,1,3.0,-4.0,1.25\n";
    let text = String::from_utf8(text).unwrap();
    assert!(text.contains(rows) && text.ends_with("1,2,1,1,1.0,0.0,\n"), "{text}");
    assert_eq!(ok(&text).experiments(), m.experiments());
}

#[test]
fn a_record_reads_back() {
    assert_same_again(&format!("# period_s: 0.1\n{}", record(100, 4)));
    assert_same_again(&format!("# response: position m\n# period_s: 0.1\n{}", record(100, 1)));
}

fn assert_same_again(text: &str) {
    let m = ok(text);
    assert_same(&m, &round_trip(&m));
}

#[test]
fn metadata_of_several_lines_stays_on_its_own() {
    let m = ok("magnitude,omega_rad_s,harmonic,re,im\n1,2,1,1,0\n");
    let name = Some("one\n# axis: other\n9,9,9,9,9".to_owned());
    let metadata = Metadata { name, ..m.metadata().clone() };
    let m = Measurement::new(metadata, m.experiments().to_vec(), Vec::new(), String::new());
    let again = round_trip(&m.unwrap());
    assert_eq!(again.metadata().name.as_deref(), Some("one # axis: other 9,9,9,9,9"));
    assert_eq!(again.metadata().axis, None);
    assert_eq!(again.experiments().len(), 1);
}

#[test]
fn metadata_with_separators_or_quotes_is_one_cell_and_reads_back() {
    let m = ok("magnitude,omega_rad_s,harmonic,re,im\n1,2,1,1,0\n");
    for text in [
        "x,=HYPERLINK(\"http://evil.example\")",
        "x;=1+1",
        "a \"b\" c",
        "\"=1\"",
        "\"",
        "Doe, Jane",
        "a: b, \"\"c",
    ] {
        let labels = [("site".to_owned(), text.to_owned())].into();
        let metadata = Metadata { name: Some(text.into()), labels, ..m.metadata().clone() };
        let m = Measurement::new(metadata, m.experiments().to_vec(), Vec::new(), String::new());
        let m = m.unwrap();
        let mut table = Vec::new();
        write_harmonic_csv(&m, &mut table).unwrap();
        let table = String::from_utf8(table).unwrap();
        for delimiter in [b',', b';'] {
            let mut cells = csv::ReaderBuilder::new();
            let cells = cells.has_headers(false).flexible(true).delimiter(delimiter);
            for record in cells.from_reader(table.as_bytes()).records() {
                let record = record.unwrap();
                let is_metadata = record[0].starts_with('#');
                assert!(!is_metadata || record.len() == 1, "{table}");
                assert!(record.iter().all(|cell| !cell.starts_with('=')), "{table}");
            }
        }
        assert_eq!(round_trip(&m).metadata(), m.metadata(), "{table}");
        // A spreadsheet that stores it puts nothing into the cells behind.
        let stored = table.replace("\"\n", "\",,,,,\n");
        assert_eq!(ok(&stored).metadata(), m.metadata(), "{stored}");
    }
}
