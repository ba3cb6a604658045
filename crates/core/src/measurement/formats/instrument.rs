//! An instrument that writes tables with names of its own.
//!
//! It turns the names of its columns into names that the vocabulary knows, and leaves those empty that
//! are not to be used.

use super::fault::Fault;
use super::header::Header;

/// Comments of a text that are `key: value` but no metadata.
pub(super) type Comments = [(String, String)];

/// An instrument that is known by the names of its columns.
pub(super) struct Instrument {
    /// For notes.
    pub(super) name: &'static str,
    /// Whether these are the names of its columns.
    pub(super) is: fn(&[String]) -> bool,
    /// The same columns in names of the vocabulary. Settings that the instrument implies are set in
    /// the header where the upload does not state them.
    pub(super) names: Rename,
}

/// Turns the names of an instrument's columns into names of the vocabulary.
type Rename = fn(&[String], &Comments, &mut Header) -> Result<Vec<String>, Fault>;

/// Names with those kept and renamed that `rename` knows.
pub(super) fn renamed(names: &[String], rename: impl Fn(&str) -> Option<String>) -> Vec<String> {
    names.iter().map(|name| rename(name).unwrap_or_default()).collect()
}
