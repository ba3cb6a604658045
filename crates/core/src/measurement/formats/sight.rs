//! What is seen of a table before anything is read from it: its names, units and first rows.

use super::decimal::{Decimals, Mark, is_number};
use super::delimiter::Delimiter;
use super::given::Given;
use super::header::Header;
use super::instruments;
use super::limits::MAX_COLUMNS;
use super::name::{self, Name};
use super::preamble;

/// Rows that are shown.
pub(super) const ROWS: usize = 20;

/// Lines above a table that are shown.
const MOST_ABOVE: usize = 20;

/// Lines among which the first row of a table is looked for.
const MOST_LINES: usize = 1000;

/// Lines that are looked at in all.
const MOST_SEEN: usize = 100_000;

/// Most characters of a cell that are shown.
const MOST_CHARACTERS: usize = 80;

/// A table as it is seen.
#[derive(Debug, Clone, Default)]
pub(super) struct Sight {
    pub(super) delimiter: Option<Delimiter>,
    /// Line of the column names, or of the first row where there are none.
    pub(super) line: Option<u64>,
    /// Lines above that, without blank ones.
    pub(super) above: Vec<String>,
    /// Names as the file has them; empty where it has none.
    pub(super) names: Vec<String>,
    /// Units that the file has beside or below the names.
    pub(super) units: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
    /// Names as the instrument of the file means them.
    pub(super) meant: Vec<String>,
    /// What the file, and what is given beside it, say of the table.
    pub(super) header: Header,
    /// Whether each column has times of its own, beside it.
    pub(super) timed: bool,
    /// The sheets of a workbook.
    pub(super) sheets: Vec<String>,
    /// What makes another file one of the same layout, if that can be told.
    pub(super) layout: Option<String>,
}

/// Where a table is in a text.
struct Found {
    delimiter: Delimiter,
    /// Index of the line of the names.
    names: Option<usize>,
    /// Index of the line below which the rows are.
    first: usize,
}

impl Sight {
    /// The table of a text; `None` if there is none. `delimiter` is that of the text if it is known.
    pub(super) fn of_text(text: &str, delimiter: Option<Delimiter>, given: &Given) -> Option<Self> {
        let lines: Vec<&str> = text.lines().take(MOST_SEEN).collect();
        let Found { delimiter: mark, names: at, first } =
            found_by_names(text, delimiter).or_else(|| found_by_numbers(&lines, delimiter))?;
        if first > lines.len() {
            return None;
        }
        let rows = lines[first..].iter().filter(is_content);
        let mut rows: Vec<Vec<String>> = rows.take(ROWS + 1).map(|line| mark.cells(line)).collect();
        let mut units = Vec::new();
        if at.is_some() && rows.first().is_some_and(|row| are_units(row)) {
            units = rows.remove(0);
        }
        rows.truncate(ROWS);
        let mut names = at.map(|at| mark.cells(lines[at])).unwrap_or_default();
        let count = rows.first().map_or(names.len(), Vec::len).min(MAX_COLUMNS);
        names.resize(count, String::new());
        units.resize(count, String::new());
        let known = preamble::read(text, delimiter, given);
        let (mut header, comments) =
            known.map(|known| (known.header, known.comments)).unwrap_or_default();
        let meant = instruments::find(&names)
            .and_then(|instrument| (instrument.names)(&names, &comments, &mut header).ok());
        let above = lines[..at.unwrap_or(first)].iter().filter(|line| !line.trim().is_empty());
        let layout = layout(mark.name(), &names, &units)
            .or_else(|| layout_without_names(mark.name(), &rows));
        Some(Self {
            delimiter: Some(mark),
            line: Some(1 + at.unwrap_or(first) as u64),
            above: above.take(MOST_ABOVE).map(|line| shown(line)).collect(),
            meant: meant.unwrap_or_else(|| names.clone()),
            names,
            units: units.iter().map(|unit| name::bare(unit).to_owned()).collect(),
            rows: rows.iter().map(|row| row.iter().map(|cell| shown(cell)).collect()).collect(),
            header,
            timed: false,
            sheets: Vec::new(),
            layout,
        })
    }

