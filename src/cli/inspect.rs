//! `servoscope inspect`

use std::path::PathBuf;

use serde::Serialize;
use servoscope_core::answers::{IdentifyOptions, Inspection};
use servoscope_core::diagnose::DiagnoseError;
use servoscope_core::identify::IdentifyError;
use servoscope_core::measurement::Measurement;

use crate::report;
use crate::service::{BuiltIn, JobRequest, Numerics, Submission, measured};

use super::choice::one_of;
use super::{Failure, computation, given, terminal};

/// Arguments of `inspect`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Files of one measurement: harmonic tables or time records.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Order of the actuator [default: chosen from the data].
    #[arg(long, value_name = "N", value_parser = one_of::<u8>(["0", "1", "2"]))]
    actuator_order: Option<u8>,
    /// Standard deviation of the noise in the real and imaginary parts of every harmonic, response
    /// units, for data that carry neither deviations nor repeats [default: estimated from what
    /// the fit leaves].
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    noise_std: Option<f64>,
    /// Prints the inspection as JSON, and nothing else.
    #[arg(long, help_heading = "Output")]
    json: bool,
    #[command(flatten)]
    given: given::Args,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Printed<'a> {
    /// How the files were understood, in sentences.
    notes: &'a [String],
    /// Standard deviation of the noise in each of re and im of a harmonic (rms), response units; null
    /// if it is not known.
    noise_std: Option<f64>,
    #[serde(flatten)]
    inspection: &'a Inspection,
}

/// Says how a measurement was understood, what looks wrong with it, and what it can show.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let options = IdentifyOptions { noise_std: args.noise_std, ..IdentifyOptions::default() };
    let submission = Submission {
        kind: "identify".into(),
        actuator_order: args.actuator_order,
        options,
        ..Submission::default()
    };
    let request = JobRequest::check(&submission)?.identify();
    let files = computation::read(&args.files, &args.given)?;
    let sources = computation::sources(&files);
    let measurement = BuiltIn.read(&sources).map_err(Failure::input)?;
    let watch = computation::Watch::new();
    let inspection = BuiltIn.inspect(&measurement, &request, &watch);
    watch.finish();
    let inspection = inspection.map_err(|error| match error {
        DiagnoseError::Identify(error @ IdentifyError::Cancelled) => Failure::other(error),
        error => Failure::input(error),
    })?;
    match args.json {
        true => {
            let noise_std = measurement.noise_std().or(args.noise_std);
            let printed =
                Printed { notes: measurement.notes(), noise_std, inspection: &inspection };
            terminal::print_raw(computation::json(&printed)?.as_bytes())
        }
        false => {
            let mut measured = measured(Some(&measurement), &sources);
            measured.notes.extend(noise(&measurement));
            terminal::print(&report::inspection(&measured, &inspection, terminal::width()))
        }
    }
}

/// How large the noise is, if the measurement tells it.
fn noise(measurement: &Measurement) -> Option<String> {
    let (std, decibels) = (measurement.noise_std()?, measurement.noise_db()?);
    let unit = &measurement.metadata().response.unit;
    let std = format!("{std:.2e} {unit}");
    Some(format!(
        "the noise has a standard deviation of {} in each of re and im of a harmonic (rms), {decibels:.0} \
         dB below the median fundamental",
        std.trim()
    ))
}
