//! Spreadsheets (`.xlsx`): a table in one of the sheets.
//!
//! The cells of a sheet are written as text between tabs and read as such, so that preamble,
//! metadata, names and units are those of a text. A line is a row of the sheet.

use std::fmt::Write as _;
use std::io::{Cursor, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};

use calamine::{DataRef, Reader, Xlsx, XlsxError};

use super::csv_text::CsvText;
use super::delimited;
use super::delimiter::Delimiter;
use super::fault::Fault;
use super::format::Format;
use super::given::Given;
use super::lack;
use super::limits::{MAX_CELLS_IN_ROW, MAX_ROWS, MAX_UNPACKED, MAX_UNPACKED_STRINGS};
use super::part::Part;
use super::sight::Sight;

/// A zip archive.
pub(super) const FORMAT: Format = Format {
    name: "workbook (xlsx)",
    is: |content| content.bytes.starts_with(b"PK\x03\x04"),
    read: |content, given| read(content.bytes, given),
    see: |content, given| see(content.bytes, given).ok()?,
};

type Book<'a> = Xlsx<Cursor<&'a [u8]>>;

fn open(bytes: &[u8]) -> Result<Book<'_>, Fault> {
    check_size(bytes)?;
    sound(|| calamine::open_workbook_from_rs(Cursor::new(bytes)))
}

/// The table of the sheet that is stated, or else of the first sheet that has one. The layout is
/// that of all sheets.
fn see(bytes: &[u8], given: &Given) -> Result<Option<Sight>, Fault> {
    let mut book = open(bytes)?;
    let (mut seen, mut sheets, mut layouts) = (None, Vec::new(), Vec::new());
    for sheet in book.sheet_names() {
        let text = text(&mut book, &sheet)?;
        let Some(sight) = Sight::of_text(&text, Some(Delimiter::Tab), given) else { continue };
        layouts.extend(sight.layout.clone());
        let is_stated = given.get("sheet") == Some(sheet.as_str());
        if seen.is_none() || is_stated {
            seen = Some(sight);
        }
        sheets.push(sheet);
    }
    let layout = (!layouts.is_empty()).then(|| layouts.join("\u{1d}"));
    Ok(seen.map(|sight| Sight { delimiter: None, sheets, layout, ..sight }))
}

fn read(bytes: &[u8], given: &Given) -> Result<Part, Fault> {
    let mut book = open(bytes)?;
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
            let lack = lack::ask("column_names", "Time (s); Current (A); Position (mm)");
            Fault::new(format!("no sheet has a line of known column names: {lack}")).lacking(lack)
        })),
        several => {
            let found: Vec<String> = several.iter().map(|(name, _)| (*name).clone()).collect();
            let lack = lack::ask("sheet", &found[0]);
            Err(Fault::new(format!("the sheets {} all have a table: {lack}", listed(&found)))
                .lacking(lack))
        }
    }
}

fn listed(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

fn no_book(error: &dyn std::fmt::Display) -> Fault {
    Fault::new(format!("the file is a zip archive, but no xlsx workbook that can be read: {error}"))
}

/// What calamine reads. It computes with the names of cells unchecked: where arithmetic is checked,
/// a row that no sheet has makes it panic.
fn sound<T>(read: impl FnOnce() -> Result<T, XlsxError>) -> Result<T, Fault> {
    match catch_unwind(AssertUnwindSafe(read)) {
        Ok(read) => read.map_err(|error| no_book(&error)),
        Err(_) => Err(no_book(&"it names a cell that no sheet has")),
    }
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
fn text(book: &mut Book<'_>, sheet: &str) -> Result<String, Fault> {
    let wrong = |fault: Fault| fault.in_sheet(sheet);
    let mut cells = sound(|| book.worksheet_cells_reader(sheet)).map_err(wrong)?;
    let mut text = String::new();
    let (mut row, mut column) = (0, 0);
    while let Some(cell) = sound(|| cells.next_cell()).map_err(wrong)? {
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