    /// The names to be understood: those that are given, or those of the file. A table that has
    /// times beside its columns has one of them first.
    pub(super) fn named(&self) -> Vec<Name> {
        let given = self.header.column_names.as_ref();
        let given = given.filter(|given| given.len() == self.names.len());
        let names: Vec<Name> = match given {
            Some(given) => given.iter().map(|name| Name::of(name, None)).collect(),
            None => {
                let unit = |unit: &String| (!unit.is_empty()).then(|| unit.clone());
                let units = self.units.iter().map(unit);
                let names = self.meant.iter().zip(units);
                names.map(|(name, unit)| Name::of(name, unit.as_deref())).collect()
            }
        };
        let time = self.timed.then(|| Name::of("time_s", None));
        time.into_iter().chain(names).collect()
    }
}

/// What makes another file one of the same layout; `None` where no column has a name.
pub(super) fn layout(kind: &str, names: &[String], units: &[String]) -> Option<String> {
    let named = names.iter().any(|name| !name.is_empty());
    named.then(|| [kind, &names.join("\u{1f}"), &units.join("\u{1f}")].join("\u{1e}"))
}

/// What makes another table without column names one of the same layout: its delimiter, its number of
/// columns, and its decimal mark.
fn layout_without_names(kind: &str, rows: &[Vec<String>]) -> Option<String> {
    let columns = rows.first()?.len().to_string();
    let mark = decimal(rows, None).unwrap_or("none");
    Some(["without names", kind, &columns, mark].join("\u{1e}"))
}

/// The decimal mark of rows, if they have one and only one.
pub(super) fn decimal(rows: &[Vec<String>], stated: Option<Mark>) -> Option<&'static str> {
    let mut decimals = Decimals::new(stated);
    for cell in rows.iter().flatten().filter(|cell| is_number(cell)) {
        decimals.number(0, cell).ok()?;
    }
    decimals.mark().ok()?.map(|mark| match mark {
        Mark::Comma => "comma",
        Mark::Point => "point",
    })
}

/// A text in one line, and not too long.
pub(super) fn shown(text: &str) -> String {
    let mut characters = text.trim().chars();
    let mut text: String = characters.by_ref().take(MOST_CHARACTERS).collect();
    if characters.next().is_some() {
        text.push('…');
    }
    text
}

fn is_content(line: &&&str) -> bool {
    !line.trim().is_empty() && !line.starts_with('#')
}

fn are_units(row: &[String]) -> bool {
    let filled = || row.iter().filter(|cell| !cell.is_empty() && *cell != "1");
    filled().any(|cell| name::is_unit(cell)) && !filled().any(|cell| is_number(cell))
}

/// The table below the line of names that the reader finds.
fn found_by_names(text: &str, delimiter: Option<Delimiter>) -> Option<Found> {
    let preamble = preamble::read(text, delimiter, &Given::default()).ok()?;
    let named = preamble.found && preamble.header.column_names.is_none();
    let at = preamble.line as usize - 1;
    named.then_some(Found { delimiter: preamble.delimiter, names: Some(at), first: at + 1 })
}

