//! Reads values of metadata; an error says what would be right.

use super::limits::MAX_SETTLE_PERIODS;

pub(super) fn period(value: &str) -> Result<f64, String> {
    match value.parse::<f64>() {
        Ok(period) if period.is_finite() && period > 0.0 => Ok(period),
        _ => Err(format!("`{value}` is neither a positive number of seconds nor none")),
    }
}

pub(super) fn sample(value: &str) -> Result<f64, String> {
    match value.parse::<f64>() {
        Ok(sample) if sample.is_finite() && sample > 0.0 => Ok(sample),
        _ => Err(format!("`{value}` is not a positive number of seconds")),
    }
}

pub(super) fn averages(value: &str) -> Result<f64, String> {
    match value.parse::<f64>() {
        Ok(averages) if averages.is_finite() && averages > 0.0 => Ok(averages),
        _ => Err(format!("`{value}` is not a positive number")),
    }
}

pub(super) fn magnitude(value: &str) -> Result<f64, String> {
    match value.parse::<f64>() {
        Ok(magnitude) if magnitude.is_finite() && magnitude > 0.0 => Ok(magnitude),
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
    match value.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("`{value}` is not a finite number")),
    }
}

pub(super) fn settle_periods(value: &str) -> Result<usize, String> {
    match value.parse::<f64>() {
        Ok(count) if count >= 0.0 && count.fract() == 0.0 => {
            if count > MAX_SETTLE_PERIODS as f64 {
                return Err(format!("{count} is more than {MAX_SETTLE_PERIODS}"));
            }
            Ok(count as usize)
        }
        _ => Err(format!("`{value}` is not an integer ≥ 0")),
    }
}
