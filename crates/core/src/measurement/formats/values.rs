//! Reads values of metadata; an error says what would be right.

use super::decimal::is_decimal;
use super::limits::MAX_SETTLE_PERIODS;

/// The number that a value is, with a decimal point or one decimal comma; `None` if it is none.
///
/// # Errors
/// If the comma may as well stand between thousands.
fn parsed(value: &str) -> Result<Option<f64>, String> {
    if value.matches(',').count() != 1 || value.contains('.') {
        return Ok(value.parse().ok());
    }
    let Ok(number) = value.replace(',', ".").parse::<f64>() else { return Ok(None) };
    if is_decimal(value) {
        return Ok(Some(number));
    }
    Err(format!(
        "the comma of `{value}` may be a decimal comma or stand between thousands: write {} or \
         {number:?}",
        value.replace(',', "")
    ))
}

pub(super) fn period(value: &str) -> Result<f64, String> {
    match parsed(value)? {
        Some(period) if period.is_finite() && period > 0.0 => Ok(period),
        _ => Err(format!("`{value}` is neither a positive number of seconds nor none")),
    }
}

pub(super) fn sample(value: &str) -> Result<f64, String> {
    match parsed(value)? {
        Some(sample) if sample.is_finite() && sample > 0.0 => Ok(sample),
        _ => Err(format!("`{value}` is not a positive number of seconds")),
    }
}

pub(super) fn averages(value: &str) -> Result<f64, String> {
    match parsed(value)? {
        Some(averages) if averages.is_finite() && averages > 0.0 => Ok(averages),
        _ => Err(format!("`{value}` is not a positive number")),
    }
}

pub(super) fn magnitude(value: &str) -> Result<f64, String> {
    match parsed(value)? {
        Some(magnitude) if magnitude.is_finite() && magnitude > 0.0 => Ok(magnitude),
        _ => Err(format!("`{value}` is not a positive number, in units of the input")),
    }
}

/// Names between semicolons, or between commas where there is no semicolon.
pub(super) fn names(value: &str) -> Result<Vec<String>, String> {
    let mark = if value.contains(';') { ';' } else { ',' };
    let names: Vec<String> = value.split(mark).map(|name| name.trim().to_owned()).collect();
    match names.iter().filter(|name| !name.is_empty()).count() {
        0 | 1 => Err("the names of at least two columns are needed, in their order".into()),
        _ => Ok(names),
    }
}

pub(super) fn number(value: &str) -> Result<f64, String> {
    match parsed(value)? {
        Some(number) if number.is_finite() => Ok(number),
        _ => Err(format!("`{value}` is not a finite number")),
    }
}

pub(super) fn settle_periods(value: &str) -> Result<usize, String> {
    match parsed(value)? {
        Some(count) if count >= 0.0 && count.fract() == 0.0 => {
            if count > MAX_SETTLE_PERIODS as f64 {
                return Err(format!("{count} is more than {MAX_SETTLE_PERIODS}"));
            }
            Ok(count as usize)
        }
        _ => Err(format!("`{value}` is not an integer ≥ 0")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_comma_is_a_decimal_mark() {
        assert_eq!(magnitude("0,5"), Ok(0.5));
        assert_eq!(period("1,25"), Ok(1.25));
        assert_eq!(sample("0,001"), Ok(0.001));
        assert_eq!(averages("16,0"), Ok(16.0));
        assert_eq!(number("-0,5"), Ok(-0.5));
        assert_eq!(number("1,5e-3"), Ok(0.0015));
        assert_eq!(settle_periods("2,0"), Ok(2));
    }

    #[test]
    fn a_comma_between_thousands_is_refused_and_says_what_to_write() {
        let refusal = magnitude("1,000").unwrap_err();
        assert!(refusal.ends_with("write 1000 or 1.0"), "{refusal}");
        let refusal = number("-12,345").unwrap_err();
        assert!(refusal.ends_with("write -12345 or -12.345"), "{refusal}");
        for value in ["1,234,567", "1.234,5", "a,b", ","] {
            assert!(magnitude(value).unwrap_err().contains("not a positive number"), "{value}");
        }
    }
}
