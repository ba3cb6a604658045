//! What processes say to each other: notifications, once the transaction that gives reason for them
//! is committed.
//!
//! Not in that transaction: one that notifies holds a lock of the whole cluster until it is on the
//! disk, so that no two of them are written together. A process that is killed in between leaves
//! something unsaid, which the others find when they look.

use std::time::Duration;

use sqlx::PgPool;
use sqlx::postgres::{PgConnectOptions, PgListener};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};
use tokio::time::timeout;

use crate::store::{StoreError, Wake};

use super::connections::{self, PATIENCE};

/// Where they are sent.
const CHANNEL: &str = "servoscope";

/// Sent by whoever has heard nothing for long, to hear itself; older versions pass over it.
const ANYBODY: &str = "anybody";

/// After how long without a word a listener says one itself, and then takes its connection for lost.
const QUIET: Duration = Duration::from_secs(15);

/// Most that is said together; of what is the same only one is sent.
const TOGETHER: usize = 1000;

/// Says what this process has done.
#[derive(Debug)]
pub(super) struct Speaker(UnboundedSender<Wake>);

impl Speaker {
    /// One with a connection of its own, which is made when there is something to say.
    pub(super) fn new(options: PgConnectOptions) -> Self {
        // What is said need not outlive a crash of the database: nobody waits for the disk.
        let options = options.options([("synchronous_commit", "off")]);
        let pool = connections::pool(1).connect_lazy_with(options);
        let (sender, said) = unbounded_channel();
        tokio::spawn(speak(pool, said));
        Self(sender)
    }

    /// Says something, as soon as what was said before is sent.
    pub(super) fn say(&self, wakes: &[Wake]) {
        for wake in wakes {
            // It fails while the process ends.
            let _ = self.0.send(*wake);
        }
    }
}

/// Sends what is said until nobody is left to say anything.
async fn speak(pool: PgPool, mut said: UnboundedReceiver<Wake>) {
    let mut wakes = Vec::with_capacity(TOGETHER);
    while said.recv_many(&mut wakes, TOGETHER).await > 0 {
        let mut words: Vec<&str> = Vec::new();
        for wake in wakes.drain(..) {
            if !words.contains(&word(wake)) {
                words.push(word(wake));
            }
        }
        let sent = sqlx::query("SELECT pg_notify($1, word) FROM unnest($2::text[]) AS word")
            .bind(CHANNEL)
            .bind(words)
            .execute(&pool);
        // Where the database is away, the others do not hear it either way.
        let _ = timeout(PATIENCE, sent).await;
    }
}

pub(super) async fn listen(
    pool: &PgPool,
    heard: &(dyn Fn(Wake) + Send + Sync),
) -> Result<(), StoreError> {
    // Of its own: where nothing is heard any more, nothing else waits for its end.
    let own = connections::pool(1).connect_lazy_with(pool.connect_options().as_ref().clone());
    let mut listener = PgListener::connect_with(&own).await?;
    listener.listen(CHANNEL).await?;
    loop {
        // Whatever was said before it listened, or while the connection was lost, was missed.
        Wake::ALL.into_iter().for_each(heard);
        while let Some(sent) = next(&mut listener, pool).await? {
            if let Some(wake) = named(&sent) {
                heard(wake);
            }
        }
    }
}

/// What is said next; `None`: the connection was lost, and is there again.
async fn next(listener: &mut PgListener, pool: &PgPool) -> Result<Option<String>, StoreError> {
    let sent = match timeout(QUIET, listener.try_recv()).await {
        Ok(sent) => sent?,
        Err(_) => {
            let said = sqlx::query("SELECT pg_notify($1, $2)").bind(CHANNEL).bind(ANYBODY);
            let hears = async {
                said.execute(pool).await?;
                listener.try_recv().await
            };
            timeout(QUIET, hears).await.map_err(|_| StoreError::Silent)??
        }
    };
    Ok(sent.map(|sent| sent.payload().to_owned()))
}

/// How it is sent.
fn word(wake: Wake) -> &'static str {
    match wake {
        Wake::Queued => "queued",
        Wake::Changed => "changed",
        Wake::Unwanted => "unwanted",
        Wake::Ended => "ended",
    }
}

/// By the word that is sent; another version may have others.
fn named(sent: &str) -> Option<Wake> {
    Wake::ALL.into_iter().find(|wake| word(*wake) == sent)
}
