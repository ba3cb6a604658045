//! Numbers in a sentence: rounded to few significant digits.

use crate::diagnose::residuals::layout::Span;

/// A number of one digit between two others or, if there is none, of two digits near them.
pub(super) fn between(low: f64, high: f64) -> String {
    let middle = (low.max(0.25 * high) * high).sqrt();
    let inside = |text: &String| text.parse::<f64>().is_ok_and(|v| v > low && v < high);
    Some(rounded(middle, 1)).filter(inside).unwrap_or_else(|| rounded(middle, 2))
}

pub(super) fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

/// A number with two significant digits, or all of its integer part.
pub(crate) fn short(value: f64) -> String {
    rounded(value, 2)
}

/// A number with this many significant digits, its whole integer part, and no trailing zeros.
pub(crate) fn rounded(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..6).contains(&exponent) {
        return format!("{value:.*e}", (digits - 1).max(0) as usize);
    }
    let decimals = (digits - 1 - exponent).max(0) as usize;
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A class of magnitudes: one number, or the smallest and the largest.
pub(crate) fn span(span: Span) -> String {
    match short(span[0]) == short(span[1]) {
        true => short(span[0]),
        false => format!("{} to {}", short(span[0]), short(span[1])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let values = [0.0, 0.0123, 0.5, 1.0, 9.96, 12.3, 1234.5, 1.5e-7];
        let said = values.map(short);
        assert_eq!(said, ["0", "0.012", "0.5", "1", "10", "12", "1234", "1.5e-7"]);
        // No number of two digits lies between 52.0 and 52.3.
        assert_eq!([between(0.8, 1.6), between(52.0, 52.3)], ["1", "52"]);
    }
}
