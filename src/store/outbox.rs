//! What is still to be told to others, and to whom.
//!
//! The end of a job leaves an event in the transaction that ends it. Whoever turns it
//! into deliveries removes it in the transaction that stores them; a delivery is tried
//! under a lease until it is settled. So nothing is lost when a process is killed, and
//! what was under way then is sent again.

use std::time::Duration;

use async_trait::async_trait;

use super::decode::millis;
use super::{Millis, Reach, StoreError};

/// Somebody who is told what happens.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WebhookRow {
    /// UUID version 7.
    pub id: String,
    /// When it was stored; ignored on insertion.
    pub created_at_ms: Millis,
    /// Where messages go.
    pub url: String,
    /// What they are signed with.
    pub secret: String,
    /// JSON array of the types of event.
    pub events: String,
    /// Why it is told nothing more.
    pub disabled: Option<String>,
    /// Whose it is; the reach says on insertion.
    pub owner: String,
}

/// A job that ended, of which nobody has been told.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EventRow {
    /// Its number, in order.
    pub id: i64,
    /// The job.
    pub job_id: String,
    /// When it ended.
    pub at_ms: Millis,
}

/// A message to be sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewDeliveryRow {
    /// `msg_` and a UUID version 7.
    pub id: String,
    /// The receiver; `None`: the broker.
    pub webhook_id: Option<String>,
    /// Type of event.
    pub event: String,
    /// Topic below the prefix, for the broker.
    pub topic: String,
    /// JSON.
    pub body: String,
}

/// A message that is to be tried now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DueRow {
    /// Its id.
    pub id: String,
    /// Number of this attempt, from 1.
    pub attempt: u32,
    /// When it was stored, before now.
    pub age_ms: Millis,
    /// The receiver; `None`: the broker.
    pub webhook_id: Option<String>,
    /// Where it goes; empty for the broker.
    pub url: String,
    /// What it is signed with; empty for the broker.
    pub secret: String,
    /// Topic below the prefix, for the broker.
    pub topic: String,
    /// JSON.
    pub body: String,
}

/// What an attempt came to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Settled {
    /// The receiver took the message.
    Delivered,
    /// It is tried again after a while.
    Later(Duration),
    /// It is not tried again.
    GivenUp,
    /// The receiver wants no more: its webhook is disabled, and whatever waits for it is
    /// given up.
    Disabled,
}

impl Settled {
    /// The status it leaves, and the wait until the next attempt, ms.
    pub(super) fn columns(&self) -> (&'static str, Option<Millis>) {
        match self {
            Settled::Delivered => ("delivered", None),
            Settled::Later(wait) => ("waiting", Some(millis(*wait))),
            Settled::GivenUp | Settled::Disabled => ("given_up", None),
        }
    }
}

/// Where a delivery stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeliveryRow {
    /// Its id.
    pub id: String,
    /// Type of event.
    pub event: String,
    /// `waiting`, `delivered` or `given_up`.
    pub status: String,
    /// Attempts so far.
    pub attempts: u32,
    /// When it was stored.
    pub created_at_ms: Millis,
    /// When it is tried next, while it waits.
    pub due_ms: Millis,
    /// When it was settled.
    pub ended_at_ms: Option<Millis>,
    /// Status of the latest answer.
    pub answered: Option<u16>,
    /// Why the latest attempt failed.
    pub error: Option<String>,
}

/// The part of a store that remembers what is to be told.
#[async_trait]
pub trait Outbox {
    /// Stores a webhook, unless its owner has `most` of them already; `false`: there are.
    async fn insert_webhook(
        &self,
        reach: &Reach,
        row: &WebhookRow,
        most: u32,
    ) -> Result<bool, StoreError>;

    /// At most `limit` webhooks, newest first; `None`: every one.
    async fn webhooks(
        &self,
        reach: &Reach,
        limit: Option<u32>,
    ) -> Result<Vec<WebhookRow>, StoreError>;

    /// The webhook, if there is one with this id.
    async fn webhook(&self, reach: &Reach, id: &str) -> Result<Option<WebhookRow>, StoreError>;

    /// Removes a webhook and its deliveries. `false`: there is none.
    async fn delete_webhook(&self, reach: &Reach, id: &str) -> Result<bool, StoreError>;

    /// At most so many events, oldest first.
    async fn events(&self, limit: u32) -> Result<Vec<EventRow>, StoreError>;

    /// Stores what an event leads to, and removes it. `false`: somebody else did, and nothing
    /// was stored.
    async fn announce(&self, event: i64, rows: &[NewDeliveryRow]) -> Result<bool, StoreError>;

    /// Takes the delivery that is due for longest, of a receiver to whom nothing else is under
    /// way; with `broker` also those to the broker. Unless it is settled before, it is due
    /// again after `lease`.
    async fn due(&self, lease: Duration, broker: bool) -> Result<Option<DueRow>, StoreError>;

    /// Ends an attempt: with the status of the answer and why it failed, where it did. `false`:
    /// it was begun again since, or its webhook is gone; nothing was written.
    async fn settle(
        &self,
        due: &DueRow,
        settled: &Settled,
        answered: Option<u16>,
        error: Option<&str>,
    ) -> Result<bool, StoreError>;

    /// At most so many deliveries of a webhook, newest first.
    async fn deliveries(
        &self,
        reach: &Reach,
        webhook: &str,
        limit: u32,
    ) -> Result<Vec<DeliveryRow>, StoreError>;

    /// How many deliveries wait.
    async fn waiting(&self) -> Result<i64, StoreError>;

    /// Removes deliveries that were stored longer than `age` ago; at most `limit`. Returns how
    /// many there were.
    async fn delete_deliveries(&self, age: Duration, limit: u32) -> Result<u64, StoreError>;
}
