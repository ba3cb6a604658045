//! What was measured.

use maud::{Markup, html};

use servoscope_core::answers::{Comparison, NoiseSource};

use super::Content;
use super::table::{Cell, table};
use super::words::{coded, number, quantity, sentence};

/// The most values that are listed rather than given as a range.
const LISTED: usize = 6;

/// What an upload says of itself and what is in it, as a page shows it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measured {
    /// Free name of the measurement.
    pub name: Option<String>,
    /// The machine.
    pub machine: Option<String>,
    /// Its axis.
    pub axis: Option<String>,
    /// When it was measured, RFC 3339.
    pub measured_at: Option<String>,
    /// Who measured it.
    pub operator: Option<String>,
    /// Labels and their values.
    pub labels: Vec<(String, String)>,
    /// Quantity of the input, `current`; empty where not said.
    pub input: String,
    /// Unit of the input; empty where not said.
    pub input_unit: String,
    /// Quantity of the response.
    pub response: String,
    /// Its unit; empty where not said.
    pub response_unit: String,
    /// Whether a controller closed a loop around the axis, where said.
    pub closed_loop: Option<bool>,
    /// Experiments, each with one periodic input.
    pub experiments: usize,
    /// Different magnitudes, input units, ascending.
    pub magnitudes: Vec<f64>,
    /// Different fundamentals, rad/s, ascending.
    pub omegas_rad_s: Vec<f64>,
    /// Lowest and highest harmonic.
    pub harmonics: [usize; 2],
    /// Fewest and most repeats or periods of an experiment.
    pub repeats: [usize; 2],
    /// Whether harmonics were computed from records over time.
    pub from_records: bool,
    /// Whether the order of acquisition is known.
    pub runs_known: bool,
    /// The files.
    pub files: Vec<DataFile>,
    /// Remarks of the reader of the files, in sentences.
    pub notes: Vec<String>,
}

/// A file of a measurement.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataFile {
    /// Its name.
    pub name: String,
    /// Its length, bytes.
    pub bytes: usize,
    /// SHA-256 of its content, hexadecimal.
    pub sha256: String,
}

impl Measured {
    /// The machine and its axis, or what else is known of them.
    pub(super) fn subject(&self) -> String {
        let axis = self.axis.as_ref().map(|axis| format!("axis {axis}"));
        match (&self.machine, axis) {
            (Some(machine), Some(axis)) => format!("{machine}, {axis}"),
            (Some(machine), None) => machine.clone(),
            (None, Some(axis)) => axis,
            (None, None) => self.name.clone().unwrap_or_else(|| "a servo axis".to_owned()),
        }
    }

    /// When, who and what else the upload says.
    pub(super) fn origin(&self) -> Vec<String> {
        let at = self.measured_at.as_ref().map(|at| format!("measured {}", day_and_time(at)));
        let by = self.operator.as_ref().map(|operator| format!("by {operator}"));
        let when = [at, by].into_iter().flatten().collect::<Vec<_>>().join(" ");
        let named = self.machine.is_some() || self.axis.is_some();
        let name = self.name.clone().filter(|_| named);
        let labels = self.labels.iter().map(|(label, value)| format!("{label} {value}"));
        let parts = std::iter::once(when).chain(name).chain(labels);
        parts.filter(|part| !part.is_empty()).collect()
    }
}

/// A time to the minute: `2026-03-04 10:20 UTC`. What is not written as the
/// reader of metadata writes it stays as it is.
fn day_and_time(rfc3339: &str) -> String {
    let is_utc = rfc3339.is_ascii() && rfc3339.len() >= 20 && rfc3339.ends_with('Z');
    match is_utc && rfc3339.as_bytes()[10] == b'T' {
        true => format!("{} {} UTC", &rfc3339[..10], &rfc3339[11..16]),
        false => rfc3339.to_owned(),
    }
}

/// What was measured, in rows, remarks and files.
pub(super) fn described(content: &Content<'_>) -> Markup {
    let measured = content.measured;
    html! {
        h3 { "What was measured" }
        dl.pairs {
            @for (name, value) in rows(content) {
                div { dt { (name) } dd { (value) } }
            }
        }
        @if !measured.notes.is_empty() {
            p { "How the files were read:" }
            ul { @for note in &measured.notes { li { (coded(&sentence(note))) } } }
        }
        (files(&measured.files))
    }
}

fn rows(content: &Content<'_>) -> Vec<(&'static str, String)> {
    let noise = ("Noise", noise(content.answer.base().noise, content.comparison));
    read(content.measured).into_iter().chain([noise]).collect()
}

