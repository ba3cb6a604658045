//! Which run of the machine, from one start to the next, a worker belongs to.
//!
//! A database file has one machine. So a worker of another run of it did not die by itself: the
//! machine was switched off or restarted under it.

use std::sync::LazyLock;

/// What Linux calls this run; other systems say nothing.
static RUN: LazyLock<String> = LazyLock::new(|| {
    let text = std::fs::read_to_string("/proc/sys/kernel/random/boot_id");
    text.unwrap_or_default().trim().to_owned()
});

/// What stands before the names of workers of this run.
pub(super) fn prefix() -> String {
    format!("{}/", *RUN)
}

/// A worker of this run, as it is stored.
pub(super) fn worker(name: &str) -> String {
    format!("{}{name}", prefix())
}
