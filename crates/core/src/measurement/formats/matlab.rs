//! MATLAB files (`.mat`) of level 5, as MATLAB (`save -v7`, `-v6`) and Octave write them: vectors of
//! the same length are the columns of a table.
//!
//! The table is written as text between tabs and read as such, so that names are those of a text. A
//! complex vector, such as a frequency response, is its real and its imaginary part. The files have no
//! units: a time is in seconds and a frequency in Hz, and a note says so.

use std::fmt::Write as _;

use super::csv_text::CsvText;
use super::delimited;
use super::delimiter::Delimiter;
use super::fault::Fault;
use super::format::Format;
use super::given::Given;
use super::limits::{MAX_CELLS_IN_ROW, MAX_ROWS};
use super::matlab_variable::{Variable, variables};
use super::part::Part;
use super::sight::Sight;

/// What a file of level 5, and one of level 7.3, begin with.
const LEVEL_5: &[u8] = b"MATLAB 5.0 MAT-file";
const LEVEL_7_3: &[u8] = b"MATLAB 7.3 MAT-file";

/// A file that says which level it has.
pub(super) const FORMAT: Format = Format {
    name: "MATLAB file",
    is: |content| content.bytes.starts_with(LEVEL_5) || content.bytes.starts_with(LEVEL_7_3),
    read: |content, given| read(content.bytes, given),
    see: |content, given| {
        let found = variables(content.bytes).ok()?;
        let (used, _, rows) = longest(&found)?;
        let sight = Sight::of_text(&text(&used, rows), Some(Delimiter::Tab), given)?;
        Some(Sight { delimiter: None, line: None, ..sight })
    },
};

fn read(bytes: &[u8], given: &Given) -> Result<Part, Fault> {
    if bytes.starts_with(LEVEL_7_3) {
        return Err(Fault::new(
            "MATLAB files of level 7.3 are not read: save it with `save(file, '-v7')`",
        ));
    }
    let found = variables(bytes)?;
    let Some((used, others, rows)) = longest(&found) else {
        return Err(Fault::new(
            "the MATLAB file has no vector: save time, input and response as vectors or as fields \
             of a structure (an object such as a timeseries is not read: save its Time and Data)",
        ));
    };
    if rows > MAX_ROWS {
        return Err(Fault::new(format!("more than {MAX_ROWS} rows")));
    }
    let text = text(&used, rows);
    let mut part = CsvText::open_cells(&text, given)
        .and_then(CsvText::table)
        .and_then(delimited::part)
        .map_err(|fault| with_names(fault, &used))?;
    let names = |columns: &[Column<'_>]| {
        let names = columns.iter().map(|column| format!("`{}`", column.name));
        names.collect::<Vec<_>>().join(", ")
    };
    let mut note = format!("the vectors {} of the MATLAB file are its table", names(&used));
    if !others.is_empty() {
        // Writing into a string cannot fail.
        let _ = write!(note, "; {} have another length and are not used", names(&others));
    }
    if part.header.column_names.is_none() {
        let supposed: Vec<String> = used.iter().filter_map(|used| with_unit(&used.name)).collect();
        if !supposed.is_empty() {
            let _ = write!(note, "; taken as {}, since the file has no units", supposed.join(", "));
        }
    }
    part.notes.insert(0, note);
    Ok(part)
}

/// The longest vectors of a file, the others, and how long they are; `None` if there is no vector.
fn longest(found: &[Variable]) -> Option<(Vec<Column<'_>>, Vec<Column<'_>>, usize)> {
    let columns: Vec<Column<'_>> = found.iter().flat_map(columns).collect();
    let rows = columns.iter().map(|column| column.re.len()).max().filter(|rows| *rows > 1)?;
    let (used, others) = columns.into_iter().partition(|column| column.re.len() == rows);
    Some((used, others, rows))
}

/// A column of a variable.
struct Column<'a> {
    name: String,
    re: &'a [f64],
    im: Option<&'a [f64]>,
}

/// The columns of a variable: one of a vector, whichever way it lies.
fn columns(variable: &Variable) -> Vec<Column<'_>> {
    let Variable { name, rows, columns, re, im } = variable;
    let count = if *rows == 1 { 1 } else { (*columns).min(MAX_CELLS_IN_ROW) };
    let length = if *rows == 1 { *columns } else { *rows };
    // A structure says where a vector comes from, not what it is.
    let short = name.rsplit('.').next().unwrap_or(name);
    let column = |k: usize| Column {
        name: if count == 1 { short.to_owned() } else { format!("{short} {}", k + 1) },
        re: &re[k * length..(k + 1) * length],
        im: im.as_ref().map(|im| &im[k * length..(k + 1) * length]),
    };
    (0..if length == 0 { 0 } else { count }).map(column).collect()
}

/// Names of vectors that have a unit of their own, and that unit.
const UNITS: [(&str, &[&str]); 2] =
    [("s", &["t", "time", "zeit"]), ("Hz", &["f", "freq", "frequency", "frequenz"])];

/// A name with the unit that such a vector has.
fn with_unit(name: &str) -> Option<String> {
    let lower = name.to_lowercase();
    let (unit, _) = UNITS.into_iter().find(|(_, names)| names.contains(&lower.as_str()))?;
    Some(format!("{name} [{unit}]"))
}

/// The columns as text between tabs.
fn text(columns: &[Column<'_>], rows: usize) -> String {
    let mut names = Vec::new();
    for column in columns {
        match column.im {
            None => names.push(with_unit(&column.name).unwrap_or_else(|| column.name.clone())),
            Some(_) => names.extend(["gain_re".to_owned(), "gain_im".to_owned()]),
        }
    }
    let mut text = names.join("\t") + "\n";
    for row in 0..rows {
        let parts = columns.iter().flat_map(|column| {
            [Some(column.re[row]), column.im.map(|im| im[row])].into_iter().flatten()
        });
        for (place, value) in parts.enumerate() {
            // Writing into a string cannot fail.
            let _ = write!(text, "{}{value:?}", if place == 0 { "" } else { "\t" });
        }
        text.push('\n');
    }
    text
}

/// The fault with the names of the vectors.
fn with_names(fault: Fault, columns: &[Column<'_>]) -> Fault {
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    fault.and(&format!(
        " (the vectors of the MATLAB file are, in this order, {}; `column_names` names them otherwise)",
        names.join(", ")
    ))
}

#[cfg(test)]
pub(super) mod tests;
