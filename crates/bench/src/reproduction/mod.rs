//! Reproduction of the paper's experiments, compared with the published results.
//!
//! - `system`: G1 and G2, how they are measured here, and the rows of Tables II and III;
//! - `published`: the published values, misprints included;
//! - `runs`: every method on every system, noise level and seed;
//! - `figure_of_merit`: medians, worst cases, success;
//! - `as_written`: the paper's own equations, implemented as literally as possible;
//! - `chart`, `markdown`, `tables`, `document`, `record`: output as figures, Markdown and CSV; the
//!   figures are drawn by `servoscope reproduce`.
//!
//! The data comes from [`crate::machines::simulator`], which shares no code with the methods that
//! fit it. The methods are called through the public interface.

mod as_written;
mod chart;
mod document;
pub mod figure_of_merit;
mod markdown;
pub mod published;
mod record;
mod runs;
pub mod system;
mod tables;

pub use as_written::{
    AsWritten, Colony, Network, Objective, Rule, SelfOscillation, Topology, as_written,
};
pub use chart::Chart;
pub use document::{Circumstances, as_written_text, document};
pub use figure_of_merit::{largest_error, median, percentile_90};
pub use record::{Recorded, read, record};
pub use runs::{Outcome, Plan, ReproduceError, Reproduction, Run, run_all};
pub use system::System;
pub use tables::as_close_as_published;
