//! What `identify`, `diagnose` and `validate` share: reading, computing with progress, printing.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use clap::builder::PossibleValuesParser;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use servoscope_core::answers::{Answer, ConvergenceRow, IdentifyOptions, Method, Progress};
use servoscope_core::diagnose::DiagnoseError;
use servoscope_core::identify::IdentifyError;
use servoscope_core::measurement::Measurement;
use servoscope_core::measurement::formats::Source;
use servoscope_core::observer::Observer;

use crate::service::{BuiltIn, JobRequest, Numerics, Submission};

use super::choice::one_of;
use super::{Failure, given, interrupt, shown, terminal};

/// Steps of the progress bar.
const STEPS: u64 = 1000;

/// Arguments of a computation from files.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Args {
    /// Files of one measurement: harmonic tables or time records.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Order of the actuator [default: chosen from the data].
    #[arg(long, value_name = "N", value_parser = one_of::<u8>(["0", "1", "2"]))]
    actuator_order: Option<u8>,
    /// How parameters are estimated [default: abc-ann].
    #[arg(long, value_name = "NAME")]
    #[arg(value_parser = PossibleValuesParser::new(Method::all().map(Method::name)))]
    method: Option<String>,
    /// Seed of every random choice; the same seed gives the same result [default: 1].
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Standard deviation of the noise in the real and imaginary parts of every harmonic, response
    /// units, for data that carry neither deviations nor repeats [default: estimated from what
    /// the fit leaves].
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    noise_std: Option<f64>,
    /// Further options as a JSON object, such as '{"most_effects": 2}': the `options` of a job over
    /// HTTP [default: {}].
    #[arg(long, value_name = "JSON")]
    options: Option<String>,
    /// Prints the result as JSON, and nothing else.
    #[arg(long, help_heading = "Output")]
    json: bool,
    // Groups with a heading of their own come last: what follows one would stand under it.
    #[command(flatten)]
    pub(super) given: given::Args,
    #[command(flatten)]
    pub(super) shown: shown::Args,
}

/// Computes an answer from the files, prints it, and writes its figures and its
/// page where they are asked for.
pub(super) fn answer(
    args: &Args,
    kind: &str,
    second: Option<&Measurement>,
    keep_all: bool,
) -> Result<(), Failure> {
    args.shown.check()?;
    let mut submission = submission(args, kind)?;
    submission.options.keep_all |= keep_all;
    let request = JobRequest::check(&submission)?;
    let files = read(&args.files, &args.given)?;
    let sources = sources(&files);
    let measurement = BuiltIn.read(&sources).map_err(Failure::input)?;
    let watch = Watch::new();
    let answer = BuiltIn.answer(request.kind, &measurement, second, &request.identify(), &watch);
    watch.finish();
    let answer = answer.map_err(|error| match error {
        DiagnoseError::Identify(error @ IdentifyError::Cancelled) => Failure::other(error),
        DiagnoseError::Identify(error @ IdentifyError::Options(_)) => Failure::input(error),
        error @ DiagnoseError::Validation(_) => Failure::Input(format!("--validate: {error}")),
        DiagnoseError::Identify(error @ IdentifyError::Unusable { .. }) => {
            // They may say why; an answer carries them itself.
            for note in measurement.notes() {
                eprintln!("note: {note}");
            }
            Failure::input(error)
        }
    })?;
    match args.json {
        true => terminal::print_raw(json(&answer)?.as_bytes())?,
        false => args.shown.print(&answer)?,
    }
    args.shown.write(&answer, &measurement, &sources, &watch.rows())
}

fn submission(args: &Args, kind: &str) -> Result<Submission, Failure> {
    let mut options = args.options.as_deref().map_or(Ok(IdentifyOptions::default()), options)?;
    options.seed = args.seed.unwrap_or(options.seed);
    options.noise_std = args.noise_std.or(options.noise_std);
    Ok(Submission {
        kind: kind.into(),
        actuator_order: args.actuator_order,
        method: args.method.clone(),
        options,
        ..Submission::default()
    })
}

/// The options of a method from JSON.
pub(super) fn options(text: &str) -> Result<IdentifyOptions, Failure> {
    let mut json = serde_json::Deserializer::from_str(text);
    let options = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        match error.inner().is_data() {
            true => Failure::Input(format!("--options: {error}")),
            false => Failure::Input(format!("--options: this is not JSON: {}", error.inner())),
        }
    })?;
    json.end().map_err(|error| Failure::Input(format!("--options: this is not JSON: {error}")))?;
    Ok(options)
}

/// Reads files that together are one measurement.
pub(super) fn measurement(paths: &[PathBuf], given: &given::Args) -> Result<Measurement, Failure> {
    BuiltIn.read(&sources(&read(paths, given)?)).map_err(Failure::input)
}

pub(super) fn sources(files: &[(String, Vec<u8>)]) -> Vec<Source<'_>> {
    files.iter().map(|(name, bytes)| Source { name, bytes }).collect()
}

