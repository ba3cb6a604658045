//! Spreadsheets (`.xlsx`): a table in one of the sheets.
//!
//! The cells of a sheet are written as text between tabs and read as such, so that preamble,
//! metadata, names and units are those of a text. A line is a row of the sheet.

use std::fmt::Write as _;
use std::io::{Cursor, Read};

use calamine::{DataRef, Reader, Xlsx};

use super::csv_text::CsvText;
use super::delimited;
use super::fault::Fault;
use super::format::Format;
use super::given::{self, Given};
use super::limits::{MAX_CELLS_IN_ROW, MAX_ROWS, MAX_UNPACKED, MAX_UNPACKED_STRINGS};
use super::part::Part;

/// A zip archive.
pub(super) const FORMAT: Format = Format {
    is: |content| content.bytes.starts_with(b"PK\x03\x04"),
    read: |content, given| read(content.bytes, given),
};

fn read(bytes: &[u8], given: &Given) -> Result<Part, Fault> {
    check_size(bytes)?;
    let mut book: Xlsx<_> =
        calamine::open_workbook_from_rs(Cursor::new(bytes)).map_err(|error| no_book(&error))?;
    let names = book.sheet_names();
    let stated = given.get("sheet");
    if let Some(sheet) = stated
        && !names.iter().any(|name| name == sheet)
    {
        let reason = format!("there is no sheet `{sheet}`, only {}", listed(&names));
        return Err(Fault::new(reason).in_column("sheet"));
    }
    let (mut tables, mut fault) = (Vec::new(), None);
    for name in names.iter().filter(|name| stated.is_none_or(|stated| stated == name.as_str())) {
        let text = text(&mut book, name)?;
        let found = CsvText::open_cells(&text, given).map(|table| table.found);
        if stated.is_some() || found == Ok(true) {
            tables.push((name, text));
        } else if let Err(error) = found {
            fault = fault.or(Some(error.in_sheet(name)));
        }
    }
    match &tables[..] {
        [(name, text)] => {
            let table = CsvText::open_cells(text, given).and_then(CsvText::table);
            let mut part = table.and_then(delimited::part).map_err(|fault| fault.in_sheet(name))?;
            if names.len() > 1 {
                part.notes.insert(0, format!("the table is in the sheet `{name}`"));
            }
            Ok(part)
        }
        [] => Err(fault.unwrap_or_else(|| {
            Fault::new(format!(
                "no sheet has a line of known column names: {}",
                given::ask("column_names", "Time (s); Current (A); Position (mm)")
            ))
        })),
        several => {
            let found: Vec<String> = several.iter().map(|(name, _)| (*name).clone()).collect();
            Err(Fault::new(format!(
                "the sheets {} all have a table: {}",
                listed(&found),
                given::ask("sheet", &found[0])
            )))
        }
    }
}

fn listed(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

fn no_book(error: &dyn std::fmt::Display) -> Fault {
    Fault::new(format!("the file is a zip archive, but no xlsx workbook that can be read: {error}"))
}

/// Checks that the parts of the archive unpack to no more than can be held. What the archive says
/// of their sizes may be wrong, so they are unpacked once without being kept.
fn check_size(bytes: &[u8]) -> Result<(), Fault> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| no_book(&error))?;
    let mut left = MAX_UNPACKED;
    for index in 0..archive.len() {
        let part = archive.by_index(index).map_err(|error| no_book(&error))?;
        let name = part.name().map_err(|error| no_book(&error))?.into_owned();
        let sheet = name.to_ascii_lowercase().contains("worksheets/");
        let most = if sheet { left } else { left.min(MAX_UNPACKED_STRINGS) };
        let unpacked = std::io::copy(&mut part.take(most + 1), &mut std::io::sink())
            .map_err(|error| no_book(&error))?;
        if unpacked > most {
            return Err(Fault::new(format!(
                "the part {name} of the workbook is larger than {most} bytes once unpacked: save \
                 the table alone, or as text"
            )));
        }
        left -= unpacked;
    }
    Ok(())
}

/// The cells of a sheet as text between tabs.
fn text(book: &mut Xlsx<Cursor<&[u8]>>, sheet: &str) -> Result<String, Fault> {
    let wrong = |error: calamine::XlsxError| no_book(&error).in_sheet(sheet);
    let mut cells = book.worksheet_cells_reader(sheet).map_err(wrong)?;
    let mut text = String::new();
    let (mut row, mut column) = (0, 0);
    while let Some(cell) = cells.next_cell().map_err(wrong)? {
        let (cell_row, cell_column) = cell.get_position();
        if matches!(cell.get_value(), DataRef::Empty) {
            continue;
        }
        let too_large = |what| {
            let reason = format!("the sheet has a cell beyond {what}: save the table alone");
            Fault::new(reason).at_line(Some(u64::from(cell_row) + 1)).in_sheet(sheet)
        };
        if cell_row as usize > 2 * MAX_ROWS {
            return Err(too_large(format!("row {}", 2 * MAX_ROWS)));
        }
        if cell_column as usize >= MAX_CELLS_IN_ROW {
            return Err(too_large(format!("column {MAX_CELLS_IN_ROW}")));
        }
        if (cell_row, cell_column) < (row, column) {
            return Err(Fault::new("the cells of the sheet are out of order").in_sheet(sheet));
        }
        for _ in row..cell_row {
            text.push('\n');
            column = 0;
        }
        for _ in column..cell_column {
            text.push('\t');
        }
        (row, column) = (cell_row, cell_column);
        write_cell(&mut text, cell.get_value());
    }
    text.push('\n');
    Ok(text)
}

fn write_cell(text: &mut String, value: &DataRef<'_>) {
    // Writing into a string cannot fail.
    let _ = match value {
        DataRef::Int(number) => write!(text, "{number}"),
        DataRef::Float(number) if (1e-5..1e15).contains(&number.abs()) || *number == 0.0 => {
            write!(text, "{number}")
        }
        DataRef::Float(number) => write!(text, "{number:e}"),
        DataRef::String(words) => write!(text, "{}", in_one_line(words)),
        DataRef::SharedString(words) => write!(text, "{}", in_one_line(words)),
        DataRef::Bool(value) => write!(text, "{value}"),
        DataRef::DateTime(_) | DataRef::DateTimeIso(_) => write!(text, "a date"),
        DataRef::DurationIso(_) => write!(text, "a duration"),
        DataRef::Error(error) => write!(text, "{error}"),
        DataRef::Empty => Ok(()),
    };
}

/// Words without what would end a cell or a line.
fn in_one_line(words: &str) -> String {
    words.replace(['\t', '\r', '\n'], " ").replace('"', "'")
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;
    use crate::measurement::Measurement;
    use crate::measurement::formats::{ParseError, Source};

    /// A workbook of sheets with a name and the XML of their rows.
    fn book(sheets: &[(&str, &str)]) -> Vec<u8> {
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
    fn rows(rows: &[&[&str]]) -> String {
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
        super::super::read(if text.is_empty() { &sources[..1] } else { &sources })
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
        let text = super::super::read(&[Source { name: "x", bytes: TEXT.as_bytes() }]).unwrap();
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
        for at in 0..valid.len() {
            let mut bytes = valid.clone();
            bytes[at] ^= 1 << (at % 8);
            let _ = read_book(&bytes, None);
            let _ = read_book(&valid[..at], None);
        }
    }
}
