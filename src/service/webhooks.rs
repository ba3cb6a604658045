//! Whom to tell what happens, and what came of telling.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::notify::{Broker, Secret, SendError, Webhooks};
use crate::store::{DeliveryRow, Millis, WebhookRow};

use super::deliveries::answered;
use super::{Service, ServiceError, fitting, notices};

/// Most webhooks of a key.
const MOST_WEBHOOKS: u32 = 100;

/// Most webhooks that are listed.
const MOST_LISTED: u32 = 1000;

/// Most deliveries of a webhook that are listed.
const MOST_DELIVERIES: u32 = 200;

/// What others are told of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum EventType {
    /// A job ended.
    #[serde(rename = "job.finished")]
    JobFinished,
    /// A parameter of an axis differs from the measurement before.
    #[serde(rename = "axis.changed")]
    AxisChanged,
}

impl EventType {
    /// Every type.
    pub const ALL: [Self; 2] = [Self::JobFinished, Self::AxisChanged];

    /// Its name on the wire.
    pub fn name(self) -> &'static str {
        match self {
            Self::JobFinished => "job.finished",
            Self::AxisChanged => "axis.changed",
        }
    }
}

/// How others are told.
#[derive(Default)]
pub struct Outlets {
    /// Sends webhooks.
    pub webhooks: Webhooks,
    /// Where the same is published.
    pub broker: Option<Broker>,
}

/// Somebody who is told what happens.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Webhook {
    /// Its id.
    pub id: String,
    /// When it was stored.
    pub created_at_ms: Millis,
    /// Where messages go.
    pub url: String,
    /// What it is told of.
    pub events: Vec<EventType>,
    /// Why it is told nothing more.
    pub disabled: Option<String>,
}

/// A webhook to be stored.
#[derive(Debug, Clone, Default)]
pub struct NewWebhook {
    /// Where messages go.
    pub url: String,
    /// What it is told of; `None`: everything.
    pub events: Option<Vec<EventType>>,
    /// What messages are signed with; `None`: a new secret.
    pub secret: Option<String>,
}

/// What came of a test.
#[derive(Debug, Clone, PartialEq)]
pub struct Tested {
    /// Status of the answer.
    pub answered: Option<u16>,
    /// Why the message was not taken.
    pub error: Option<String>,
    /// How long it took, seconds.
    pub seconds: f64,
}

impl Service {
    /// Stores a webhook, and gives the secret, which is not shown again.
    ///
    /// # Errors
    /// [`ServiceError::Request`] for what cannot be used.
    pub async fn add_webhook(&self, new: NewWebhook) -> Result<(Webhook, Secret), ServiceError> {
        let wrong = |member: &str, reason: String| {
            Err(ServiceError::Request { member: member.into(), reason })
        };
        let secret = match new.secret.as_deref() {
            Some(text) => match Secret::parse(text) {
                Some(secret) => secret,
                None => {
                    return wrong(
                        "secret",
                        "it is not `whsec_` and 24 to 64 bytes in base64; leave it out and one \
                         is made"
                            .into(),
                    );
                }
            },
            None => match Secret::generate() {
                Some(secret) => secret,
                None => {
                    return wrong("secret", "the system has no random numbers; give one".into());
                }
            },
        };
        let events = new.events.unwrap_or(EventType::ALL.to_vec());
        if events.is_empty() {
            return wrong("events", "name at least one, or leave it out for all".into());
        }
        match self.outlets.webhooks.check(&new.url).await {
            // A name that cannot be resolved now may be later.
            Ok(()) | Err(SendError::Unresolved { .. } | SendError::TimedOut) => {}
            Err(error) => return wrong("url", error.to_string()),
        }
        let row = WebhookRow {
            id: uuid::Uuid::now_v7().to_string(),
            created_at_ms: 0,
            url: new.url,
            secret: secret.text(),
            events: serde_json::json!(events).to_string(),
            disabled: None,
            owner: self.reach.owner.clone(),
        };
        if !self.store.insert_webhook(&self.reach, &row, MOST_WEBHOOKS).await? {
            let reason = format!("there are {MOST_WEBHOOKS} webhooks already; delete one");
            return wrong("url", reason);
        }
        Ok((self.webhook(&row.id).await?, secret))
    }

    /// Webhooks, newest first, at most 1000, and no more than there is room for on a page.
    ///
    /// # Errors
    /// When the database does not answer.
    pub async fn webhooks(&self) -> Result<Vec<Webhook>, ServiceError> {
        let mut rows = self.store.webhooks(&self.reach, Some(MOST_LISTED)).await?;
        let said = |row: &WebhookRow| row.disabled.as_ref().map_or(0, String::len);
        rows.truncate(fitting(&rows, |row| row.url.len() + row.events.len() + said(row)));
        rows.into_iter().map(webhook).collect()
    }

    /// One webhook.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn webhook(&self, id: &str) -> Result<Webhook, ServiceError> {
        webhook(self.webhook_row(id).await?)
    }

    /// Removes a webhook and what waits for it.
    ///
    /// # Errors
    /// As [`Service::webhook`].
    pub async fn delete_webhook(&self, id: &str) -> Result<(), ServiceError> {
        match self.store.delete_webhook(&self.reach, id).await? {
            true => Ok(()),
            false => Err(unknown(id)),
        }
    }

    /// The latest deliveries of a webhook, newest first; at most 200.
    ///
    /// # Errors
    /// As [`Service::webhook`].
    pub async fn deliveries(&self, webhook: &str) -> Result<Vec<DeliveryRow>, ServiceError> {
        self.webhook_row(webhook).await?;
        Ok(self.store.deliveries(&self.reach, webhook, MOST_DELIVERIES).await?)
    }

    /// Sends a webhook a message now, and says what came back. It is not repeated.
    ///
    /// # Errors
    /// As [`Service::webhook`].
    pub async fn test_webhook(&self, id: &str) -> Result<Tested, ServiceError> {
        let row = self.store.webhook(&self.reach.for_changes(), id).await?;
        let row = row.ok_or_else(|| unknown(id))?;
        let began = Instant::now();
        let message = notices::new_id();
        let body = notices::test_body(&row.id);
        let sent = self.send(&row.url, &row.secret, &message, &body).await.map(Some);
        Ok(Tested {
            answered: answered(&sent),
            error: sent.err().map(|error| error.to_string()),
            seconds: began.elapsed().as_secs_f64(),
        })
    }

    async fn webhook_row(&self, id: &str) -> Result<WebhookRow, ServiceError> {
        self.store.webhook(&self.reach, id).await?.ok_or_else(|| unknown(id))
    }
}

pub(super) fn webhook(row: WebhookRow) -> Result<Webhook, ServiceError> {
    let corrupt = |source| ServiceError::Corrupt { what: "webhook", source };
    let events = serde_json::from_str(&row.events).map_err(corrupt)?;
    let WebhookRow { id, created_at_ms, url, disabled, .. } = row;
    Ok(Webhook { id, created_at_ms, url, events, disabled })
}

fn unknown(id: &str) -> ServiceError {
    ServiceError::Unknown { what: "webhook", id: id.into() }
}
