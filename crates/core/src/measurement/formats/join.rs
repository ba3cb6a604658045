//! Joins the contents of several files into one measurement.

use sha2::{Digest, Sha256};

use super::fault::ParseError;
use super::header::Header;
use super::part::Part;
use super::source::Source;
use crate::measurement::{Lines, Measurement, Metadata, scatter};

/// Hexadecimal SHA-256 of the bytes of all sources.
pub(super) fn digest(sources: &[Source<'_>]) -> String {
    let mut digest = Sha256::new();
    sources.iter().for_each(|source| digest.update(source.bytes));
    digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Joins the parsed files, `parts[i]` from `sources[i]`. `sha256` is the digest of the measurement.
pub(super) fn join(
    sources: &[Source<'_>],
    parts: Vec<Part>,
    sha256: String,
) -> Result<Measurement, ParseError> {
    let several = sources.len() > 1;
    let (mut experiments, mut transients) = (Vec::new(), Vec::new());
    let mut notes = Vec::new();
    let mut metadata: Option<Metadata> = None;
    // Line numbers of several files could not be told apart.
    let lines = match parts.as_slice() {
        [only] => only.lines.clone(),
        _ => Lines::new(),
    };
    for (source, part) in sources.iter().zip(parts) {
        match &mut metadata {
            None => metadata = Some(part.header.metadata.clone()),
            Some(metadata) => {
                check_units(metadata, &part.header, source.name)?;
                merge(metadata, part.header.metadata, source.name, &mut notes);
            }
        }
        notes.extend(
            part.notes
                .into_iter()
                .map(|note| if several { format!("{}: {note}", source.name) } else { note }),
        );
        for mut remarked in part.experiments {
            if several && part.runs_from_clock {
                // Clocks of different files cannot be compared, so they give no common order.
                remarked.content.run = None;
            }
            experiments.push(remarked.content);
            let number = experiments.len();
            notes.extend(
                remarked.remarks.iter().map(|remark| format!("experiment {number}: {remark}")),
            );
        }
        for mut remarked in part.transients {
            if several && part.runs_from_clock {
                remarked.content.run = None;
            }
            transients.push(remarked.content);
            let number = transients.len();
            notes
                .extend(remarked.remarks.iter().map(|remark| format!("motion {number}: {remark}")));
        }
    }
    let file = sources.first().map_or("upload", |source| source.name);
    let fault = |reason| ParseError {
        file: file.to_owned(),
        line: None,
        column: None,
        reason,
        lacks: Vec::new(),
    };
    if !experiments.is_empty() && !transients.is_empty() {
        return Err(fault(format!(
            "{} of {} experiments have a period and the others have none: give period_s where it \
             is not found, or period_s: none for all, or upload them apart",
            experiments.len(),
            experiments.len() + transients.len()
        )));
    }
    notes.extend(scatter::remark(&experiments));
    let metadata = metadata.unwrap_or_default();
    let joined = match transients.is_empty() {
        true => Measurement::new(metadata, experiments, notes, sha256),
        false => Measurement::of_transients(metadata, transients, notes, sha256),
    };
    joined.map(|joined| joined.with_lines(lines)).map_err(|error| fault(error.to_string()))
}

/// Checks that a further file has the same units as those before it.
///
/// A name or unit that one of them does not state is compatible with any. The kind of the response
/// always has a value, since it defaults to velocity.
fn check_units(metadata: &Metadata, header: &Header, file: &str) -> Result<(), ParseError> {
    let fault = |key: &str, reason: String| ParseError {
        file: file.to_owned(),
        line: header.line_of(key),
        column: Some(key.to_owned()),
        reason,
        lacks: Vec::new(),
    };
    if metadata.response_kind != header.metadata.response_kind {
        return Err(fault(
            "response",
            format!(
                "mixed units: the response is {:?}, in the files before {:?}",
                header.metadata.response_kind, metadata.response_kind
            )
            .to_lowercase(),
        ));
    }
    let pairs = [
        ("input", &metadata.input, &header.metadata.input),
        ("response", &metadata.response, &header.metadata.response),
    ];
    for (key, before, here) in pairs {
        let differ =
            |a: &str, b: &str| !a.is_empty() && !b.is_empty() && !a.eq_ignore_ascii_case(b);
        // Units are case-sensitive: mA is not MA.
        let units_differ =
            !before.unit.is_empty() && !here.unit.is_empty() && before.unit != here.unit;
        if differ(&before.name, &here.name) || units_differ {
            return Err(fault(
                key,
                format!(
                    "mixed units: `{} {}` here, `{} {}` in the files before",
                    here.name, here.unit, before.name, before.unit
                ),
            ));
        }
    }
    Ok(())
}

/// Takes over metadata that the earlier files do not state. Where the two contradict, keeps the
/// earlier value and adds a note.
fn merge(metadata: &mut Metadata, here: Metadata, file: &str, notes: &mut Vec<String>) {
    let mut differs = |key: &str| {
        notes.push(format!("{file}: {key} differs from the files before and is not used"));
    };
    fn fill<T: PartialEq>(open: &mut Option<T>, here: Option<T>) -> bool {
        let contradicts = open.is_some() && here.is_some() && *open != here;
        if open.is_none() {
            *open = here;
        }
        contradicts
    }
    let texts = [
        ("name", &mut metadata.name, here.name),
        ("machine", &mut metadata.machine, here.machine),
        ("axis", &mut metadata.axis, here.axis),
        ("operator", &mut metadata.operator, here.operator),
    ];
    for (key, open, here) in texts {
        if fill(open, here) {
            differs(key);
        }
    }
    if fill(&mut metadata.feedback, here.feedback) {
        differs("loop");
    }
    if fill(&mut metadata.measured_at, here.measured_at) {
        differs("measured_at");
    }
    let quantities = [(&mut metadata.input, here.input), (&mut metadata.response, here.response)];
    for (open, here) in quantities {
        if open.name.is_empty() {
            open.name = here.name;
        }
        if open.unit.is_empty() {
            open.unit = here.unit;
        }
    }
    for (label, value) in here.labels {
        let held = metadata.labels.entry(label.clone()).or_insert_with(|| value.clone());
        if *held != value {
            differs(&format!("label.{label}"));
        }
    }
}
