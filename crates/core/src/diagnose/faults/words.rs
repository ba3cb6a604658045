//! Sentences about faults of a measurement, and about what mends them.

use std::f64::consts::TAU;

use crate::answers::{FaultKind, LeftOutRow, MeasurementFault};
use crate::measurement::Measurement;

use crate::diagnose::residuals::sentence::short;

/// Most rows that are named in a sentence.
const MOST_NAMED: usize = 5;

/// Writes the sentences of all faults.
pub(crate) fn describe(faults: &mut [MeasurementFault], measurement: &Measurement) {
    for fault in faults {
        for row in &mut fault.left_out {
            row.line = measurement.line(row.experiment, row.harmonic, row.repeat);
        }
        fault.left_out.sort_by_key(|row| (row.line, row.experiment, row.harmonic, row.repeat));
        fault.sentence = sentence(fault, measurement);
        fault.remedy = remedy(fault).into();
    }
}

fn sentence(fault: &MeasurementFault, measurement: &Measurement) -> String {
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
        FaultKind::BadRows => rows(&fault.left_out, measurement),
        FaultKind::StdFactor => format!(
            "what is left looks like noise of {} times the stated standard deviation{interval}: the \
             noise is taken to be that large",
            digits(value)
        ),
        FaultKind::LevelGain | FaultKind::RunGain => format!(
            "{place} the response is {} times as large as all else says{interval}: it is divided by \
             that",
            digits(value)
        ),
        FaultKind::LevelPhase | FaultKind::RunPhase => format!(
            "{place} the phase of the fundamental differs by {}°{interval} from what all else says: \
             it is turned back, harmonic k by k times as much",
            digits(value)
        ),
        FaultKind::Conjugated => {
            "the phase has the wrong sign: conjugated, the response is that of \
             an axis"
                .into()
        }
        FaultKind::ReversedSign => {
            "the response has the wrong sign: reversed, it is that of an axis".into()
        }
        FaultKind::SineReference => "the harmonics refer to a sine, not to a cosine: turned by \
             (k − 1)·90°, they are those of an axis"
            .into(),
        FaultKind::ResponseKind => format!(
            "the response is read as a {}, but behaves as a {}: taken as that",
            kind_name(measurement),
            fault.response.as_deref().unwrap_or_default()
        ),
        FaultKind::AmplitudeConvention => format!(
            "the means do not fit the harmonics unless these are {} values: they are \
             multiplied by {value:.4}",
            if value > 1.0 { "rms" } else { "peak-to-peak" }
        ),
        FaultKind::ChannelSkew => {
            let ends = fault.interval95.map(|ends| ends.map(|end| 1e3 * end));
            let interval = ends.map(|both| both.map(|end| rounded(end, ends)));
            format!(
                "the response is ahead of the input by {} ms{}, which no machine can be: it is \
                 delayed by that",
                rounded(1e3 * value, ends),
                interval
                    .map_or(String::new(), |[low, high]| format!(" (95 % from {low} to {high})"))
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
    format!(
        "at magnitude {} and {} Hz",
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
        format!("{} % off, {} standard deviations", short(100.0 * row.off), short(row.sigmas))
    };
    match left_out {
        [row] => {
            format!("{} does not belong to the rest: {}; left out", name(row), size(row))
        }
        rows => {
            let named: Vec<String> = rows
                .iter()
                .take(MOST_NAMED)
                .map(|row| format!("{}: {}", name(row), size(row)))
                .collect();
            let more = rows.len().saturating_sub(MOST_NAMED);
            let rest = if more > 0 { format!("; and {more} more") } else { String::new() };
            format!(
                "{} rows do not belong to the rest and are left out: {}{rest}",
                rows.len(),
                named.join("; ")
            )
        }
    }
}

fn remedy(fault: &MeasurementFault) -> &'static str {
    match fault.fault {
        FaultKind::BadRows => "measure these again, or delete their lines",
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
        FaultKind::SineReference => "add the line `# reference: sine` above the header",
        FaultKind::ResponseKind => "state what was measured, as in `# response: position rad`",
        FaultKind::AmplitudeConvention => {
            "state what the amplitudes are: `# amplitude: rms`, or `peak-to-peak`"
        }
        FaultKind::ChannelSkew => "correct the delay between the channels of the instrument",
    }
}
