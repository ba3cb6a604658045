//! Text as spreadsheets and instruments write it: encodings, delimiters, decimal commas, preambles
//! and rows of units.

use super::*;

const PLAIN: &str = "magnitude,omega_rad_s,re,im\n1,2,0.125,-0.5\n1,4.5,0.0625,-0.25\n";

/// A text in German spelling: semicolons and decimal commas.
fn german(text: &str) -> String {
    text.replace(',', ";").replace('.', ",")
}

/// Asserts that a text is the same measurement as [`PLAIN`].
#[track_caller]
fn is_plain(bytes: &[u8]) -> Measurement {
    let read = read(&[Source { name: "x.csv", bytes }]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(read.experiments(), ok(PLAIN).experiments());
    read
}

#[track_caller]
fn says(measurement: &Measurement, words: &str) {
    let notes = measurement.notes();
    assert!(notes.iter().any(|note| note.contains(words)), "{words}: {notes:?}");
}

#[test]
fn semicolons_and_decimal_commas_are_read_and_said() {
    let m = is_plain(german(PLAIN).as_bytes());
    says(&m, "separated by semicolons, and numbers have a decimal comma");
    let m = is_plain(PLAIN.replace(',', ";").as_bytes());
    says(&m, "decimal point");
    assert!(ok(PLAIN).notes().is_empty());
}

#[test]
fn tabs_blanks_and_a_stated_separator_are_read() {
    says(&is_plain(german(PLAIN).replace(';', "\t").as_bytes()), "tabs");
    says(&is_plain(PLAIN.replace(',', "   ").as_bytes()), "blanks");
    is_plain(format!("sep=;\r\n{}", german(PLAIN).replace('\n', "\r\n")).as_bytes());
    is_plain(format!("sep=,\n{PLAIN}").as_bytes());
}

#[test]
fn a_text_in_another_encoding_is_the_same_measurement() {
    let text = format!("# operator: Jürgen\n{}", german(PLAIN));
    let windows: Vec<u8> = text.chars().map(|c| c as u8).collect();
    let m = is_plain(&windows);
    says(&m, "Windows-1252");
    assert_eq!(m.metadata().operator.as_deref(), Some("Jürgen"));
    let utf_16: Vec<u8> =
        "\u{FEFF}".chars().chain(text.chars()).flat_map(|c| (c as u16).to_le_bytes()).collect();
    says(&is_plain(&utf_16), "UTF-16LE");
}

#[test]
fn what_stands_above_the_table_is_skipped_and_said() {
    let text = format!("Instrument: FRA 7\nDate;12.03.2024\n\n# axis: X\n{}", german(PLAIN));
    let m = is_plain(text.as_bytes());
    says(&m, "from line 1 to the table is not used");
    assert_eq!(m.metadata().axis.as_deref(), Some("X"));
    // Errors still name the line of the file.
    let faulty = text.replace("0,0625", "0,O625");
    refused(&faulty, 7, "re", "`0,O625` is not a number");
}

#[test]
fn a_row_of_units_below_the_names_is_read() {
    let text = "time_s;input;output\ns;A;mm\n0;1;2\n";
    let rows: String = (1..40).map(|n| format!("{n};{};{}\n", n % 4, n % 4)).collect();
    let m = ok(&format!("{text}{rows}"));
    let metadata = m.metadata();
    assert_eq!((metadata.input.name.as_str(), metadata.input.unit.as_str()), ("current", "A"));
    assert_eq!(metadata.response.unit, "mm");
    assert_eq!(metadata.response_kind, ResponseKind::Position);
    says(&m, "line 2 is read as the units: s, A, mm");
    refused(&format!("{}{rows}", text.replace("\ns;", "\nms;")), 1, "time_s", "another");
}

#[test]
fn empty_columns_and_lines_at_the_end_are_left_out() {
    let text = PLAIN.replace('\n', ",,\n") + ",,,,,\n\n";
    is_plain(text.as_bytes());
    is_plain(PLAIN.replace("im\n", "im,\n").as_bytes());
}

#[test]
fn a_comma_that_may_stand_between_thousands_is_asked_for() {
    let text = "magnitude;omega_rad_s;re;im\n1;2;1,234;-2,345\n";
    refused(text, 2, "", "--decimal comma");
    let m = ok(&format!("# decimal: comma\n{text}"));
    assert_eq!(y(&m, 0, 1), Complex::new(1.234, -2.345));
    refused(&format!("# decimal: point\n{text}"), 3, "re", "decimal point");
    refused(&german(PLAIN).replace("0,0625", "0.0625"), 3, "", "same decimal mark");
    let unquoted = "magnitude,omega_rad_s,re,im\n1,0,2,0,0,125,-0,5\n";
    refused(unquoted, 2, "", "separate them by semicolons");
}

#[test]
fn columns_that_are_named_beside_the_file_stand_for_its_own() {
    let rows = "1;2;9;0,125;-0,5\n1;4,5;9;0,0625;-0,25\n";
    let names = "# column_names: magnitude; omega_rad_s; ; re; im\n";
    is_plain(format!("{names}{rows}").as_bytes());
    is_plain(format!("{names}a;b;c;d;e\n{rows}").as_bytes());
    let fewer = names.replace("; im", "");
    refused(&format!("{fewer}{rows}"), None, "column_names", "no row has 4 numbers");
}

#[test]
fn metadata_end_before_the_empty_cells_behind_them() {
    let text = format!("# axis: X\n# response: position mm\n{}", german(PLAIN));
    let m = is_plain(text.replace('\n', ";;;\n").as_bytes());
    assert_eq!(m.metadata().axis.as_deref(), Some("X"));
    assert_eq!(m.metadata().response.unit, "mm");
}

#[test]
fn a_line_of_many_names_or_a_long_name_takes_no_time() {
    let many = format!("x{}\n1\n", ",x".repeat(20_000));
    refused(&many, 1, "", "more than 10000 columns");
    // Every blank of a name may stand before its unit.
    let long = format!("magnitude,omega_rad_s,re,im,{}\n1,2,0.125,-0.5,0\n", "a ".repeat(100_000));
    assert_eq!(ok(&long).experiments().len(), 1);
}
