//! Finds where the table of a text begins, and reads the metadata above it.

use std::borrow::Cow;

use super::decimal::is_number;
use super::delimiter::Delimiter;
use super::fault::Fault;
use super::given::Given;
use super::header::Header;
use super::instruments;
use super::limits::{MAX_METADATA_LINES, MAX_NAMES_LINE};
use super::name::{self, Name};

/// Most lines that are neither metadata nor blank above the column names.
const MOST_LINES: usize = 1000;

/// What stands above the table of a text, and where the table begins.
pub(super) struct Preamble<'a> {
    /// The metadata, with what was given beside the file.
    pub(super) header: Header,
    /// Remarks on it.
    pub(super) notes: Vec<String>,
    /// Comments that are `key: value` with a key of one word that is unknown.
    pub(super) comments: Vec<(String, String)>,
    pub(super) delimiter: Delimiter,
    /// The text from the line of the column names on; from the first row on if `column_names` names
    /// them.
    pub(super) rest: &'a str,
    /// The number of its first line.
    pub(super) line: u64,
    /// Whether a line of column names was found, or the first row.
    pub(super) found: bool,
}

/// Reads the preamble of a text.
///
/// The column names are in the first line of the table if that has a name of the contract;
/// otherwise in the first line with two known names, one of them of a frequency or a time. Where no
/// line is like that, they are taken to be in the first, so that messages point there.
///
/// `delimiter` is that of the text if it is known.
///
/// # Errors
/// If metadata means nothing, or no row has as many numbers as `column_names` names.
pub(super) fn read<'a>(
    text: &'a str,
    delimiter: Option<Delimiter>,
    given: &Given,
) -> Result<Preamble<'a>, Fault> {
    let mut header = Header::default();
    let mut comments = Vec::new();
    let line_of_delimiter = text.lines().next().and_then(Delimiter::stated);
    let stated = delimiter.or(line_of_delimiter);
    // Where the first line begins that is neither metadata nor blank.
    let mut first: Option<(&str, u64)> = None;
    let mut found = None;
    let mut names = given.column_names();
    let mut lines = Vec::new();
    let (mut rest, mut number, mut foreign) = (text, 1, 0);
    while !rest.is_empty() && foreign < MOST_LINES {
        let end = rest.find('\n').map_or(rest.len(), |end| end + 1);
        let line = rest[..end].trim();
        if let Some(line) = comment(line) {
            names = names.or_else(|| column_names(&line));
            lines.extend(line.contains(':').then_some((number, line)));
            if lines.len() > MAX_METADATA_LINES {
                let reason = format!("more than {MAX_METADATA_LINES} lines of metadata");
                return Err(Fault::new(reason).at_line(Some(number)));
            }
        } else if !line.is_empty() && (number > 1 || line_of_delimiter.is_none()) {
            found = match &names {
                Some(names) => row_delimiter(line, stated, names),
                None => names_delimiter(line, stated, first.is_none()),
            };
            first.get_or_insert((rest, number));
            if found.is_some() {
                break;
            }
            foreign += 1;
        }
        rest = &rest[end..];
        number += 1;
    }
    let guessed = || first.map(|(from, _)| guess(from.lines().next().unwrap_or_default()));
    let delimiter = found.or(stated).or_else(guessed).unwrap_or(Delimiter::Comma);
    for (number, line) in lines {
        // A spreadsheet fills the cells behind the metadata with nothing.
        let line = match delimiter {
            Delimiter::Semicolon => line.trim_end_matches(';'),
            _ => &line,
        };
        metadata(&mut header, &mut comments, line, number)?;
    }
    let mut notes: Vec<String> = comments
        .iter()
        .map(|(line, key, _)| format!("line {line}: metadata key {key} is unknown and not used"))
        .collect();
    let comments = comments.into_iter().map(|(_, key, value)| (key, value)).collect();
    header.take(given, &mut notes)?;
    let Some((from, from_line)) = first else {
        return Ok(Preamble {
            header,
            notes,
            comments,
            delimiter,
            rest: "",
            line: number,
            found: false,
        });
    };
    if found.is_some() {
        if from_line < number {
            notes.push(format!("the text from line {from_line} to the table is not used"));
        }
        return Ok(Preamble {
            header,
            notes,
            comments,
            delimiter,
            rest,
            line: number,
            found: true,
        });
    }
    if let Some(columns) = &header.column_names {
        let reason = format!("no row has {} numbers, as many as column_names has", columns.len());
        return Err(Fault::new(reason).in_column("column_names"));
    }
    Ok(Preamble { header, notes, comments, delimiter, rest: from, line: from_line, found: false })
}

