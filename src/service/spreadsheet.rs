//! Text of strangers in tables that a spreadsheet opens.

use std::borrow::Cow;

/// How a formula begins.
const BEGINS: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];

/// What ends a cell, within quotes as well, for a spreadsheet that separates cells by semicolons: there
/// a quote in the midst of a line is a character like any other.
const ENDS: [char; 3] = [';', '\n', '\r'];

/// A cell that no spreadsheet takes for a formula, in whole or in part: text that begins as one gets
/// an apostrophe, which spreadsheets read as "this is text" (OWASP, CSV Injection). Numbers stay as
/// they are.
pub fn harmless(cell: &str) -> Cow<'_, str> {
    let is_formula = |part: &str| part.starts_with(BEGINS) && part.parse::<f64>().is_err();
    if !cell.split(ENDS).any(is_formula) {
        return Cow::Borrowed(cell);
    }
    let parts = cell.split_inclusive(ENDS);
    let marked = parts.map(|part| match is_formula(part.trim_end_matches(ENDS)) {
        true => format!("'{part}"),
        false => part.to_owned(),
    });
    marked.collect::<String>().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_that_begins_as_a_formula_is_marked_as_text() {
        for formula in ["=HYPERLINK(\"http://evil.example\")", "+1+2", "-2+3", "@SUM(A1)", "\t=1"] {
            assert_eq!(harmless(formula), format!("'{formula}"));
        }
        for (text, marked) in [
            ("x;=HYPERLINK(A1)", "x;'=HYPERLINK(A1)"),
            ("=1;+2+2;-3", "'=1;'+2+2;-3"),
            ("two\r\n=1", "two\r\n'=1"),
            (";@SUM(A1)", ";'@SUM(A1)"),
        ] {
            assert_eq!(harmless(text), marked);
        }
        for plain in ["-1.5", "+2", "-1e-9", "axis = 1", "", "north", "a; b=c;-1"] {
            assert_eq!(harmless(plain), plain);
        }
    }
}
