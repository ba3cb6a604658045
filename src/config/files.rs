//! How many files the process may open.

use rustix::process::{Resource, getrlimit};

/// Files that are open beside the connections that are counted: the database and its journal, once
/// for each connection to it; connections to webhooks and brokers; the log; and the connections that
/// are let in beyond the limit.
const OTHERS: usize = 128;

/// The most connections that leave room for the [`OTHERS`] below the limit of open files
/// (`RLIMIT_NOFILE`); where the limit is small, half of it.
pub(super) fn connections() -> usize {
    let limit = getrlimit(Resource::Nofile).current;
    let limit = limit.and_then(|limit| usize::try_from(limit).ok()).unwrap_or(usize::MAX);
    limit.saturating_sub(OTHERS).max(limit / 2).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn connections_leave_room_below_the_limit_of_files() {
        let limit = getrlimit(Resource::Nofile).current.unwrap_or(u64::MAX);
        let connections = connections() as u64;
        assert!((1..limit).contains(&connections), "{connections} of {limit}");
    }
}
