//! What one file of an upload is, and what it holds.

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

/// What one file holds.
pub(super) struct Part {
    pub header: Header,
    pub experiments: Vec<Remarked<Experiment>>,
    pub transients: Vec<Remarked<Transient>>,
    pub notes: Vec<String>,
    /// Whether the order of acquisition was seen from the clock of this file.
    pub runs_from_clock: bool,
}

/// An experiment or a motion, and the remarks of its reader.
pub(super) struct Remarked<T> {
    pub content: T,
    pub remarks: Vec<String>,
}
