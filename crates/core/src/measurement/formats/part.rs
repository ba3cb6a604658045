//! One file of an upload, and its parsed content.

use crate::measurement::{Experiment, Transient};

use super::header::Header;

/// One uploaded file.
#[derive(Debug, Clone, Copy)]
pub struct Source<'a> {
    /// Name to use in messages.
    pub name: &'a str,
    /// Content.
    pub bytes: &'a [u8],
}

/// Parsed content of one file.
pub(super) struct Part {
    pub header: Header,
    pub experiments: Vec<Remarked<Experiment>>,
    pub transients: Vec<Remarked<Transient>>,
    pub notes: Vec<String>,
    /// Whether the order of acquisition was inferred from the time stamps of this file.
    pub runs_from_clock: bool,
}

/// An experiment or a motion, with the remarks of the file reader.
pub(super) struct Remarked<T> {
    pub content: T,
    pub remarks: Vec<String>,
}
