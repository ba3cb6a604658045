//! Writes a measurement as a harmonic table in CSV.

use std::io::{self, Write};

use crate::measurement::{
    Complex, Experiment, Harmonic, Loop, Measurement, Metadata, Quantity, ResponseKind,
};

/// Which of the optional columns to write.
#[derive(Debug, Clone, Copy)]
struct Optional {
    std: bool,
    repeat: bool,
    run: bool,
    input: bool,
}

/// Writes a measurement as a harmonic table.
///
/// The metadata comes first, then one row per (experiment, repeat, harmonic). The columns `std`,
/// `repeat`, `run` and `u_re,u_im` are written only if some experiment needs them. A repeat is
/// written as the mean plus its deviation. Numbers have the fewest digits that read back as the
/// same number. Reading the text therefore reproduces the measurement to rounding error, except
/// for its notes and digest, and what a table cannot say of a record: how its input runs between
/// samples, which rounding repeats, and how fast a position moves on.
///
/// # Errors
/// Any error of `out`.
pub fn write_harmonic_csv(measurement: &Measurement, out: &mut impl Write) -> io::Result<()> {
    write_metadata(measurement, out)?;
    let experiments = measurement.experiments();
    let any = |needs: fn(&Experiment) -> bool| experiments.iter().any(needs);
    let optional = Optional {
        std: any(|experiment| experiment.response.iter().any(|harmonic| harmonic.std.is_some())),
        repeat: any(Experiment::has_repeats),
        run: any(|experiment| experiment.run.is_some()),
        input: any(needs_input),
    };
    write!(out, "magnitude,omega_rad_s,experiment,harmonic,re,im")?;
    for (name, needed) in [
        ("std", optional.std),
        ("repeat", optional.repeat),
        ("run", optional.run),
        ("u_re,u_im", optional.input),
    ] {
        if needed {
            write!(out, ",{name}")?;
        }
    }
    writeln!(out)?;
    for (index, experiment) in experiments.iter().enumerate() {
        for repeat in 0..experiment.repeats.len().max(1) {
            write_repeat(out, experiment, index, repeat, optional)?;
        }
    }
    Ok(())
}

/// Whether the input differs from m·cos(ωt), which the reader assumes if no input is given.
fn needs_input(experiment: &Experiment) -> bool {
    let cosine = [Complex::ZERO, Complex::new(experiment.magnitude, 0.0)];
    experiment.input_mean_measured
        || experiment.input != cosine
        || experiment.repeats.iter().any(|repeat| !repeat.input.is_empty())
}

/// Whether to write the mean of the input. Beside a position, the reader takes it for the statement
/// that the position returns.
fn has_input_mean(experiment: &Experiment) -> bool {
    experiment.input_mean_measured && experiment.mean_velocity == 0.0
}

