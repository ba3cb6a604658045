//! Writes and reads the runs as CSV, so that later runs can be compared with them.

use super::figure_of_merit::ANSWER;
use super::runs::{Reproduction, Run};

/// The recorded part of a run.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Recorded {
    /// `G1` or `G2`.
    pub system: String,
    /// Noise level, dB; empty: no noise.
    pub noise_db: Option<u32>,
    /// Name of the method.
    pub method: String,
    /// Seed of method and noise.
    pub seed: u64,
    /// Largest relative error of the table's rows after the search; empty: no answer.
    pub search_error: Option<f64>,
    /// Largest relative error of the table's rows in the final answer; empty: no answer.
    pub error: Option<f64>,
    /// Evaluations up to the end of the search.
    pub search_evaluations: Option<u64>,
    /// Evaluations in all.
    pub evaluations: Option<u64>,
    /// Computing time, s.
    pub seconds: Option<f64>,
    /// Whether the answer meets the success criterion (see `Outcome::success`).
    pub success: bool,
    /// Why the search ended.
    pub stop_reason: String,
}

impl From<&Run> for Recorded {
    fn from(run: &Run) -> Self {
        let answer = ANSWER(run);
        let alone = run.alone.as_ref();
        Self {
            system: run.system.name().to_owned(),
            noise_db: run.level,
            method: run.method.name().to_owned(),
            seed: run.seed,
            search_error: alone.map(|outcome| outcome.error),
            error: answer.map(|outcome| outcome.error),
            search_evaluations: alone.map(|outcome| outcome.evaluations),
            evaluations: answer.map(|outcome| outcome.evaluations),
            seconds: answer.map(|outcome| outcome.seconds),
            success: answer.is_some_and(|outcome| outcome.success),
            stop_reason: run.stop_reason.clone(),
        }
    }
}

/// All runs as CSV, one per line.
///
/// # Errors
/// If a row cannot be written.
pub fn record(reproduction: &Reproduction) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for run in &reproduction.runs {
        writer.serialize(Recorded::from(run))?;
    }
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Reads the CSV that [`record`] writes.
///
/// # Errors
/// If the text is not such a table.
pub fn read(text: &str) -> Result<Vec<Recorded>, csv::Error> {
    csv::Reader::from_reader(text.as_bytes()).deserialize().collect()
}
