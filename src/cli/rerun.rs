//! `servoscope rerun`

use std::path::PathBuf;

use serde_json::Value;
use servoscope_bench::methods::METHODS;
use servoscope_core::answers::{Answer, JobKind, PlantRequest, Provenance};
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::measurement::Measurement;

use crate::service::{BuiltIn, Numerics};

use super::{Failure, computation, given, terminal};

/// Differences that are listed.
const LISTED: usize = 10;

/// Arguments of `rerun`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// What `identify --json` or `diagnose --json` has printed, or the result of a job.
    #[arg(value_name = "RESULT.json")]
    result: PathBuf,
    /// Files that it was computed from.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// The second measurement, for a diagnosis that had one; repeat it for a measurement of several
    /// files [default: none].
    #[arg(long, value_name = "FILE")]
    validate: Vec<PathBuf>,
    /// Prints the result computed this time as JSON.
    #[arg(long, help_heading = "Output")]
    json: bool,
    #[command(flatten)]
    given: given::Args,
}

/// Computes a result again, from what it says of itself, and compares every bit.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let answer = computation::stored_answer(&args.result)?;
    let Provenance { software_version, data_sha256, options, actuator_order } =
        answer.provenance().clone();
    let version = env!("CARGO_PKG_VERSION");
    if software_version != version {
        eprintln!("note: computed by servoscope {software_version}, this is {version}");
    }
    let measurement = computation::measurement(&args.files, &args.given)?;
    is_the_data(&measurement, &data_sha256, "these")?;
    let second = second(&answer, args)?;
    let kind = match &answer {
        Answer::Identification(_) => JobKind::Identify,
        Answer::Diagnosis(_) => JobKind::Diagnose,
    };
    let plant = actuator_order.map(|actuator_order| PlantRequest { actuator_order });
    let method = answer.base().method;
    let request =
        IdentifyRequest { plant, method, options, methods: METHODS, ..Default::default() };
    let watch = computation::Watch::new();
    let again = BuiltIn.answer(kind, &measurement, second.as_ref(), &request, &watch);
    watch.finish();
    let again = again.map_err(Failure::other)?;
    let differences = differences(&answer, &again)?;
    let same = "SAME: every number is identical to the last bit, except for computing times\n";
    let printed = match (args.json, differences.is_empty()) {
        (true, _) => computation::json(&again)?,
        (false, true) => same.to_owned(),
        (false, false) => String::new(),
    };
    terminal::print_raw(printed.as_bytes())?;
    if differences.is_empty() {
        return Ok(());
    }
    let more = differences.len().saturating_sub(LISTED);
    let mut text = format!("{} members differ:", differences.len());
    for difference in differences.iter().take(LISTED) {
        text.push_str("\n  ");
        text.push_str(difference);
    }
    if more > 0 {
        text.push_str(&format!("\n  and {more} more"));
    }
    Err(Failure::Other(text))
}

fn is_the_data(measurement: &Measurement, sha256: &str, what: &str) -> Result<(), Failure> {
    if measurement.sha256() == sha256 {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "{what} are not the files that the result was computed from (SHA-256 {sha256}, these have \
         {}). Give the same files with the same options for reading them",
        measurement.sha256()
    )))
}

fn second(answer: &Answer, args: &Args) -> Result<Option<Measurement>, Failure> {
    let files = args.validate.as_slice();
    let validation = answer.diagnosis().and_then(|diagnosis| diagnosis.validation.as_ref());
    match (validation, files.is_empty()) {
        (None, true) => Ok(None),
        (None, false) => {
            Err(Failure::Input("--validate: the result had no second measurement".into()))
        }
        (Some(validation), true) => Err(Failure::Input(format!(
            "the result had a second measurement with the SHA-256 {}; give it with --validate",
            validation.data_sha256
        ))),
        (Some(validation), false) => {
            let second = computation::measurement(files, &args.given)?;
            is_the_data(&second, &validation.data_sha256, "those of --validate")?;
            Ok(Some(second))
        }
    }
}

/// Members whose values are not the same, and both values; times are left out.
fn differences(before: &Answer, after: &Answer) -> Result<Vec<String>, Failure> {
    let value = |answer: &Answer| serde_json::to_value(answer).map_err(Failure::other);
    let mut found = Vec::new();
    compare("", &value(before)?, &value(after)?, &mut found);
    Ok(found)
}

fn compare(path: &str, before: &Value, after: &Value, found: &mut Vec<String>) {
    let inside = |name: &str| if path.is_empty() { name.into() } else { format!("{path}.{name}") };
    match (before, after) {
        (Value::Object(a), Value::Object(b)) => {
            let added = b.keys().filter(|key| !a.contains_key(*key));
            for key in a.keys().chain(added) {
                // Wall-clock time is the one thing that no seed repeats.
                if key != "seconds" {
                    let none = &Value::Null;
                    let values = (a.get(key).unwrap_or(none), b.get(key).unwrap_or(none));
                    compare(&inside(key), values.0, values.1, found);
                }
            }
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            for (index, (a, b)) in a.iter().zip(b).enumerate() {
                compare(&inside(&index.to_string()), a, b, found);
            }
        }
        (a, b) if a == b => {}
        (a, b) => found.push(format!("{path}: {a} was {b} this time", a = a, b = b)),
    }
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::sample;

    use super::*;

    #[test]
    fn times_may_differ_and_nothing_else_may() {
        let before = sample::identification();
        let mut after = before.clone();
        if let Some(stage) = after.stages.first_mut() {
            stage.seconds += 1.0;
        }
        assert!(differences(&before.clone().into(), &after.clone().into()).unwrap().is_empty());
        after.fit.nrmse = f64::from_bits(after.fit.nrmse.to_bits() + 1);
        let found = differences(&before.into(), &after.into()).unwrap();
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].starts_with("fit.nrmse: "), "{found:?}");
    }
}
