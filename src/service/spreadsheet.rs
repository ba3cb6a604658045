//! Text of strangers in tables that a spreadsheet opens.

use std::borrow::Cow;

/// A cell that no spreadsheet takes for a formula: text that begins as one gets an apostrophe, which
/// spreadsheets read as "this is text" (OWASP, CSV Injection). Numbers stay as they are.
pub fn harmless(cell: &str) -> Cow<'_, str> {
    let begins = cell.starts_with(['=', '+', '-', '@', '\t', '\r']);
    if begins && cell.parse::<f64>().is_err() {
        Cow::Owned(format!("'{cell}"))
    } else {
        Cow::Borrowed(cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_that_begins_as_a_formula_is_marked_as_text() {
        for formula in ["=HYPERLINK(\"http://evil.example\")", "+1+2", "-2+3", "@SUM(A1)", "\t=1"] {
            assert_eq!(harmless(formula), format!("'{formula}"));
        }
        for plain in ["-1.5", "+2", "-1e-9", "axis = 1", "", "north"] {
            assert_eq!(harmless(plain), plain);
        }
    }
}
