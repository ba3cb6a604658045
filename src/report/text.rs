//! An identification as plain text for a terminal.

use std::fmt::Write as _;

use crate::answers::{
    Fit, Identification, NoiseSource, OrderChoice, ParameterEstimate, Stage, TransferFunction,
};

/// Writes an identification the way it is read: what was found, how sure it is,
/// how well it fits, and what the data cannot tell.
pub fn identification(answer: &Identification) -> String {
    let mut sections = vec![
        section("Parameters", parameters(answer)),
        section("Transfer function", transfer_function(&answer.transfer_function)),
        section("Fit", fit(&answer.fit, answer.noise)),
    ];
    if let Some(choice) = &answer.order_choice {
        sections.push(section("Actuator order", order(choice)));
    }
    sections.push(section("Stages", stages(&answer.stages, &answer.stop_reason)));
    if !answer.limitations.is_empty() {
        let lines = answer.limitations.iter().map(|text| format!("- {text}"));
        sections.push(section("Limitations", lines.collect()));
    }
    let provenance = &answer.provenance;
    sections.push(format!(
        "servoscope {}, method {}, seed {}, data {}\n",
        provenance.software_version,
        answer.method.name(),
        answer.seed,
        provenance.data_sha256,
    ));
    sections.join("\n")
}

fn section(title: &str, lines: Vec<String>) -> String {
    lines.into_iter().fold(format!("{title}\n"), |mut text, line| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {line}");
        text
    })
}

fn parameters(answer: &Identification) -> Vec<String> {
    let rows = answer.parameters.iter().map(|(name, estimate)| {
        let ParameterEstimate { value, std, interval95, unit, .. } = estimate;
        let digits = digits(*value, *std);
        [
            name.clone(),
            value.map_or("unknown".to_owned(), |value| significant(value, digits)),
            std.map_or(String::new(), |std| format!("± {}", significant(std, 2))),
            interval95.map_or(String::new(), |[low, high]| {
                format!("[{}, {}]", significant(low, digits), significant(high, digits))
            }),
            unit.clone(),
            flags(estimate),
        ]
    });
    let header = ["", "value", "std", "95 % interval", "unit", ""].map(str::to_owned);
    table(std::iter::once(header).chain(rows).collect())
}

/// Significant digits of a value that end where its deviation, to two digits, does.
fn digits(value: Option<f64>, std: Option<f64>) -> usize {
    let place = |number: Option<f64>| {
        number.filter(|x| *x != 0.0 && x.is_finite()).map(|x| x.abs().log10().floor() as i32)
    };
    match (place(value), place(std)) {
        // 15: what a double holds of decimal digits.
        (Some(value), Some(std)) => (value - std + 2).clamp(2, 15) as usize,
        _ => 6,
    }
}

fn flags(estimate: &ParameterEstimate) -> String {
    let mut flags = Vec::new();
    if !estimate.identifiable {
        flags.push("not identifiable from this data");
    }
    if estimate.at_bound {
        flags.push("at the bound of what is physically possible");
    }
    flags.join(", ")
}

fn transfer_function(function: &TransferFunction) -> Vec<String> {
    let poles = function.poles.iter().map(|&[re, im]| match im {
        0.0 => significant(re, 6),
        _ if im < 0.0 => format!("{} − {}j", significant(re, 6), significant(-im, 6)),
        _ => format!("{} + {}j", significant(re, 6), significant(im, 6)),
    });
    vec![
        format!(
            "G(s) = ({}) / ({})",
            polynomial(&function.numerator),
            polynomial(&function.denominator)
        ),
        format!("poles {} rad/s", poles.collect::<Vec<_>>().join(", ")),
        format!("DC gain {}", significant(function.dc_gain, 6)),
    ]
}

fn fit(fit: &Fit, noise: NoiseSource) -> Vec<String> {
    let left = format!("{} % of the response (NRMSE)", significant(100.0 * fit.nrmse, 3));
    let verdict = match fit.adequate {
        Some(true) => {
            format!("Adequate: the model explains the data to within its noise; it leaves {left}.")
        }
        Some(false) => format!("Not adequate: beyond the noise, the model leaves {left}."),
        None => format!(
            "The noise is unknown, so nothing can be said of adequacy; the model leaves {left}."
        ),
    };
    let mut lines = vec![verdict];
    if let (Some(chi2), Some(per_dof)) = (fit.chi2, fit.chi2_per_dof) {
        lines.push(format!(
            "χ² {} over {} degrees of freedom: {} each",
            significant(chi2, 5),
            fit.dof,
            significant(per_dof, 3)
        ));
    }
    lines.push(match noise {
        NoiseSource::Given => "The noise was given.".to_owned(),
        NoiseSource::Repeats => "The noise is the scatter of the repeats.".to_owned(),
        NoiseSource::Periods => "The noise is the scatter from period to period.".to_owned(),
        NoiseSource::Estimated => "The noise is estimated from what the model leaves.".to_owned(),
    });
    if fit.uncertainty_scale > 1.0 {
        lines.push(format!(
            "Every deviation above is widened by {} for what the model leaves.",
            significant(fit.uncertainty_scale, 3)
        ));
    }
    lines
}

