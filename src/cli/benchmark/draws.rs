//! Runs draws, and prints or writes what they come to.

use serde::Serialize;
use servoscope_bench::naming::{
    Case, Outcome, Summary, Unmade, case_text, misses_text, run_all, run_case, summary_text,
};

use crate::cli::{Failure, target, terminal};
use crate::report;

use super::Args;
use super::watch::Watch;

/// What is written with `--json`.
#[derive(Serialize)]
struct File<'a> {
    software_version: &'static str,
    command: String,
    summary: &'a Summary,
    draws: &'a [Outcome],
    unmade: &'a [Unmade],
}

/// All draws, and their summary.
pub(super) fn all(cases: &[Case], args: &Args) -> Result<(), Failure> {
    args.json.as_deref().map_or(Ok(()), target::file)?;
    let watch = Watch::new(cases.len());
    let done = |case: &Case, result: &Result<Outcome, Unmade>| watch.done(case, result);
    let results = run_all(cases, &args.settings(), &watch, &done).map_err(Failure::other)?;
    watch.bar.finish_and_clear();
    let begun = results.len();
    let (mut outcomes, mut unmade) = (Vec::new(), Vec::new());
    for result in results {
        match result {
            Ok(outcome) => outcomes.push(outcome),
            Err(reason) => unmade.push(reason),
        }
    }
    let summary = Summary::of(&outcomes);
    let command = args.command();
    let mut text = format!("{} draws of {}, seed {}\n\n", outcomes.len(), cases.len(), args.seed);
    text.push_str(&summary_text(&summary));
    text.push_str(&misses_text(&outcomes, &unmade, &command));
    terminal::print_raw(text.as_bytes())?;
    if let Some(path) = &args.json {
        let software_version = env!("CARGO_PKG_VERSION");
        let (draws, unmade) = (&outcomes, &unmade);
        let file = File { software_version, command, summary: &summary, draws, unmade };
        let json = serde_json::to_string_pretty(&file).map_err(Failure::other)?;
        let failed = |error| Failure::Other(format!("{}: {error}", path.display()));
        std::fs::write(path, json + "\n").map_err(failed)?;
    }
    if begun < cases.len() {
        return Err(Failure::Other(format!("interrupted after {begun} of {} draws", cases.len())));
    }
    Ok(())
}

/// One draw in full.
pub(super) fn one(case: &Case, args: &Args) -> Result<(), Failure> {
    args.json.as_deref().map_or(Ok(()), target::file)?;
    let watch = Watch::new(1);
    let run = run_case(case, &args.settings(), &watch);
    watch.bar.finish_and_clear();
    let run = run.map_err(|unmade| Failure::Other(format!("{}: {}", unmade.key, unmade.reason)))?;
    let mut text = case_text(&run.outcome);
    let right = if run.outcome.is_right() { "right" } else { "missed" };
    let seconds = run.outcome.seconds;
    text.push_str(&format!(
        "\n  {right}; {:.2} s to make, {:.2} s to diagnose\n\n",
        seconds.data, seconds.job
    ));
    if let Some(diagnosis) = &run.diagnosis {
        text.push_str(&report::diagnosis(diagnosis));
        if let Some(path) = &args.json {
            let json = serde_json::to_string_pretty(diagnosis).map_err(Failure::other)?;
            let failed = |error| Failure::Other(format!("{}: {error}", path.display()));
            std::fs::write(path, json + "\n").map_err(failed)?;
        }
    }
    terminal::print_raw(text.as_bytes())
}
