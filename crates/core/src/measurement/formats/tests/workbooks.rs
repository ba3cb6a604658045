//! Workbooks, and what is refused of them.

use std::io::{Cursor, Write as _};

use super::*;

/// A workbook of sheets with a name and the XML of their rows.
pub(super) fn book(sheets: &[(&str, &str)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let mut part = |name: &str, text: &str| {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
    };
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let package = "http://schemas.openxmlformats.org/package/2006/relationships";
    part(
        "_rels/.rels",
        &format!(
            "<Relationships xmlns=\"{package}\"><Relationship Id=\"r0\" \
             Type=\"{office}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
        ),
    );
    let (mut entries, mut relations) = (String::new(), String::new());
    for (number, (name, rows)) in (1..).zip(sheets) {
        entries += &format!("<sheet name=\"{name}\" sheetId=\"{number}\" r:id=\"r{number}\"/>");
        relations += &format!(
            "<Relationship Id=\"r{number}\" Type=\"{office}/worksheet\" \
             Target=\"worksheets/sheet{number}.xml\"/>"
        );
        part(
            &format!("xl/worksheets/sheet{number}.xml"),
            &format!("<worksheet xmlns=\"{main}\"><sheetData>{rows}</sheetData></worksheet>"),
        );
    }
    part(
        "xl/workbook.xml",
        &format!(
            "<workbook xmlns=\"{main}\" xmlns:r=\"{office}\"><sheets>{entries}</sheets></workbook>"
        ),
    );
    part(
        "xl/_rels/workbook.xml.rels",
        &format!("<Relationships xmlns=\"{package}\">{relations}</Relationships>"),
    );
    zip.finish().unwrap().into_inner()
}

/// Rows of cells, each a number or else words, the first in row 1.
pub(super) fn rows(rows: &[&[&str]]) -> String {
    let cell = |row: usize, (column, text): (usize, &&str)| {
        let name = format!("{}{row}", char::from(b'A' + column as u8));
        match text.parse::<f64>() {
            Ok(_) => format!("<c r=\"{name}\"><v>{text}</v></c>"),
            Err(_) if text.is_empty() => String::new(),
            Err(_) => format!("<c r=\"{name}\" t=\"inlineStr\"><is><t>{text}</t></is></c>"),
        }
    };
    let row = |(number, cells): (usize, &&[&str])| {
        let cells: String = cells.iter().enumerate().map(|text| cell(number, text)).collect();
        format!("<row r=\"{number}\">{cells}</row>")
    };
    (1..).zip(rows).map(row).collect()
}

fn read_book(bytes: &[u8], sheet: Option<&str>) -> Result<Measurement, ParseError> {
    let mut given = Given::default();
    sheet.iter().try_for_each(|sheet| given.set("sheet", sheet))?;
    let text = given.text().unwrap_or_default();
    let book = Source { name: "book.xlsx", bytes };
    let stated = Source { name: Given::NAME, bytes: text.as_bytes() };
    let sources = [book, stated];
    read(if text.is_empty() { &sources[..1] } else { &sources })
}

const TABLE: &[&[&str]] = &[
    &["FRA 7", "", ""],
    &["# response: velocity rad/s"],
    &["# magnitude: 0.5"],
    &["Frequency", "Gain", "Phase"],
    &["Hz", "dB", "°"],
    &["0.5", "-3.5", "-90"],
    &["1.5", "-12.25", "-120"],
];

const TEXT: &str = "magnitude,frequency_hz,gain_db,phase_deg\n0.5,0.5,-3.5,-90\n\
    0.5,1.5,-12.25,-120\n";

#[test]
fn a_table_in_a_sheet_is_the_table_of_a_text() {
    let text = read(&[Source { name: "x", bytes: TEXT.as_bytes() }]).unwrap();
    let notes = rows(&[&["These are", "remarks"]]);
    let read = read_book(&book(&[("Notes", &notes), ("Data", &rows(TABLE))]), None).unwrap();
    assert_eq!(read.experiments(), text.experiments());
    assert!(read.notes()[0].contains("sheet `Data`"), "{:?}", read.notes());
}

#[test]
fn of_several_tables_one_is_asked_for_and_given() {
    let mut other = TABLE.to_vec();
    other.pop();
    let bytes = book(&[("A", &rows(TABLE)), ("B", &rows(&other))]);
    let error = read_book(&bytes, None).unwrap_err();
    assert!(error.reason.contains("`A`, `B`") && error.reason.contains("--sheet A"), "{error}");
    assert_eq!(read_book(&bytes, Some("B")).unwrap().experiments().len(), 1);
    assert!(read_book(&bytes, Some("C")).unwrap_err().reason.contains("no sheet `C`"));
}

#[test]
fn an_error_names_the_row_and_the_sheet() {
    let mut faulty = TABLE.to_vec();
    faulty[6] = &["1.5", "loud", "-120"];
    let error = read_book(&book(&[("Data", &rows(&faulty))]), None).unwrap_err();
    assert_eq!((error.line, error.column.as_deref()), (Some(7), Some("Gain")), "{error}");
    assert!(error.reason.contains("sheet `Data`"), "{error}");
}

#[test]
fn a_workbook_that_would_fill_the_memory_is_refused() {
    let far = "<row r=\"1\"><c r=\"A1\"><v>1</v></c><c r=\"XFD1\"><v>1</v></c></row>";
    let error = read_book(&book(&[("A", far)]), None).unwrap_err();
    assert!(error.reason.contains("beyond column"), "{error}");
    // Nothing but blanks, which pack well.
    let blanks = " ".repeat(MAX_UNPACKED_STRINGS as usize + 1);
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("xl/sharedStrings.xml", zip::write::SimpleFileOptions::default()).unwrap();
    zip.write_all(blanks.as_bytes()).unwrap();
    let bytes = zip.finish().unwrap().into_inner();
    let error = read_book(&bytes, None).unwrap_err();
    assert!(error.reason.contains("once unpacked"), "{error}");
}

#[test]
fn a_mutated_workbook_is_read_or_refused() {
    let valid = book(&[("Data", &rows(TABLE))]);
    for at in (0..valid.len()).step_by(5) {
        let mut bytes = valid.clone();
        bytes[at] ^= 1 << (at % 8);
        let _ = read_book(&bytes, None);
        let _ = read_book(&valid[..at], None);
    }
}

#[test]
fn a_row_that_no_sheet_has_is_refused() {
    let cells = "<row r=\"1\"><c r=\"A9007199254740993\"><v>1</v></c></row>";
    let bytes = book(&[("one", cells)]);
    assert!(read(&[Source { name: "x.xlsx", bytes: &bytes }]).is_err());
}
