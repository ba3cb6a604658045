//! The tables of an answer as lines of text.

use super::columns::{Side, align_points, table};
use super::number::{digits, significant};
use super::tables::{Cell, LEAST_P, Table};

/// Lines of a table, its headings first.
pub(super) fn lines(of: &Table) -> Vec<String> {
    let mut rows: Vec<Vec<String>> =
        of.rows.iter().map(|row| row.iter().map(written).collect()).collect();
    for (index, column) in of.columns.iter().enumerate() {
        if column.side == Side::Point {
            align_points(rows.iter_mut().map(|row| &mut row[index]));
        }
    }
    rows.insert(0, of.columns.iter().map(|column| column.heading.to_owned()).collect());
    let sides: Vec<Side> = of.columns.iter().map(|column| column.side).collect();
    table(&sides, &rows)
}

fn written(cell: &Cell) -> String {
    match cell {
        Cell::Empty | Cell::Passed(None) => String::new(),
        Cell::Words(text)
        | Cell::Name(text)
        | Cell::Effect(text)
        | Cell::Parameter { name: text, .. }
        | Cell::Sentence(text)
        | Cell::Number(text) => text.clone(),
        Cell::NoNumber(word) => (*word).to_owned(),
        Cell::Value(value, count) => digits(*value, *count),
        Cell::PerCent(share, count) => format!("{} %", digits(100.0 * share, *count)),
        Cell::Range(from, to) => {
            let (from, to) = (significant(*from, 3), significant(*to, 3));
            if from == to { from } else { format!("{from} to {to}") }
        }
        Cell::Probability(p) if *p < LEAST_P => "< 1e-6".to_owned(),
        Cell::Probability(p) => significant(*p, 2),
        Cell::Passed(Some(true)) => "passed".to_owned(),
        Cell::Passed(Some(false)) => "FAILED".to_owned(),
        Cell::Named => "named".to_owned(),
    }
}