/// What was read, by name; empty where nothing could be.
pub(in crate::report) fn read(measured: &Measured) -> Vec<(&'static str, String)> {
    let Measured { magnitudes, omegas_rad_s, harmonics: [low, high], .. } = measured;
    if measured.experiments == 0 {
        return Vec::new();
    }
    let hertz: Vec<f64> = omegas_rad_s.iter().map(|w| w / std::f64::consts::TAU).collect();
    let feedback = measured.closed_loop.map(|closed| match closed {
        true => "closed: a controller was active",
        false => "open",
    });
    let order = match (measured.experiments, measured.runs_known) {
        (1, _) => "",
        (_, true) => "known",
        (_, false) => "not given: a drift cannot be told",
    };
    let (input, response) = (&measured.input, &measured.response);
    let rows = [
        ("Input", with_unit(input, &measured.input_unit)),
        ("Response", with_unit(response, &measured.response_unit)),
        ("Loop", feedback.unwrap_or_default().to_owned()),
        ("Experiments", experiments(measured)),
        ("Magnitudes", values(magnitudes, &measured.input_unit)),
        ("Fundamentals", values(&hertz, "Hz")),
        ("Harmonics", if low == high { low.to_string() } else { format!("{low} to {high}") }),
        ("Order of acquisition", order.to_owned()),
    ];
    rows.into_iter().filter(|(_, value)| !value.is_empty()).collect()
}

fn with_unit(quantity: &str, unit: &str) -> String {
    match (quantity, unit) {
        ("", unit) => unit.to_owned(),
        (quantity, "") => quantity.to_owned(),
        (quantity, unit) => format!("{quantity}, {unit}"),
    }
}

fn experiments(measured: &Measured) -> String {
    let [fewest, most] = measured.repeats;
    let of = if measured.from_records { "periods" } else { "repeats" };
    let repeats = match (fewest, most) {
        (_, 0 | 1) => String::new(),
        (fewest, most) if fewest == most => format!(", {most} {of} each"),
        (fewest, most) => format!(", {fewest} to {most} {of} each"),
    };
    format!("{}{repeats}", measured.experiments)
}

/// A few values one by one, many as a range.
fn values(values: &[f64], unit: &str) -> String {
    let (Some(first), Some((last, others))) = (values.first(), values.split_last()) else {
        return String::new();
    };
    if values.len() <= LISTED {
        let others = others.iter().map(|value| format!("{}, ", number(*value, 4)));
        return format!("{}{}", others.collect::<String>(), quantity(*last, 4, unit));
    }
    let (first, last, count) = (number(*first, 4), quantity(*last, 4, unit), values.len());
    format!("{first} to {last} ({count} values)")
}

fn noise(source: NoiseSource, comparison: Option<&Comparison>) -> String {
    let source = match source {
        NoiseSource::Given => "as given with the data",
        NoiseSource::Repeats => "from the scatter of the repeats",
        NoiseSource::Periods => "from the scatter from period to period",
        NoiseSource::Estimated => "not known; estimated from the residual",
    };
    let Some(comparison) = comparison else { return source.to_owned() };
    let stds = || comparison.experiments.iter().flat_map(|e| &e.harmonics).map(|h| h.std);
    let (low, high) = (stds().fold(f64::INFINITY, f64::min), stds().fold(0.0, f64::max));
    let unit = &comparison.response_unit;
    if !(low.is_finite() && high > 0.0) {
        return source.to_owned();
    }
    let (low_text, high_text) = (number(low, 2), quantity(high, 2, unit));
    let same = number(high, 2) == low_text;
    let range = if same { high_text } else { format!("{low_text} to {high_text}") };
    format!("{source}: a standard deviation of {range} in each part of a harmonic")
}

fn files(files: &[DataFile]) -> Markup {
    let rows: Vec<Vec<Cell>> = files
        .iter()
        .map(|file| {
            let digest = html! { code.digest { (file.sha256) } };
            let name = Cell::text(&file.name);
            vec![name, Cell::number(file.bytes.to_string()), Cell::Text(digest)]
        })
        .collect();
    html! { @if !rows.is_empty() { (table("", &["File", "bytes", "SHA-256"], &rows)) } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_named_after_the_machine_or_what_else_is_known() {
        let text = |text: &str| Some(text.to_owned());
        let mut measured = Measured { machine: text("RT"), axis: text("C"), ..Measured::default() };
        assert_eq!(measured.subject(), "RT, axis C");
        measured.machine = None;
        assert_eq!(measured.subject(), "axis C");
        measured.axis = None;
        assert_eq!(measured.subject(), "a servo axis");
    }

    #[test]
    fn few_values_are_listed_and_many_are_a_range() {
        assert_eq!(values(&[1.0, 2.0], "A"), "1, 2\u{a0}A");
        let many: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!(values(&many, "Hz"), "1 to 20\u{a0}Hz (20 values)");
    }

    #[test]
    fn a_time_is_written_to_the_minute() {
        assert_eq!(day_and_time("2026-03-04T10:20:30Z"), "2026-03-04 10:20 UTC");
        assert_eq!(day_and_time("last week"), "last week");
    }
}
