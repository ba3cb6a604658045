//! The engine on a Postgres database, which servers and workers on any number of machines share.
//!
//! Writes run side by side. Each waits for the rows that it changes and decides on what it then
//! finds; what no row stands for has a lock of its own in `locks`. A process that is cut off or
//! stopped in the midst of a transaction must not hold up the others: the database ends such a
//! transaction after [`IDLE`]. Nor does a database that says nothing hold up a process: `limited` gives
//! up a call that it does not answer.

mod batches;
mod connections;
mod history;
mod idempotency;
mod jobs;
mod keys;
mod limited;
mod locks;
mod mappings;
mod measurements;
pub(super) mod migrations;
mod outbox;
mod pace;
mod portable;
mod queue;
mod recovery;
mod results;
mod retention;
mod store;
#[cfg(test)]
mod upgrade;
mod wakes;

use std::time::Duration;

use sqlx::PgPool;
use sqlx::postgres::PgConnectOptions;

use super::StoreError;
use pace::{Lowest, Pace};
use wakes::Speaker;

/// Connections of one process, beside the two that tell others what it did and hear what they did.
const CONNECTIONS: u32 = 9;

/// After how long the database ends a transaction of a process that says nothing, and a wait for
/// another transaction.
const IDLE: &str = "30s";

/// Store on one Postgres database, which any number of processes share. A call that the database does not
/// answer for long ends with [`StoreError::Silent`].
#[derive(Debug)]
pub struct Postgres {
    engine: Engine,
    /// How long a call may take.
    limit: Duration,
}

impl Postgres {
    /// Connects to the database of an address as in `postgres://user:password@host/database` and
    /// brings its tables to the form this version needs.
    ///
    /// # Errors
    /// When the address cannot be used, or the database not be reached or migrated.
    pub async fn open(address: &str) -> Result<Self, StoreError> {
        let engine = Engine::connect(address).await?;
        migrations::run(&engine.pool).await?;
        Ok(Self { engine, limit: limited::LIMIT })
    }

    /// Connects to a database as it is.
    ///
    /// # Errors
    /// When the address cannot be used, the database not be reached, or it is not of this version.
    pub async fn open_existing(address: &str) -> Result<Self, StoreError> {
        let engine = Engine::connect(address).await?;
        migrations::check(&engine.pool).await?;
        Ok(Self { engine, limit: limited::LIMIT })
    }
}

/// The same without a limit to a call.
#[derive(Debug)]
struct Engine {
    pool: PgPool,
    speaker: Speaker,
    /// Looks at the whole queue.
    whole: Pace,
    /// Looks for expired leases where there were none.
    recovery: Pace,
    /// Where events are looked for.
    events: Lowest,
}

impl Engine {
    async fn connect(address: &str) -> Result<Self, StoreError> {
        let options: PgConnectOptions = address.parse()?;
        let options = options.application_name("servoscope").options([
            ("idle_in_transaction_session_timeout", IDLE),
            ("lock_timeout", IDLE),
            // That a table is there already is no news for a log.
            ("client_min_messages", "warning"),
        ]);
        let pool = connections::pool(CONNECTIONS).connect_with(options.clone()).await?;
        Ok(Self {
            pool,
            speaker: Speaker::new(options),
            whole: Pace::default(),
            recovery: Pace::default(),
            events: Lowest::default(),
        })
    }
}
