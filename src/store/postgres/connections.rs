//! Connections that are given up when the other end falls silent.
//!
//! A link that is cut without a word looks like a database that takes its time, until the system gives
//! up on it after a quarter of an hour. Whoever asked has lost patience by then; the connection must not
//! take a place of the pool for so long.

use std::time::Duration;

use sqlx::postgres::PgPoolOptions;
use sqlx::{Connection as _, PgConnection};

/// How long a request waits for a connection, as while the database restarts.
pub(super) const PATIENCE: Duration = Duration::from_secs(10);

/// How long a connection may take to say that it is there.
const SILENCE: Duration = Duration::from_secs(1);

/// A connection that was used so shortly before is not asked whether it is still there.
const RECENT: Duration = Duration::from_millis(50);

/// A pool of so many.
pub(super) fn pool(size: u32) -> PgPoolOptions {
    PgPoolOptions::new()
        .max_connections(size)
        .acquire_timeout(PATIENCE)
        // Asked below, and not without end.
        .test_before_acquire(false)
        .before_acquire(|connection, used| {
            Box::pin(async move { Ok(used.idle_for < RECENT || answers(connection).await) })
        })
        .after_release(|connection, _| Box::pin(async move { Ok(answers(connection).await) }))
}

async fn answers(connection: &mut PgConnection) -> bool {
    matches!(tokio::time::timeout(SILENCE, connection.ping()).await, Ok(Ok(())))
}
