//! The tables of an answer, each described once: what its columns are and what
//! stands in its cells. The text and the page write them each in its own way.

mod diagnosis;
mod inspection;
mod model;
mod plan;

use super::columns::Side;
use super::number::digits;

pub(super) use diagnosis::{TRIED_SAYS, gains, residuals, tests, tried};
use inspection::size as parameter_of_size;
pub(super) use inspection::{unseen, visible};
pub(super) use model::{flags, in_digits, misfit, orders, parameters, stages};
pub(super) use plan::{nameable, planned};

/// Probability below which another power of ten says nothing.
pub(super) const LEAST_P: f64 = 1e-6;

/// What a cell holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Cell {
    /// Nothing.
    Empty,
    /// A word or a few.
    Words(String),
    /// A name in which ids of effects may stand.
    Name(String),
    /// The id of an effect.
    Effect(String),
    /// A parameter: its name in the table, and its full id.
    Parameter { name: String, id: String },
    /// A sentence.
    Sentence(String),
    /// A number as it is written.
    Number(String),
    /// A word in the place of a number.
    NoNumber(&'static str),
    /// A number to so many significant digits.
    Value(f64, usize),
    /// A share to so many significant digits.
    PerCent(f64, usize),
    /// From where to where a group reaches.
    Range(f64, f64),
    /// Probability of a test.
    Probability(f64),
    /// Whether a test was passed; `None` where it was not made.
    Passed(Option<bool>),
    /// That a candidate is a cause.
    Named,
}

impl Cell {
    fn words(text: impl Into<String>) -> Self {
        Self::Words(text.into())
    }

    /// What `cell` makes of a value, if there is one.
    fn of<T>(value: Option<T>, cell: impl FnOnce(T) -> Self) -> Self {
        value.map_or(Self::Empty, cell)
    }

    fn value(value: f64, count: usize) -> Self {
        Self::Number(digits(value, count))
    }
}

/// One column.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    /// Its heading in the text.
    pub(super) heading: &'static str,
    /// Where its cells stand in the text.
    pub(super) side: Side,
    /// Its heading on the page; `None`: the page leaves it out.
    pub(super) on_page: Option<&'static str>,
}

/// A table: its columns, and rows of as many cells.
#[derive(Debug, Clone)]
pub(super) struct Table {
    pub(super) columns: Vec<Column>,
    pub(super) rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table with columns of a heading in the text, a side and a heading on the page.
    fn new<const COLUMNS: usize>(
        columns: [(&'static str, Side, &'static str); COLUMNS],
        rows: impl Iterator<Item = [Cell; COLUMNS]>,
    ) -> Self {
        let column = |(heading, side, page)| Column { heading, side, on_page: Some(page) };
        Self {
            columns: columns.into_iter().map(column).collect(),
            rows: rows.map(Vec::from).collect(),
        }
    }

    /// The same with its columns in another order, or with some of them only.
    pub(super) fn arranged(&self, order: &[usize]) -> Self {
        let rows = self.rows.iter();
        Self {
            columns: order.iter().map(|&column| self.columns[column]).collect(),
            rows: rows.map(|row| order.iter().map(|&c| row[c].clone()).collect()).collect(),
        }
    }
}
