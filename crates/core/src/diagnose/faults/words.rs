//! Sentences about faults of a measurement, and about what mends them.

use std::f64::consts::TAU;

use crate::answers::{Channel, FaultKind, InterpolatedSamples, LeftOutRow, MeasurementFault};
use crate::measurement::{Measurement, Metadata, per_cent};

use crate::diagnose::residuals::sentence::short;

/// Most rows that are named in a sentence.
const MOST_NAMED: usize = 5;

/// Writes the sentences of faults that are mended.
pub(super) fn describe(faults: &mut [MeasurementFault], measurement: &Measurement) {
    write(faults, measurement, |found, mended| format!("{found}{mended}"));
}

/// Writes the sentences of faults that are not mended.
pub(crate) fn describe_suspects(faults: &mut [MeasurementFault], measurement: &Measurement) {
    write(faults, measurement, |found, _| found);
}

fn write(
    faults: &mut [MeasurementFault],
    measurement: &Measurement,
    sentence: impl Fn(String, &str) -> String,
) {
    for fault in faults {
        for row in &mut fault.left_out {
            row.line = measurement.line(row.experiment, row.harmonic, row.repeat);
        }
        fault.left_out.sort_by_key(|row| (row.line, row.experiment, row.harmonic, row.repeat));
        let (found, mended) = words(fault, measurement);
        fault.sentence = sentence(found, mended);
        fault.remedy = remedy(fault).into();
    }
}

/// What is wrong, and what is done about it.
fn words(fault: &MeasurementFault, measurement: &Measurement) -> (String, &'static str) {
    let unit = |unit: &str| if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let input = unit(&measurement.metadata().input.unit);
    let value = fault.value.unwrap_or(f64::NAN);
    let digits = |value: f64| rounded(value, fault.interval95);
    let interval = match fault.interval95 {
        Some([low, high]) => format!(" (95 % from {} to {})", digits(low), digits(high)),
        None => String::new(),
    };
    let place = match (fault.magnitude, fault.experiment) {
        (Some(magnitude), _) => format!("at magnitude {}{input}", short(magnitude)),
        (_, Some(index)) => place(measurement, index),
        _ => String::new(),
    };
    match fault.fault {
        FaultKind::BadRows => (rows(&fault.left_out, measurement), "; left out"),
        FaultKind::StdFactor => (
            format!(
                "the residual looks like noise of {} times the stated standard deviation{interval}",
                digits(value)
            ),
            "; corrected: the noise is taken to be that large",
        ),
        FaultKind::LevelGain | FaultKind::RunGain => {
            let is_either = fault.experiment.is_some() && measurement.experiments().len() == 2;
            let doubt =
                if is_either { "; the data do not show which of the two is wrong" } else { "" };
            (
                format!(
                    "{place} the response is {} times as large as the rest of the measurement \
                     predicts{interval}{doubt}",
                    digits(value)
                ),
                "; corrected: divided by that",
            )
        }
        FaultKind::LevelPhase | FaultKind::RunPhase => (
            format!(
                "{place} the phase of the fundamental differs by {}°{interval} from what the rest \
                 of the measurement predicts",
                digits(value)
            ),
            "; corrected: phase of harmonic k shifted by −k times this angle",
        ),
        FaultKind::Conjugated => (
            "the phase has the wrong sign".into(),
            "; corrected: the sign of the phase was reversed; the response then fits an axis",
        ),
        FaultKind::ReversedSign => (
            "the response has the wrong sign".into(),
            "; corrected: the sign of the response was reversed; it then fits an axis",
        ),
        FaultKind::SineReference => (
            "the harmonics refer to a sine, not to a cosine".into(),
            "; corrected: harmonic k turned by (k − 1)·90°; the response then fits an axis",
        ),
        FaultKind::ResponseKind => (
            format!(
                "the response is read as {}, but behaves as {}",
                with_article(kind_name(measurement)),
                with_article(fault.response.as_deref().unwrap_or_default())
            ),
            "; treated as such",
        ),
        FaultKind::AmplitudeConvention => {
            let is_rms = value > 1.0;
            let convention = if is_rms { "rms" } else { "peak-to-peak" };
            let mended =
                if is_rms { "; corrected: multiplied by √2" } else { "; corrected: halved" };
            (
                format!(
                    "means and harmonics fit together only if the amplitudes are {convention} \
                         values"
                ),
                mended,
            )
        }
        FaultKind::HeldInput => (
            "between its samples the input is held: it acts half a sample later than it was read"
                .into(),
            "; treated as such",
        ),
        FaultKind::StraightInput => {
            ("between its samples the input is interpolated linearly".into(), "; treated as such")
        }
        FaultKind::ClippedInput => (
            format!(
                "the channel of the input clips: {} of its samples are cut off",
                per_cent(value)
            ),
            "; corrected: they are estimated together with the model",
        ),
        FaultKind::ClippedResponse => (
            format!(
                "the channel of the response clips: {} of its samples are cut off",
                per_cent(value)
            ),
            "; corrected: what is simulated is cut off as well",
        ),
        FaultKind::BadSamples => (
            samples(&fault.interpolated, measurement),
            "; corrected: interpolated from their neighbours",
        ),
        FaultKind::ChannelSkew => {
            let ends = fault.interval95.map(|ends| ends.map(|end| 1e3 * end));
            let interval = ends.map(|both| both.map(|end| rounded(end, ends)));
            let interval = interval
                .map_or(String::new(), |[low, high]| format!(" (95 % from {low} to {high})"));
            let ahead = rounded(1e3 * value, ends);
            (
                format!(
                    "the response leads the input by {ahead} ms{interval}, which is impossible"
                ),
                "; corrected: delayed by that",
            )
        }
    }
}