/// A line of metadata or of a remark, if it is one. One that would be taken apart where it is read as
/// CSV stands in quotes as one cell, behind which a spreadsheet may have put cells with nothing.
fn comment(line: &str) -> Option<Cow<'_, str>> {
    if line.starts_with('#') {
        return Some(line.into());
    }
    let cell = line.strip_prefix('"').filter(|cell| cell.starts_with('#') && cell.contains(':'))?;
    let cell = cell.trim_end_matches([',', ';', '\t']).strip_suffix('"')?;
    let is_one = !cell.replace("\"\"", "").contains('"');
    is_one.then(|| cell.replace("\"\"", "\"").into())
}

/// The names of the columns, if a line of metadata gives them.
fn column_names(line: &str) -> Option<Vec<String>> {
    let (key, value) = line.trim_start_matches('#').split_once(':')?;
    let mut header = Header::default();
    header.set(None, key.trim(), value.trim()).ok()?;
    header.column_names
}

/// Line, key and value of a comment.
type Comment = (u64, String, String);

/// Reads one line of metadata.
fn metadata(
    header: &mut Header,
    comments: &mut Vec<Comment>,
    line: &str,
    number: u64,
) -> Result<(), Fault> {
    let Some((key, value)) = line.trim_start_matches('#').split_once(':') else { return Ok(()) };
    let key = key.trim();
    let known = header.set(Some(number), key, value.trim())?;
    // A free-text comment may contain a colon, but only a misspelled key is one word.
    if !known && !key.is_empty() && !key.contains(char::is_whitespace) {
        comments.push((number, key.to_owned(), value.trim().to_owned()));
    }
    Ok(())
}

/// The delimiter of a line of column names; `None` if it is not one.
fn names_delimiter(line: &str, stated: Option<Delimiter>, first: bool) -> Option<Delimiter> {
    if line.len() > MAX_NAMES_LINE {
        return None;
    }
    let is_comma = stated.is_none_or(|stated| stated == Delimiter::Comma);
    let contract =
        |line| Delimiter::Comma.cells(line).iter().any(|cell| name::contract(cell).is_some());
    if first && is_comma && contract(line) {
        return Some(Delimiter::Comma);
    }
    let count = |delimiter: &Delimiter| {
        let cells = delimiter.cells(line);
        if instruments::find(&cells).is_some() {
            return usize::MAX;
        }
        let names = cells.iter().map(|cell| Name::of(cell, None));
        let names: Vec<Name> = names.collect();
        let axis = names.iter().any(Name::is_axis);
        if axis { names.iter().filter(|name| name.is_known()).count() } else { 0 }
    };
    let fits = |delimiter: &Delimiter| stated.is_none_or(|stated| stated == *delimiter);
    // Names have blanks of their own, so that these are the last resort. The last of equals wins,
    // and the more telling ones come first.
    let marks =
        Delimiter::ALL.into_iter().rev().filter(|delimiter| *delimiter != Delimiter::Blanks);
    let best = marks.filter(fits).max_by_key(count);
    let candidates = best.into_iter().chain([Delimiter::Blanks].into_iter().filter(fits));
    candidates.into_iter().find(|delimiter| count(delimiter) >= 2)
}

/// The delimiter of a row with as many cells as there are names, numbers or blanks in all columns
/// that have one; `None` if it is not one.
fn row_delimiter(line: &str, stated: Option<Delimiter>, names: &[String]) -> Option<Delimiter> {
    Delimiter::ALL.into_iter().filter(|d| stated.is_none_or(|stated| stated == *d)).find(|d| {
        let cells = d.cells(line);
        let used =
            cells.iter().zip(names).filter(|(cell, name)| !cell.is_empty() && !name.is_empty());
        let mut used = used.map(|(cell, _)| cell).peekable();
        cells.len() == names.len() && used.peek().is_some() && used.all(|cell| is_number(cell))
    })
}

/// The delimiter of a line that has no known name: where it is a row of numbers, the one that
/// separates them.
fn guess(line: &str) -> Delimiter {
    let is_row = |mark: &Delimiter| {
        let cells = mark.cells(line);
        cells.len() > 1 && cells.iter().all(|cell| is_number(cell))
    };
    if let Some(mark) = Delimiter::ALL.into_iter().find(is_row) {
        return mark;
    }
    let mut marks = [Delimiter::Comma, Delimiter::Semicolon, Delimiter::Tab].into_iter();
    marks.find(|mark| line.as_bytes().contains(&mark.byte())).unwrap_or(Delimiter::Comma)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metadata_may_stand_in_quotes_and_a_row_that_begins_with_a_number_sign_is_none() {
        for (line, said) in [
            ("# name: a, b", "# name: a, b"),
            ("\"# name: a, b\"", "# name: a, b"),
            ("\"# name: a \"\"b\"\"\",,,", "# name: a \"b\""),
            ("\"#name: a\";;", "#name: a"),
        ] {
            assert_eq!(comment(line).as_deref(), Some(said));
        }
        for line in ["\"#\",\"a: b\"", "\"#\"", "\"# a: b", "\"a: b\"", "1,2", "", "\""] {
            assert_eq!(comment(line), None, "{line}");
        }
    }
}
