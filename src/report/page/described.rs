//! The tables of an answer as tables of the page.

use maud::{Markup, html};

use crate::report::number::{digits, significant};
use crate::report::tables::{Cell as Described, LEAST_P, Table};

use super::table::{Cell, table};
use super::words::{effect, number, parameter, sentence, without_ids};

/// A table under a caption. In its sentences `ids` of effects become words.
pub(super) fn described(caption: &str, of: &Table, ids: &[&str]) -> Markup {
    let shown = || of.columns.iter().enumerate().filter_map(|(i, c)| Some((i, c.on_page?)));
    let titles: Vec<&str> = shown().map(|(_, title)| title).collect();
    let row = |row: &Vec<Described>| shown().map(|(i, _)| cell(&row[i], ids)).collect();
    let rows: Vec<Vec<Cell>> = of.rows.iter().map(row).collect();
    table(caption, &titles, &rows)
}

fn cell(of: &Described, ids: &[&str]) -> Cell {
    match of {
        Described::Empty => Cell::empty(),
        Described::Words(text) => Cell::text(text),
        Described::Name(text) => Cell::text(text.replace('_', " ")),
        Described::Effect(id) => Cell::text(effect(id)),
        Described::Parameter { id, .. } => Cell::Text(parameter(id)),
        Described::Sentence(text) => {
            Cell::Sentence(sentence(&without_ids(text, ids.iter().copied())))
        }
        Described::Number(text) => Cell::number(text),
        Described::NoNumber(word) => Cell::Number((*word).to_owned()),
        Described::Value(value, count) => Cell::plain(*value, *count),
        Described::PerCent(share, count) => Cell::number(digits(100.0 * share, *count)),
        Described::Range(from, to) => {
            let [from, to] = [from, to].map(|end| number(*end, 3));
            Cell::text(if from == to { from } else { format!("{from} to {to}") })
        }
        Described::Probability(p) if *p < LEAST_P => Cell::Number("< 10⁻⁶".into()),
        Described::Probability(p) => Cell::number(significant(*p, 2)),
        Described::Passed(None) => Cell::text("not tested"),
        Described::Passed(Some(true)) => Cell::text("passed"),
        Described::Passed(Some(false)) => Cell::Text(html! { strong { "failed" } }),
        Described::Named => Cell::Text(html! { strong { "Named as a cause." } }),
    }
}
