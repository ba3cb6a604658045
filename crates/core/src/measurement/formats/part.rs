//! The parsed content of one file.

use crate::measurement::{Experiment, Lines, Transient};

use super::header::Header;

/// Parsed content of one file.
pub(super) struct Part {
    pub header: Header,
    pub experiments: Vec<Remarked<Experiment>>,
    pub transients: Vec<Remarked<Transient>>,
    pub notes: Vec<String>,
    /// Where its experiments are in the file, if it is a table.
    pub lines: Lines,
    /// Whether the order of acquisition was inferred from the time stamps of this file.
    pub runs_from_clock: bool,
}

/// An experiment or a motion, with the remarks of the file reader.
pub(super) struct Remarked<T> {
    pub content: T,
    pub remarks: Vec<String>,
}