fn write_repeat(
    out: &mut impl Write,
    experiment: &Experiment,
    index: usize,
    repeat: usize,
    optional: Optional,
) -> io::Result<()> {
    let deviation = experiment.repeats.get(repeat);
    let with_input = needs_input(experiment);
    let lines = if with_input { experiment.input.len() } else { 0 };
    // The reader divides the deviation of each of M repeats by √M to get that of their mean.
    let std_factor = (experiment.repeats.len().max(1) as f64).sqrt();
    let mut response = experiment.response.iter().enumerate().peekable();
    for order in 0..lines.max(experiment.highest_harmonic() + 1) {
        let harmonic = response.next_if(|(_, harmonic)| harmonic.order == order);
        let input = (order < lines && (order > 0 || has_input_mean(experiment)))
            .then(|| experiment.input[order] + deviation_at(deviation.map(|d| &d.input), order));
        if harmonic.is_none() && input.is_none() {
            continue;
        }
        let response: Option<(&Harmonic, Complex)> = harmonic.map(|(position, harmonic)| {
            let offset = deviation_at(deviation.map(|d| &d.response), position);
            (harmonic, harmonic.value + offset)
        });
        write!(out, "{},{},{index},{order}", experiment.magnitude, experiment.omega_rad_s)?;
        write_complex(out, response.map(|(_, value)| value))?;
        if optional.std {
            write_number(out, response.and_then(|(harmonic, _)| Some(harmonic.std? * std_factor)))?;
        }
        if optional.repeat {
            write!(out, ",{repeat}")?;
        }
        if optional.run {
            write_number(out, experiment.run)?;
        }
        if optional.input {
            write_complex(out, input)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

fn deviation_at(deviations: Option<&Vec<Complex>>, index: usize) -> Complex {
    deviations.and_then(|deviations| deviations.get(index)).copied().unwrap_or(Complex::ZERO)
}

fn write_complex(out: &mut impl Write, value: Option<Complex>) -> io::Result<()> {
    write_number(out, value.map(|value| value.re))?;
    write_number(out, value.map(|value| value.im))
}

fn write_number(out: &mut impl Write, value: Option<f64>) -> io::Result<()> {
    // `{:?}` writes the fewest digits, as `{}` does, but uses an exponent where that is shorter.
    match value {
        Some(value) => write!(out, ",{value:?}"),
        None => write!(out, ","),
    }
}

fn write_metadata(measurement: &Measurement, out: &mut impl Write) -> io::Result<()> {
    let metadata = measurement.metadata();
    let mut line = |key: &str, value: &str| {
        if value.is_empty() {
            return Ok(());
        }
        // A text of several lines would go on as rows of the table, or as other metadata.
        let [key, value] = [key, value].map(|text| text.replace(char::is_control, " "));
        writeln!(out, "{}", one_cell(format!("# {key}: {value}")))
    };
    line("name", metadata.name.as_deref().unwrap_or(""))?;
    line("input", &quantity(&metadata.input))?;
    line("response", &response(metadata))?;
    if let Some(feedback) = metadata.feedback {
        line("loop", if feedback == Loop::Open { "open" } else { "closed" })?;
    }
    line("machine", metadata.machine.as_deref().unwrap_or(""))?;
    line("axis", metadata.axis.as_deref().unwrap_or(""))?;
    if let Some(measured_at) = metadata.measured_at {
        line("measured_at", &measured_at.to_string())?;
    }
    line("operator", metadata.operator.as_deref().unwrap_or(""))?;
    for (label, value) in &metadata.labels {
        line(&format!("label.{label}"), value)?;
    }
    let from_record = measurement.experiments().iter().all(|experiment| experiment.from_record);
    if from_record { line("repeats", "periods") } else { Ok(()) }
}

/// A line as one cell, however a spreadsheet separates them: the text of a stranger behind a comma
/// would be a cell of its own, and with `=` in front a formula.
fn one_cell(line: String) -> String {
    match line.contains([',', ';', '"']) {
        true => format!("\"{}\"", line.replace('"', "\"\"")),
        false => line,
    }
}

fn quantity(quantity: &Quantity) -> String {
    let Quantity { name, unit } = quantity;
    if unit.is_empty() && !name.contains(' ') {
        name.clone()
    } else if name.contains(' ') || unit.contains(['(', '[']) {
        format!("{name} [{unit}]")
    } else {
        format!("{name} {unit}")
    }
}

fn response(metadata: &Metadata) -> String {
    let kind = match metadata.response_kind {
        ResponseKind::Velocity => "velocity",
        ResponseKind::Position => "position",
        ResponseKind::Acceleration => "acceleration",
    };
    let Quantity { name, unit } = &metadata.response;
    if name.is_empty() && unit.is_empty() && metadata.response_kind == ResponseKind::Velocity {
        return String::new();
    }
    let name = if name.is_empty() { kind.to_owned() } else { name.clone() };
    quantity(&Quantity { name, unit: unit.clone() })
}
