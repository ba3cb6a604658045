//! A table of numbers with named columns, independent of the file format.
//!
//! CSV rows, JSON rows and JSON columns are all converted into a [`Table`], so that the meaning of
//! the numbers is interpreted in one place only. Each row remembers where it was written, for
//! messages.

use super::columns::Column;
use super::fault::Fault;

/// Location of a row in its file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Place {
    /// In this line of a CSV file.
    Line(u64),
    /// In the JSON object at this path.
    Object(String),
    /// At this index of each array of the JSON object at this path.
    Element(String, usize),
}

impl Place {
    fn fault(&self, column: Option<Column>, reason: String) -> Fault {
        let fault = Fault::new(reason);
        match (self, column) {
            (Place::Line(line), Some(column)) => {
                fault.at_line(Some(*line)).in_column(column.name())
            }
            (Place::Line(line), None) => fault.at_line(Some(*line)),
            (Place::Object(path), Some(column)) => fault.in_column(join_path(path, column.name())),
            (Place::Object(path), None) => fault.in_column(path),
            (Place::Element(path, index), Some(column)) => {
                let array = join_path(path, column.name());
                fault.in_column(format!("{array}[{index}]"))
            }
            (Place::Element(path, index), None) => fault.in_column(format!("{path}[{index}]")),
        }
    }
}

/// Rows of numbers with named columns.
#[derive(Debug, Clone)]
pub(super) struct Table {
    columns: Vec<Column>,
    position: [Option<usize>; Column::COUNT],
    cells: Vec<Option<f64>>,
    places: Vec<Place>,
    /// Location of the column names.
    header: Option<Place>,
}

impl Table {
    pub(super) fn new(columns: Vec<Column>, header: Option<Place>) -> Self {
        let mut position = [None; Column::COUNT];
        for (index, column) in columns.iter().enumerate() {
            position[*column as usize] = Some(index);
        }
        Self { columns, position, cells: Vec::new(), places: Vec::new(), header }
    }

    pub(super) fn has(&self, column: Column) -> bool {
        self.position[column as usize].is_some()
    }

    /// Adds a row with one cell per column.
    pub(super) fn push(
        &mut self,
        place: Place,
        cells: impl IntoIterator<Item = Result<Option<f64>, String>>,
    ) -> Result<(), Fault> {
        for (column, cell) in self.columns.iter().zip(cells) {
            let cell = cell.and_then(|value| match value {
                Some(number) if !number.is_finite() => {
                    Err(format!("{number} is not a finite number"))
                }
                value => Ok(value),
            });
            self.cells.push(cell.map_err(|reason| place.fault(Some(*column), reason))?);
        }
        self.places.push(place);
        Ok(())
    }

    pub(super) fn len(&self) -> usize {
        self.places.len()
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        (0..self.len()).map(|index| self.row(index))
    }

    pub(super) fn row(&self, index: usize) -> Row<'_> {
        Row { table: self, index }
    }

    /// A fault of the table as a whole.
    pub(super) fn fault(&self, column: Option<Column>, reason: impl Into<String>) -> Fault {
        let reason = reason.into();
        match &self.header {
            Some(place) => place.fault(column, reason),
            None => Fault::new(reason),
        }
    }
}

/// One row of a [`Table`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Row<'a> {
    table: &'a Table,
    index: usize,
}

impl Row<'_> {
    pub(super) fn index(&self) -> usize {
        self.index
    }

    /// The number in a column, if the table has the column and the cell is not blank.
    pub(super) fn get(&self, column: Column) -> Option<f64> {
        let position = self.table.position[column as usize]?;
        self.table.cells[self.index * self.table.columns.len() + position]
    }

    /// Whether the table has a column.
    pub(super) fn has(&self, column: Column) -> bool {
        self.table.has(column)
    }

    /// The number in a column that must not be blank.
    pub(super) fn require(&self, column: Column) -> Result<f64, Fault> {
        self.get(column).ok_or_else(|| self.fault(column, "the value is missing"))
    }

    /// The index (0, 1, 2 …) in a column, if the cell is not blank.
    pub(super) fn index_in(&self, column: Column) -> Result<Option<u64>, Fault> {
        let Some(value) = self.get(column) else { return Ok(None) };
        if value < 0.0 || value.fract() != 0.0 {
            return Err(self.fault(column, format!("{value} is not an integer ≥ 0")));
        }
        if value >= super::limits::MAX_INDEX {
            return Err(self.fault(column, format!("{value:e} is too large an index")));
        }
        Ok(Some(value as u64))
    }

    /// The index in a column; `None` if the table lacks the column, an error if the cell is blank.
    pub(super) fn required_index(&self, column: Column) -> Result<Option<u64>, Fault> {
        if self.table.has(column) {
            self.require(column)?;
        }
        self.index_in(column)
    }

    pub(super) fn fault(&self, column: Column, reason: impl Into<String>) -> Fault {
        self.place().fault(Some(column), reason.into())
    }

    pub(super) fn fault_of_row(&self, reason: impl Into<String>) -> Fault {
        self.place().fault(None, reason.into())
    }

    /// Name of this row in a message about another row.
    pub(super) fn name(&self) -> String {
        match self.place() {
            Place::Line(line) => format!("line {line}"),
            Place::Object(path) => path.clone(),
            Place::Element(path, index) => format!("{path}[{index}]"),
        }
    }

    /// Its line, in a file that has lines.
    pub(super) fn line(&self) -> Option<u64> {
        match self.place() {
            Place::Line(line) => Some(*line),
            Place::Object(_) | Place::Element(..) => None,
        }
    }

    fn place(&self) -> &Place {
        &self.table.places[self.index]
    }
}

/// JSON path of a key in the object at `path`.
pub(super) fn join_path(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}
