//! The table of a CSV text: its columns, as far as their names are known, read as numbers.

use csv::StringRecord;

use super::CsvText;
use crate::measurement::formats::columns::Column;
use crate::measurement::formats::decimal::{Decimals, Mark, is_number};
use crate::measurement::formats::delimiter::{Delimiter, unquote};
use crate::measurement::formats::fault::Fault;
use crate::measurement::formats::header::Header;
use crate::measurement::formats::instruments;
use crate::measurement::formats::lack;
use crate::measurement::formats::limits::MAX_ROWS;
use crate::measurement::formats::name::{self, Name};
use crate::measurement::formats::naming;
use crate::measurement::formats::table::{Place, Table};

const NO_KNOWN_COLUMN: &str = "the header has no known column: a time record needs \
    time_s,input,output, a harmonic table magnitude,omega_rad_s,harmonic,re,im";

/// Most columns without a name in an example of names.
const MAX_EXAMPLE: usize = 20;

/// A table, and what is known of its columns.
pub(in super::super) struct NamedTable {
    pub(in super::super) table: Table,
    pub(in super::super) header: Header,
    pub(in super::super) notes: Vec<String>,
    /// Whether it is a time record.
    pub(in super::super) timed: bool,
    /// The names that the file has for the columns that are used.
    pub(in super::super) written: Vec<(Column, String)>,
}

impl CsvText<'_> {
    /// Reads the columns that are known as numbers, and notes the names of all others.
    pub(in super::super) fn table(mut self) -> Result<NamedTable, Fault> {
        let mut record = StringRecord::new();
        let mut next = self.next(&mut record)?;
        let units = next.is_some_and(|_| is_row_of_units(&record)).then(|| record.clone());
        if let (Some(units), Some(line)) = (&units, next) {
            self.notes.push(format!("line {line} is read as the units: {}", shown(units)));
            next = self.next(&mut record)?;
        }
        let written_names = self.names.clone();
        if let Some(instrument) = instruments::find(&self.names) {
            self.notes.push(format!("the file is of {}", instrument.name));
            self.names = (instrument.names)(&self.names, &self.comments, &mut self.header)
                .map_err(|fault| fault.at_line(Some(self.names_line)))?;
        }
        let unit = |field| units.as_ref().and_then(|units| units.get(field));
        let names = self.names.iter().enumerate();
        let names: Vec<Name> = names.map(|(field, name)| Name::of(name, unit(field))).collect();
        if !names.iter().any(Name::is_known) {
            let lack = lack::ask("column_names", example(names.len()));
            let reason = match self.names.iter().all(|name| is_number(name)) {
                true => format!("{} of numbers and no column names", columns(names.len())),
                false => NO_KNOWN_COLUMN.to_owned(),
            };
            return Err(self.fault_of_header(format!("{reason}; {lack}")).lacking(lack));
        }
        let line = self.names_line;
        let naming =
            naming::resolve(&names, &mut self.header).map_err(|fault| fault.at_line(Some(line)))?;
        let columns: Vec<Column> = naming.used.iter().map(|used| used.column).collect();
        let written = naming
            .used
            .iter()
            .map(|used| written_names.get(used.field).cloned().unwrap_or_default());
        let written: Vec<_> = columns.iter().copied().zip(written).collect();
        let mut table = Table::new(columns, Some(Place::Line(line)));
        let mut decimals = Decimals::new(self.header.decimal);
        while let Some(line) = next {
            self.check_length(&record, line)?;
            if table.len() == MAX_ROWS {
                return Err(Fault::new(format!("more than {MAX_ROWS} rows")).at_line(Some(line)));
            }
            let row = table.len();
            let cells = naming.used.iter().map(|used| {
                if used.field == naming::ROW_NUMBER {
                    return Ok(Some(used.convert(row as f64)));
                }
                let cell = unquote(record.get(used.field).unwrap_or_default());
                Ok(decimals.number(line, cell)?.map(|number| used.convert(number)))
            });
            table
                .push(Place::Line(line), cells)
                .map_err(|fault| fault.with_names_of_file(&written))?;
            next = self.next(&mut record)?;
        }
        if table.len() == 0 {
            return Err(self.fault_of_header("there is no row after the header"));
        }
        let mark = decimals.mark()?;
        let usual = self.delimiter == Delimiter::Comma && mark != Some(Mark::Comma);
        if !usual && !self.of_cells {
            self.notes.push(said(self.delimiter, mark));
        }
        self.notes.extend(naming.notes);
        let Self { header, notes, .. } = self;
        Ok(NamedTable { table, header, notes, timed: naming.timed, written })
    }

    /// Checks that a row has a cell for every column that has a name, and none beside them that is
    /// filled.
    fn check_length(&self, record: &StringRecord, line: u64) -> Result<(), Fault> {
        let named = |names: &[String]| names.iter().rposition(|name| !name.is_empty());
        let needed = named(&self.names).map_or(0, |last| last + 1);
        let filled = (1..).zip(record).filter(|(_, cell)| !unquote(cell).is_empty());
        let filled = filled.last().map_or(0, |(count, _)| count);
        if record.len() >= needed && filled <= self.names.len() {
            return Ok(());
        }
        let (cells, names) = (record.len(), self.names.len());
        let mut reason = format!("the row has {cells} fields, the header {names}");
        if self.delimiter == Delimiter::Comma && filled == 2 * names {
            reason.push_str(": where numbers have decimal commas, separate them by semicolons");
        }
        Err(Fault::new(reason).at_line(Some(line)))
    }
}

/// Names of so many columns, as an example: a column that is not used has none.
fn example(count: usize) -> String {
    let known = ["Time (s)", "Current (A)", "Position (mm)"];
    let unused = std::iter::repeat_n("", count.saturating_sub(known.len()).min(MAX_EXAMPLE));
    known.into_iter().chain(unused).collect::<Vec<_>>().join("; ").trim_end().to_owned()
}

fn columns(count: usize) -> String {
    match count {
        1 => "the file has one column".to_owned(),
        count => format!("the file has columns 1 to {count}"),
    }
}

/// Whether a row below the names has their units: some cell is a unit, and none is a number.
fn is_row_of_units(record: &StringRecord) -> bool {
    let cells = || record.iter().map(unquote).filter(|cell| !cell.is_empty());
    // 1 is a unit, too, that of a ratio.
    cells().any(|cell| cell != "1" && name::is_unit(cell))
        && !cells().any(|cell| cell != "1" && is_number(cell))
}

fn shown(record: &StringRecord) -> String {
    record.iter().map(unquote).collect::<Vec<_>>().join(", ")
}

/// How a text is read that is not in the form of the contract.
fn said(delimiter: Delimiter, mark: Option<Mark>) -> String {
    let decimals = match mark {
        Some(Mark::Comma) => ", and numbers have a decimal comma",
        Some(Mark::Point) => ", and numbers have a decimal point",
        None => "",
    };
    format!("columns are separated by {}{decimals}", delimiter.name())
}
