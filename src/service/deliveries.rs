//! Messages on their way to whoever is told what happens.

use std::time::Duration;

use jiff::Timestamp;
use tracing::{info, warn};

use crate::notify::{Secret, SendError, broker_delay, webhook_delay};
use crate::store::{DueRow, Settled};

use super::metrics::Told;
use super::{Service, ServiceError};

/// How long one attempt may take altogether. After that its sender was killed, and it is tried
/// again.
const LEASE: Duration = Duration::from_secs(60);

impl Service {
    /// Takes a message that is to be sent now.
    ///
    /// # Errors
    /// When the database does not answer.
    pub(crate) async fn due(&self) -> Result<Option<DueRow>, ServiceError> {
        Ok(self.store.due(LEASE, self.outlets.broker.is_some()).await?)
    }

    /// Sends a message that is due, and remembers what came of it.
    ///
    /// # Errors
    /// When the database does not answer: the message is then sent again.
    pub(crate) async fn deliver(&self, due: DueRow) -> Result<(), ServiceError> {
        let sent = match (&due.webhook_id, &self.outlets.broker) {
            (Some(_), _) => self.send(&due.url, &due.secret, &due.id, &due.body).await.map(Some),
            (None, Some(broker)) => broker.publish(&due.topic, &due.body).await.map(|()| None),
            (None, None) => Err(SendError::Broker("there is none any more".into())),
        };
        let settled = settled(&due, &sent);
        let error = sent.as_ref().err().map(ToString::to_string);
        let kept = self.store.settle(&due, &settled, answered(&sent), error.as_deref()).await?;
        let receiver = due.webhook_id.as_deref().unwrap_or("broker");
        let DueRow { id, attempt, .. } = &due;
        let error = error.unwrap_or_default();
        let outcome = match &settled {
            Settled::Delivered => {
                info!(receiver, message = id, attempt, "message delivered");
                "delivered"
            }
            Settled::Later(wait) => {
                let wait_s = wait.as_secs();
                warn!(receiver, message = id, attempt, error, wait_s, "message not delivered yet");
                "failed"
            }
            Settled::GivenUp => {
                warn!(receiver, message = id, attempt, error, "message given up");
                "given_up"
            }
            Settled::Disabled => {
                warn!(receiver, error, "webhook disabled");
                "disabled"
            }
        };
        if kept {
            let to = if due.webhook_id.is_some() { "webhook" } else { "mqtt" };
            self.metrics.told(Told { to, outcome });
        }
        Ok(())
    }

    pub(super) async fn send(
        &self,
        url: &str,
        secret: &str,
        id: &str,
        body: &str,
    ) -> Result<u16, SendError> {
        // What was stored was read before.
        let secret = Secret::parse(secret).ok_or(SendError::Connection("no secret".into()))?;
        let now = Timestamp::now().as_second();
        self.outlets.webhooks.send(url, &secret, id, now, body).await
    }
}

/// What becomes of a message after an attempt.
fn settled(due: &DueRow, sent: &Result<Option<u16>, SendError>) -> Settled {
    let wait = match (sent, &due.webhook_id) {
        (Ok(_), _) => return Settled::Delivered,
        (Err(SendError::Gone), _) => return Settled::Disabled,
        (Err(_), Some(_)) => webhook_delay(due.attempt, chance()),
        (Err(_), None) => {
            broker_delay(due.attempt, Duration::from_millis(due.age_ms.unsigned_abs()))
        }
    };
    wait.map_or(Settled::GivenUp, Settled::Later)
}

/// A number from 0 to 1.
fn chance() -> f64 {
    f64::from(getrandom::u32().unwrap_or_default()) / f64::from(u32::MAX)
}

/// Status of an answer, where there was one.
pub(super) fn answered(sent: &Result<Option<u16>, SendError>) -> Option<u16> {
    match sent {
        Ok(status) => *status,
        Err(SendError::Status(status) | SendError::Redirected(status)) => Some(*status),
        Err(SendError::Gone) => Some(410),
        Err(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due(webhook_id: Option<&str>, attempt: u32) -> DueRow {
        DueRow {
            id: "msg_1".into(),
            attempt,
            age_ms: 0,
            webhook_id: webhook_id.map(str::to_owned),
            url: String::new(),
            secret: String::new(),
            topic: String::new(),
            body: String::new(),
        }
    }

    #[test]
    fn a_message_that_was_not_taken_is_tried_later_and_given_up_in_the_end() {
        let failed = || Err(SendError::Status(500));
        let Settled::Later(wait) = settled(&due(Some("hook"), 2), &failed()) else { panic!() };
        assert!((300..=360).contains(&wait.as_secs()), "{wait:?}");
        assert_eq!(settled(&due(Some("hook"), 10), &failed()), Settled::GivenUp);
        assert_eq!(settled(&due(None, 10), &failed()), Settled::Later(Duration::from_secs(300)));
        let old = DueRow { age_ms: 3 * 24 * 3600 * 1000, ..due(None, 10) };
        assert_eq!(settled(&old, &failed()), Settled::GivenUp);
    }

    #[test]
    fn gone_disables_and_anything_taken_is_delivered() {
        let first = due(Some("hook"), 1);
        assert_eq!(settled(&first, &Err(SendError::Gone)), Settled::Disabled);
        assert_eq!(settled(&first, &Ok(Some(202))), Settled::Delivered);
        assert_eq!(answered(&Err(SendError::Gone)), Some(410));
        assert_eq!(answered(&Err(SendError::TimedOut)), None);
    }
}
