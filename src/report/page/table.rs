//! Tables whose decimal points stand below each other.

use maud::{Markup, html};

use super::words::typeset;

/// What a cell holds.
#[derive(Debug, Clone)]
pub(super) enum Cell {
    /// A word or a few.
    Text(Markup),
    /// A sentence, which needs room.
    Sentence(String),
    /// A number, aligned with the others of its column at the point.
    Number(String),
}

impl Cell {
    /// Nothing.
    pub(super) fn empty() -> Self {
        Cell::Number(String::new())
    }

    /// Words, escaped.
    pub(super) fn text(text: impl AsRef<str>) -> Self {
        Cell::Text(html! { (text.as_ref()) })
    }

    /// A number as text, with an ASCII minus sign and an `e` for the power of ten.
    pub(super) fn number(text: impl AsRef<str>) -> Self {
        Cell::Number(typeset(text.as_ref()))
    }

    /// A number with at least so many significant digits, and as far as that is
    /// readable without a power of ten: those of a column are compared by eye.
    pub(super) fn plain(value: f64, digits: usize) -> Self {
        match value.abs() {
            size if (1e6..1e12).contains(&size) => Self::number(format!("{value:.0}")),
            _ => Self::number(crate::report::number::digits(value, digits)),
        }
    }

    fn is_empty(&self) -> bool {
        match self {
            Cell::Text(markup) => markup.0.is_empty(),
            Cell::Number(text) | Cell::Sentence(text) => text.is_empty(),
        }
    }

    /// What stands behind the last digit of the integer part.
    fn tail(&self) -> &str {
        match self {
            Cell::Number(text) => text.find('.').map_or("", |point| &text[point..]),
            Cell::Text(_) | Cell::Sentence(_) => "",
        }
    }
}

/// A table of rows; the first cell of each says what the row is of. Columns
/// that are empty in every row are left out.
pub(super) fn table(caption: &str, titles: &[&str], rows: &[Vec<Cell>]) -> Markup {
    let filled = |column: usize| rows.iter().any(|row| !row[column].is_empty());
    let columns: Vec<usize> = (0..titles.len()).filter(|column| filled(*column)).collect();
    let is_number = |column: usize| {
        let mut cells = rows.iter().map(|row| &row[column]).filter(|cell| !cell.is_empty());
        cells.any(|cell| matches!(cell, Cell::Number(_)))
    };
    let widest: Vec<usize> = (0..titles.len())
        .map(|column| rows.iter().map(|row| width(row[column].tail())).max().unwrap_or(0))
        .collect();
    html! {
        div.scroll {
            table {
                @if !caption.is_empty() { caption { (caption) } }
                thead {
                    tr {
                        @for &column in &columns {
                            th scope="col" class=[is_number(column).then_some("n")] {
                                (titles[column])
                            }
                        }
                    }
                }
                tbody {
                    @for row in rows {
                        tr {
                            @for (place, &column) in columns.iter().enumerate() {
                                @if place == 0 && matches!(row[column], Cell::Text(_)) {
                                    th scope="row" { (content(&row[column])) }
                                } @else {
                                    (data(&row[column], widest[column]))
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn content(cell: &Cell) -> Markup {
    match cell {
        Cell::Text(markup) => markup.clone(),
        Cell::Number(text) | Cell::Sentence(text) => html! { (text) },
    }
}

fn data(cell: &Cell, widest: usize) -> Markup {
    let missing = match cell {
        Cell::Number(text) if !text.is_empty() => padding(cell.tail(), widest),
        _ => String::new(),
    };
    let class = match cell {
        Cell::Text(_) => None,
        Cell::Sentence(_) => Some("w"),
        Cell::Number(_) => Some("n"),
    };
    html! {
        td class=[class] data-pad=[(!missing.is_empty()).then_some(missing)] { (content(cell)) }
    }
}

/// What, invisible behind a number, makes it as wide as the widest of its
/// column right of the point.
fn padding(tail: &str, widest: usize) -> String {
    let missing = widest - width(tail);
    match (tail.is_empty(), missing) {
        (_, 0) => String::new(),
        (true, missing) => format!(".{}", "0".repeat(missing - 1)),
        (false, missing) => "0".repeat(missing),
    }
}

fn width(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(name: &str, number: &str, last: &str) -> Vec<Cell> {
        vec![Cell::text(name), Cell::number(number), Cell::number(last)]
    }

    #[test]
    fn shorter_numbers_are_padded_behind_the_point() {
        let rows = [row("a", "-10.25", ""), row("b", "7", ""), row("c", "0.1", "")];
        let text = table("", &["", "value", "nothing"], &rows).into_string();
        assert!(text.contains("<td class=\"n\">−10.25</td>"), "{text}");
        assert!(text.contains("<td class=\"n\" data-pad=\".00\">7</td>"), "{text}");
        assert!(text.contains("<td class=\"n\" data-pad=\"0\">0.1</td>"), "{text}");
    }

    #[test]
    fn large_numbers_are_written_out() {
        let text = |value| match Cell::plain(value, 4) {
            Cell::Number(text) => text,
            other => panic!("{other:?}"),
        };
        assert_eq!([3_920_665.4, 607.04, 2e15].map(text), ["3920665", "607.0", "2.000·10¹⁵"]);
    }

    #[test]
    fn a_column_without_content_is_left_out() {
        let text = table("", &["", "value", "nothing"], &[row("a", "1", "")]).into_string();
        assert!(!text.contains("nothing"), "{text}");
        assert_eq!(text.matches("<th scope=\"col\"").count(), 2, "{text}");
    }

    #[test]
    fn what_a_user_wrote_is_escaped() {
        let text = table("", &["", "", ""], &[row("<b>", "1", "2")]).into_string();
        assert!(text.contains("&lt;b&gt;") && !text.contains("<b>"), "{text}");
    }
}
