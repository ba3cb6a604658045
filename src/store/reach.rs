//! Whose rows a caller sees.

/// Whose rows a caller reads and changes, and whose those are that it makes.
///
/// Every method of the store that touches a row with an owner takes one: what is out
/// of reach is not there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reach {
    /// Owner of what the caller makes: the id of its key; empty: it has none.
    pub owner: String,
    /// Whether it reads rows of every owner, or its own alone.
    pub reads_all: bool,
    /// Whether it changes rows of every owner, or its own alone.
    pub changes_all: bool,
}

impl Reach {
    /// All rows: the reach of the server's own work, and of a server without keys.
    pub fn everything() -> Self {
        Self { owner: String::new(), reads_all: true, changes_all: true }
    }

    /// No row at all. No key has such an id.
    pub fn nothing() -> Self {
        Self { owner: "nobody".into(), reads_all: false, changes_all: false }
    }

    /// The same, reading no more than is changed.
    #[must_use]
    pub fn for_changes(&self) -> Self {
        Self { reads_all: self.changes_all, ..self.clone() }
    }

    /// The only owner whose rows are read; `None`: every one.
    pub(super) fn read(&self) -> Option<&str> {
        (!self.reads_all).then_some(&self.owner)
    }

    /// The only owner whose rows are changed; `None`: every one.
    pub(super) fn changed(&self) -> Option<&str> {
        (!self.changes_all).then_some(&self.owner)
    }
}
