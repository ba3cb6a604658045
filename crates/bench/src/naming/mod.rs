//! Benchmark of naming: hides effects in random machines, asks for a diagnosis through the public
//! interface, and scores the causes that it names.
//!
//! - `case`: one draw of the benchmark, and the key that reproduces it. `plan`: the draws of a run.
//! - `effect_draws`: effects drawn at random. `outsiders`: effects that the library does not contain.
//! - `instrument`: how the machine of a draw is measured.
//! - `sizing`, `excess`: scale a hidden effect until the base model's excess χ² has the required
//!   value.
//! - `mixture`, `mixed_case`: the dominant and small effects of a machine. `dominance`: how much of the excess the
//!   dominant ones make and leave.
//! - `mismeasurement`: the fault of a measurement. `mismeasured`: whether an answer names it.
//! - `recording`: records of a machine, in place of a table.
//! - `rivals`: how well a single other effect of the library imitates the hidden one.
//! - `build_case`: makes the machine, its hidden effects and its measurement.
//! - `fresh`: checks the reported gain against a fresh measurement.
//! - `separation`: whether the proposed next experiment resolves a doubt better than a random one.
//! - `judge`: compares one answer with the truth. `score`: what counts as right. `rate`, `summary`,
//!   `text`: statistics of all answers.
//! - `run`: runs many draws in parallel.
//! - `search_setting`, `ablation`: the settings of the search by name, and what halving and
//!   doubling each of them does.

mod ablation;
mod build_case;
mod case;
mod dominance;
pub mod effect_draws;
mod excess;
#[cfg(test)]
mod fixtures;
mod fresh;
mod instrument;
mod judge;
mod mismeasured;
mod mismeasurement;
mod mixed_case;
mod mixture;
pub mod outsiders;
mod plan;
mod rate;
mod recording;
mod rivals;
mod run;
mod score;
mod search_setting;
mod separation;
mod sizing;
mod summary;
mod text;

pub use ablation::{Ablation, Trial, Trials, ablate};
pub use build_case::{Hidden, Made, MakeError, build_case};
pub use case::{Case, Kind, known_effect};
pub use dominance::Dominance;
pub use excess::{DETECTABLE, base_excess};
pub use fresh::Fresh;
pub use instrument::{Harmonics, Instrument, NoiseSaid};
pub use judge::{Answer, Estimated, Named, Outcome, Seconds};
pub use mismeasured::{Mismeasured, RowCounts};
pub use mismeasurement::{BadRow, Mismeasurement, Mistake, Sort, Spoilt, drawn_fault};
pub use plan::Plan;
pub use rate::Rate;
pub use recording::Recording;
pub use rivals::{Nearest, Rivals};
pub use run::{Run, Settings, Unmade, run_all, run_case};
pub use search_setting::{SettingChange, search_settings};
pub use separation::Separation;
pub use sizing::Sizing;
pub use summary::{
    ConfidenceBin, Confusion, EffectRates, FaultLine, FaultRates, Faults, Line, NONE, Summary,
    Times, Wanted,
};
pub use text::{case_text, misses_text, summary_text};