fn order(choice: &OrderChoice) -> Vec<String> {
    let rows = choice.candidates.iter().map(|candidate| {
        [
            candidate.actuator_order.to_string(),
            significant(candidate.chi2, 6),
            candidate.parameters.to_string(),
            significant(candidate.criterion, 6),
        ]
    });
    let header = ["order", "χ²", "parameters", "criterion"].map(str::to_owned);
    let mut lines = vec![choice.explanation.clone()];
    lines.extend(table(std::iter::once(header).chain(rows).collect()));
    lines
}

fn stages(stages: &[Stage], stop_reason: &str) -> Vec<String> {
    let rows = stages.iter().map(|stage| {
        [
            stage.name.clone(),
            stage.evaluations.to_string(),
            format!("{:.2}", stage.seconds),
            significant(stage.cost, 6),
            stage.stop_reason.clone(),
        ]
    });
    let header = ["", "evaluations", "seconds", "cost", "ended because"].map(str::to_owned);
    let mut lines = table(std::iter::once(header).chain(rows).collect());
    lines.push(format!("Ended: {stop_reason}"));
    lines
}

/// Aligns columns to their widest cell, left-justified.
fn table<const COLUMNS: usize>(rows: Vec<[String; COLUMNS]>) -> Vec<String> {
    let mut widths = [0; COLUMNS];
    for row in &rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let line = |row: &[String; COLUMNS]| {
        let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}

/// A polynomial in s from its coefficients, highest power first.
fn polynomial(coefficients: &[f64]) -> String {
    let mut text = String::new();
    for (index, &coefficient) in coefficients.iter().enumerate() {
        let power = coefficients.len() - 1 - index;
        let sign = match (text.is_empty(), coefficient < 0.0) {
            (true, false) => "",
            (true, true) => "−",
            (false, false) => " + ",
            (false, true) => " − ",
        };
        let size = coefficient.abs();
        let factor = if size == 1.0 && power > 0 { String::new() } else { significant(size, 6) };
        let variable = match power {
            0 => String::new(),
            1 => "s".to_owned(),
            _ => format!("s^{power}"),
        };
        let space = if factor.is_empty() || variable.is_empty() { "" } else { " " };
        let _ = write!(text, "{sign}{factor}{space}{variable}");
    }
    text
}

/// A number with so many significant digits, without trailing zeros.
fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = value.abs().log10().floor() as i32;
    if !(-4..6).contains(&exponent) {
        return format!("{value:.*e}", digits - 1);
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn a_parameter_is_one_line_with_deviation_interval_and_unit() {
        let text = identification(&sample::identification());
        let line = text.lines().find(|line| line.contains("pole  ")).unwrap();
        let words = line.split_whitespace().collect::<Vec<_>>();
        assert_eq!(words, ["pole", "-10.02", "±", "0.031", "[-10.081,", "-9.9592]", "rad/s"]);
    }

    #[test]
    fn digits_end_where_the_deviation_does() {
        let mut answer = sample::identification();
        let pole = answer.parameters.get_mut("pole").unwrap();
        pole.value = Some(-10.0000001);
        pole.std = Some(1.4e-7);
        pole.interval95 = Some([-10.000000374, -9.999999826]);
        let text = identification(&answer);
        assert!(text.contains("[-10.00000037, -9.999999826]"), "{text}");
    }

    #[test]
    fn what_the_data_cannot_tell_is_said_not_shown_as_a_number() {
        let text = identification(&sample::identification());
        let line = text.lines().find(|line| line.contains("fc_minus  ")).unwrap();
        assert!(line.contains("unknown") && line.contains("not identifiable"), "{line}");
        let line = text.lines().find(|line| line.contains("fc_plus  ")).unwrap();
        assert!(line.contains("at the bound"), "{line}");
        assert!(text.contains("- One magnitude only"));
    }

    #[test]
    fn the_fit_is_a_sentence_for_each_verdict() {
        let mut answer = sample::identification();
        assert!(identification(&answer).contains("Adequate: the model explains the data"));
        answer.fit.adequate = Some(false);
        assert!(identification(&answer).contains("the model leaves 1.23 % of the response"));
        answer.fit.adequate = None;
        assert!(identification(&answer).contains("The noise is unknown"));
    }

    #[test]
    fn the_transfer_function_is_written_as_one() {
        let text = identification(&sample::identification());
        assert!(text.contains("G(s) = (10.01) / (s + 10.02)"), "{text}");
        assert_eq!(polynomial(&[1.0, -2.0, 0.5]), "s^2 − 2 s + 0.5");
    }

    #[test]
    fn numbers_keep_their_significant_digits_at_any_size() {
        assert_eq!(significant(0.00123456, 3), "0.00123");
        assert_eq!(significant(-123.456, 4), "-123.5");
        assert_eq!(significant(1.5e-7, 2), "1.5e-7");
        assert_eq!(significant(2.5e6, 6), "2.50000e6");
        assert_eq!(significant(100000.0, 6), "100000");
        assert_eq!(significant(0.0, 6), "0");
    }
}
