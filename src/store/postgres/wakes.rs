//! What processes say to each other: notifications, which triggers send with the transaction that
//! gives reason for them.

use sqlx::PgPool;
use sqlx::postgres::PgListener;

use crate::store::{StoreError, Wake};

/// Where the triggers send them.
const CHANNEL: &str = "servoscope";

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

/// By the word that the triggers send; another version may have others.
fn named(word: &str) -> Option<Wake> {
    match word {
        "queued" => Some(Wake::Queued),
        "changed" => Some(Wake::Changed),
        "unwanted" => Some(Wake::Unwanted),
        "ended" => Some(Wake::Ended),
        _ => None,
    }
}