/// The files, and behind them what is given beside them.
pub(super) fn read(
    paths: &[PathBuf],
    given: &given::Args,
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let file = |path: &PathBuf| match std::fs::read(path) {
        Ok(bytes) => Ok((path.display().to_string(), bytes)),
        Err(error) => Err(Failure::unread(path, &error)),
    };
    let mut files = paths.iter().map(file).collect::<Result<Vec<_>, _>>()?;
    files.extend(given.file()?);
    Ok(files)
}

/// Reads what `identify --json` or `diagnose --json` has printed.
pub(super) fn stored_answer(path: &Path) -> Result<Answer, Failure> {
    let wrong = |reason: &dyn std::fmt::Display| {
        Failure::Input(format!(
            "{}: not a result that `identify --json` or `diagnose --json` prints: {reason}",
            path.display()
        ))
    };
    let bytes = std::fs::read(path).map_err(|error| Failure::unread(path, &error))?;
    let text = String::from_utf8(bytes).map_err(|error| wrong(&error))?;
    Answer::from_json(&text).map_err(|error| wrong(&error))
}

/// The result object alone.
pub(super) fn json(answer: &impl Serialize) -> Result<String, Failure> {
    let mut text = serde_json::to_string_pretty(answer).map_err(Failure::other)?;
    text.push('\n');
    Ok(text)
}

/// Shows progress on a terminal, keeps the history and stops on an interrupt.
pub(super) struct Watch {
    began: Instant,
    history: Mutex<Vec<ConvergenceRow>>,
    interrupted: Arc<AtomicBool>,
    bar: ProgressBar,
}

impl Watch {
    pub(super) fn new() -> Self {
        let style = ProgressStyle::with_template("[{bar:40}] {percent:>3} % {prefix}{msg}");
        // Draws on standard error, and only where that is a terminal.
        let bar = ProgressBar::new(STEPS);
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self {
            began: Instant::now(),
            history: Mutex::default(),
            interrupted: interrupt::flag(),
            bar,
        }
    }

    /// Takes the progress off the terminal.
    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// The history so far.
    fn rows(&self) -> Vec<ConvergenceRow> {
        self.history.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Observer for Watch {
    fn elapsed_s(&self) -> f64 {
        self.began.elapsed().as_secs_f64()
    }

    fn progress(&self, progress: Progress) {
        self.bar.set_position((progress.fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
        self.bar.set_prefix(shown(&progress));
    }

    fn row(&self, row: ConvergenceRow) {
        self.bar.set_message(format!(", best {:.6}", row.best));
        self.history.lock().unwrap_or_else(PoisonError::into_inner).push(row);
    }

    fn cancelled(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}

/// The stage, and the time left where it is known.
fn shown(progress: &Progress) -> String {
    let Some(seconds) = progress.remaining_s else { return progress.stage.clone() };
    // An estimate that may be wrong by a factor of two deserves no more digits.
    let left = match seconds {
        ..10.0 => "a few seconds".to_owned(),
        10.0..90.0 => format!("about {:.0} s", 10.0 * (0.1 * seconds).round()),
        _ => format!("about {:.0} min", seconds / 60.0),
    };
    format!("{}, {left} left", progress.stage)
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::Identification;

    use super::*;

    fn args() -> Args {
        Args {
            files: vec!["a.csv".into()],
            given: given::Args::default(),
            actuator_order: None,
            method: None,
            seed: None,
            noise_std: None,
            options: None,
            json: false,
            shown: shown::Args::default(),
        }
    }

    #[test]
    fn flags_override_the_options() {
        let options = Some(r#"{"seed": 5, "noise_std": 0.5, "refine": false}"#.to_owned());
        let submission =
            submission(&Args { options, seed: Some(7), ..args() }, "identify").unwrap();
        assert_eq!((submission.options.seed, submission.options.noise_std), (7, Some(0.5)));
        assert!(!submission.options.refine);
    }

    #[test]
    fn an_unknown_option_is_refused_by_its_path() {
        let options = Some(r#"{"colony": {"bees": 3}}"#.to_owned());
        let refused = submission(&Args { options, ..args() }, "identify").unwrap_err().to_string();
        assert!(refused.contains("colony.bees") && refused.contains("food_sources"), "{refused}");
    }

    #[test]
    fn the_line_of_progress_says_how_long_it_takes_once_that_is_known() {
        let line = |remaining_s: Option<f64>| {
            let stage = "refining the fit".to_owned();
            shown(&Progress { stage, done: 1, total: 2, fraction: 0.5, remaining_s })
        };
        assert_eq!(line(None), "refining the fit");
        assert_eq!(line(Some(3.2)), "refining the fit, a few seconds left");
        assert_eq!(line(Some(47.0)), "refining the fit, about 50 s left");
        assert_eq!(line(Some(131.0)), "refining the fit, about 2 min left");
    }

    #[test]
    fn the_json_form_is_the_result_object_alone() {
        let answer = servoscope_core::answers::sample::identification();
        let text = json(&answer).unwrap();
        assert_eq!(serde_json::from_str::<Identification>(&text).unwrap(), answer);
    }
}
