//! What processes say to each other: notifications, once the transaction that gives reason for them
//! is committed.
//!
//! Not in that transaction: one that notifies holds a lock of the whole cluster until it is on the
//! disk, so that no two of them are written together. A process that is killed in between leaves
//! something unsaid, which the others find when they look.

use sqlx::PgPool;
use sqlx::postgres::{PgConnectOptions, PgListener, PgPoolOptions};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use crate::store::{StoreError, Wake};

/// Where they are sent.
const CHANNEL: &str = "servoscope";

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
        let pool = PgPoolOptions::new().max_connections(1).connect_lazy_with(options);
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
        // Where the database is away, the others do not hear it either way.
        let _ = sqlx::query("SELECT pg_notify($1, word) FROM unnest($2::text[]) AS word")
            .bind(CHANNEL)
            .bind(words)
            .execute(&pool)
            .await;
    }
}

pub(super) async fn listen(
    pool: &PgPool,
    heard: &(dyn Fn(Wake) + Send + Sync),
) -> Result<(), StoreError> {
    let mut listener = PgListener::connect_with(pool).await?;
    listener.listen(CHANNEL).await?;
    loop {
        // Whatever was said before it listened, or while the connection was lost, was missed.
        Wake::ALL.into_iter().for_each(heard);
        while let Some(notification) = listener.try_recv().await? {
            if let Some(wake) = named(notification.payload()) {
                heard(wake);
            }
        }
    }
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