/// The table that begins with the first line of numbers. The line above it has the names if it has
/// as many cells, or the line above that if there are units between them.
fn found_by_numbers(lines: &[&str], delimiter: Option<Delimiter>) -> Option<Found> {
    let stated = delimiter.or_else(|| Delimiter::stated(lines.first()?));
    let marks = || Delimiter::ALL.into_iter().filter(|mark| stated.is_none_or(|s| s == *mark));
    let (first, delimiter) = lines.iter().enumerate().take(MOST_LINES).find_map(|(at, line)| {
        let row = |mark: &Delimiter| is_content(&line) && is_row(&mark.cells(line));
        Some((at, marks().find(row)?))
    })?;
    let count = delimiter.cells(lines[first]).len();
    let fits = |at: usize| {
        let cells = delimiter.cells(lines[at]);
        let words = cells.iter().filter(|cell| !cell.is_empty());
        cells.len() == count && words.clone().count() > 0 && !words.clone().any(|c| is_number(c))
    };
    let mut above =
        (0..first).rev().filter(|at| is_content(&&lines[*at])).take_while(|at| fits(*at));
    let (nearest, next) = (above.next(), above.next());
    let names = match (nearest, next) {
        (Some(units), Some(names)) if are_units(&delimiter.cells(lines[units])) => Some(names),
        (nearest, _) => nearest,
    };
    Some(Found { delimiter, names, first: names.map_or(first, |names| names + 1) })
}

/// Whether a line is one of numbers: several cells, most of the filled ones numbers.
fn is_row(cells: &[String]) -> bool {
    let filled = cells.iter().filter(|cell| !cell.is_empty());
    let numbers = filled.clone().filter(|cell| is_number(cell)).count();
    numbers >= 2 && 2 * numbers > filled.count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Sight {
        Sight::of_text(text, None, &Given::default()).unwrap()
    }

    #[test]
    fn a_table_of_unknown_names_begins_where_its_numbers_do() {
        let seen =
            of("Rig 7\nstarted; by hand\n\nt_rel;chan a;chan b\n[ms];[A];\n0;1,5;x\n1;2,5;y\n");
        assert_eq!(seen.names, ["t_rel", "chan a", "chan b"]);
        assert_eq!(seen.units, ["ms", "A", ""]);
        assert_eq!(seen.rows, [["0", "1,5", "x"], ["1", "2,5", "y"]]);
        assert_eq!((seen.line, seen.delimiter), (Some(4), Some(Delimiter::Semicolon)));
        assert_eq!(seen.above, ["Rig 7", "started; by hand"]);
    }

    #[test]
    fn numbers_alone_have_no_names_and_the_layout_of_their_columns() {
        let seen = of("1 2 3\n4 5 6\n");
        assert_eq!(seen.names, ["", "", ""]);
        assert_eq!(seen.rows.len(), 2);
        let layout = |text| of(text).layout.unwrap();
        assert_eq!(layout("1;2,5;3\n"), layout("rig 3\n\n7;8,5;9\n1;2;3\n"));
        for other in ["1;2,5\n", "1;2.5;3\n", "1\t2,5\t3\n", "a;b;c\n1;2,5;3\n"] {
            assert_ne!(layout("1;2,5;3\n"), layout(other), "{other}");
        }
        assert!(Sight::of_text("no table\nhere\n", None, &Given::default()).is_none());
    }

    #[test]
    fn a_table_below_more_lines_than_anybody_looks_at_is_not_seen() {
        let below = |lines: usize| {
            let text = format!("{}time_s,input,output\n0,1,2\n", "\n".repeat(lines));
            Sight::of_text(&text, None, &Given::default())
        };
        assert_eq!(below(MOST_SEEN - 2).unwrap().rows.len(), 1);
        assert!(below(MOST_SEEN).is_none());
    }

    #[test]
    fn the_layout_is_that_of_the_names_and_not_of_what_stands_above_or_below() {
        let layout = |text| of(text).layout.unwrap();
        let one = layout("a;b\n1;2\n");
        assert_eq!(one, layout("# axis: X\n\nrig 3\na;b\n3;4\n5;6\n"));
        for other in ["a;c\n1;2\n", "a,b\n1,2\n", "a;b\ns;A\n1;2\n"] {
            assert_ne!(one, layout(other), "{other}");
        }
    }

    #[test]
    fn as_many_rows_as_are_shown_and_no_more() {
        let rows = "1,2\n".repeat(3 * ROWS);
        assert_eq!(of(&format!("time_s,input\n{rows}")).rows.len(), ROWS);
        assert_eq!(of(&format!("a,b\n{rows}")).rows.len(), ROWS);
    }
}