/// A number to two digits of the width of its interval.
fn rounded(value: f64, interval95: Option<[f64; 2]>) -> String {
    match interval95 {
        Some([low, high]) if high > low => {
            let decimals = 1.0 - (high - low).log10().floor();
            format!("{value:.*}", decimals.clamp(0.0, 12.0) as usize)
        }
        _ => short(value),
    }
}

/// A kind of response as one of several: a velocity, an acceleration.
fn with_article(kind: &str) -> String {
    let article = if kind.starts_with('a') { "an" } else { "a" };
    format!("{article} {kind}")
}

fn kind_name(measurement: &Measurement) -> &'static str {
    use crate::measurement::ResponseKind::{Acceleration, Position, Velocity};
    match measurement.metadata().response_kind {
        Velocity => "velocity",
        Position => "position",
        Acceleration => "acceleration",
    }
}

fn place(measurement: &Measurement, index: usize) -> String {
    let Some(experiment) = measurement.experiments().get(index) else { return String::new() };
    if experiment.pure_cosine().is_none() {
        return format!("in experiment {}", index + 1);
    }
    let unit = &measurement.metadata().input.unit;
    let space = if unit.is_empty() { "" } else { " " };
    format!(
        "at magnitude {}{space}{unit} and {} Hz",
        short(experiment.magnitude),
        short(experiment.omega_rad_s / TAU)
    )
}

fn rows(left_out: &[LeftOutRow], measurement: &Measurement) -> String {
    let name = |row: &LeftOutRow| {
        let repeat = row.repeat.map_or(String::new(), |r| format!(", repeat {}", r + 1));
        let place = place(measurement, row.experiment);
        match row.line {
            Some(line) => format!("line {line} (harmonic {} {place}{repeat})", row.harmonic),
            None => format!("harmonic {} {place}{repeat}", row.harmonic),
        }
    };
    let size = |row: &LeftOutRow| {
        format!(
            "{} % off the fit, {} standard deviations",
            short(100.0 * row.off),
            short(row.sigmas)
        )
    };
    match left_out {
        [row] => {
            format!("{} is an outlier: {}", name(row), size(row))
        }
        rows => {
            let named: Vec<String> = rows
                .iter()
                .take(MOST_NAMED)
                .map(|row| format!("{}: {}", name(row), size(row)))
                .collect();
            let more = rows.len().saturating_sub(MOST_NAMED);
            let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
            format!("{} rows are outliers: {}{rest}", rows.len(), named.join("; "))
        }
    }
}

/// Samples that do not belong, the first few by name.
fn samples(bad: &[InterpolatedSamples], measurement: &Measurement) -> String {
    let name = |one: &InterpolatedSamples| {
        let Metadata { input, response, .. } = measurement.metadata();
        let (channel, unit) = match one.channel {
            Channel::Input => ("input", &input.unit),
            Channel::Response => ("response", &response.unit),
        };
        let space = if unit.is_empty() { "" } else { " " };
        let line = one.line.map_or(String::new(), |line| format!("line {line}, "));
        let count = if one.count > 1 { format!("{} samples ", one.count) } else { String::new() };
        format!(
            "{line}{count}at {:.6} s: the {channel} is {}{space}{unit} off, {} standard deviations",
            one.time_s,
            short(one.off),
            short(one.sigmas)
        )
    };
    let named: Vec<String> = bad.iter().take(MOST_NAMED).map(name).collect();
    let more = bad.len().saturating_sub(MOST_NAMED);
    let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
    let is_one = matches!(bad, [one] if one.count == 1);
    let what = if is_one { "one sample does" } else { "samples do" };
    format!("{what} not belong to the rest: {}{rest}", named.join("; "))
}

fn remedy(fault: &MeasurementFault) -> &'static str {
    match fault.fault {
        FaultKind::BadRows => "measure again what is listed, or delete its lines",
        FaultKind::StdFactor => "correct the column `std` (or the option noise_std)",
        FaultKind::LevelGain | FaultKind::RunGain => {
            "look for a range or a gain that was switched, correct the values, or measure this again"
        }
        FaultKind::LevelPhase | FaultKind::RunPhase => {
            "look for a filter or a trigger that was switched, correct the phases, or measure this \
             again"
        }
        FaultKind::Conjugated => "reverse the sign of `im` or `phase_deg`",
        FaultKind::ReversedSign => {
            "reverse the sign of the response: swap the wires of the sensor, \
             or add 180° to the phase"
        }
        FaultKind::SineReference => "add the line `# reference: sin` above the header",
        FaultKind::ResponseKind => "state what was measured, as in `# response: position rad`",
        FaultKind::AmplitudeConvention if fault.value.is_some_and(|factor| factor > 1.0) => {
            "add the line `# amplitude: rms` above the header, or the option `--amplitude rms`"
        }
        FaultKind::AmplitudeConvention => {
            "add the line `# amplitude: peak-to-peak` above the header, or the option `--amplitude \
             peak-to-peak`"
        }
        FaultKind::HeldInput => "add the line `# intersample: hold` above the header",
        FaultKind::StraightInput => "add the line `# intersample: linear` above the header",
        FaultKind::ClippedInput | FaultKind::ClippedResponse => {
            "measure again with a larger range of this channel, or with a smaller input"
        }
        FaultKind::BadSamples => {
            "look for a disturbance of the wires or a fault of the transmission at these times"
        }
        FaultKind::ChannelSkew => "correct the delay between the channels of the instrument",
    }
}
