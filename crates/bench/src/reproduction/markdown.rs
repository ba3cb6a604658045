//! Markdown tables and the notation of their cells.

use servoscope_core::measurement::Complex;

/// A Markdown table with aligned columns; the first is left-aligned, the others right-aligned.
pub(super) fn markdown(header: &[String], rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).chain(header.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0).max(3)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let line = |cells: &[String]| {
        let padded = cells.iter().zip(&widths).enumerate().map(|(i, (cell, width))| match i {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        format!("| {} |\n", padded.collect::<Vec<_>>().join(" | "))
    };
    let rule = widths.iter().enumerate().map(|(i, width)| match i {
        0 => "-".repeat(*width),
        _ => format!("{}:", "-".repeat(width - 1)),
    });
    let rule = format!("| {} |\n", rule.collect::<Vec<_>>().join(" | "));
    line(header) + &rule + &rows.iter().map(|row| line(row)).collect::<String>()
}

/// A value in the notation of the paper, with the given number of decimals.
pub(super) fn written(value: Complex, decimals: usize, complex: bool) -> String {
    // Avoid printing −0.0.
    let re = if value.re.abs() < 0.5 * 10.0_f64.powi(-(decimals as i32)) { 0.0 } else { value.re };
    match complex {
        true => format!("{re:.decimals$}{:+.decimals$}i", value.im),
        false => format!("{re:.decimals$}"),
    }
}

/// A share in percent; small values have more decimals, very small ones an exponent.
pub(super) fn percent(share: f64) -> String {
    let value = 100.0 * share;
    match value {
        _ if value.is_nan() => "–".into(),
        _ if value == 0.0 => "0 %".into(),
        _ if value < 0.001 => format!("{value:.1e} %"),
        _ if value < 1.0 => format!("{value:.4} %"),
        _ => format!("{value:.2} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_written_with_digits_that_say_something() {
        let shares = [f64::NAN, 0.0, 1.2e-8, 4e-5, 0.123];
        assert_eq!(shares.map(percent), ["–", "0 %", "1.2e-6 %", "0.0040 %", "12.30 %"]);
    }
}
