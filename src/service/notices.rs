//! What others are told: that a job ended, that an axis changed.

use jiff::Timestamp;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde::Serialize;
use servoscope_core::answers::{Answer, HistoryRow, Verdict};
use tracing::warn;

use crate::report;
use crate::store::{EventRow, Millis, NewDeliveryRow, Status, WebhookRow};

use super::webhooks::{EventType, webhook};
use super::{Caller, Job, Measured, Service, ServiceError};

/// Events that are read at once.
const BATCH: u32 = 100;

/// What a name may hold beside letters and digits as a part of a topic or an address.
const PLAIN: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.').remove(b'~');

/// A message as it is sent.
#[derive(Debug, Serialize)]
struct Message<'a, T> {
    #[serde(rename = "type")]
    event: &'a str,
    /// When it happened, RFC 3339.
    timestamp: String,
    data: T,
}

/// The measurement that a message is about.
#[derive(Debug, Clone, Serialize)]
struct About {
    id: String,
    name: Option<String>,
    machine: Option<String>,
    axis: Option<String>,
    measured_at: Option<String>,
}

#[derive(Debug, Serialize)]
struct JobFinished {
    job_id: String,
    kind: &'static str,
    status: &'static str,
    /// The verdict in one sentence; of a job that failed, why.
    headline: Option<String>,
    verdict: Option<Verdict>,
    causes: Vec<String>,
    measurement: About,
    links: Links,
}

#[derive(Debug, Serialize)]
struct AxisChanged {
    machine: String,
    axis: String,
    job_id: String,
    changes: Vec<Change>,
    measurement: About,
    links: Links,
}

/// A parameter that differs from the measurement before.
#[derive(Debug, Serialize)]
struct Change {
    parameter: String,
    name: String,
    value: f64,
    low95: Option<f64>,
    high95: Option<f64>,
    unit: String,
    change: Option<f64>,
}

/// Paths of this server.
#[derive(Debug, Serialize)]
struct Links {
    job: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    result: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    report: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    history: Option<String>,
}

/// An event with its topic for the broker and its JSON.
struct Notice {
    event: EventType,
    topic: String,
    body: String,
}

impl Service {
    /// Turns every end of a job into messages to whoever wants to know.
    ///
    /// # Errors
    /// When the database does not answer.
    pub(crate) async fn announce(&self) -> Result<(), ServiceError> {
        loop {
            let events = self.store.events(BATCH).await?;
            if events.is_empty() {
                return Ok(());
            }
            for event in events {
                let rows = match self.messages(&event).await {
                    Ok(rows) => rows,
                    Err(error @ ServiceError::Store(_)) => return Err(error),
                    // It would fail again, and hold up all others.
                    Err(error) => {
                        warn!(job = event.job_id, %error, "nobody is told that a job ended");
                        Vec::new()
                    }
                };
                self.store.announce(event.id, &rows).await?;
            }
        }
    }

    async fn messages(&self, event: &EventRow) -> Result<Vec<NewDeliveryRow>, ServiceError> {
        let mut receivers: Vec<(Option<String>, Vec<EventType>, Caller)> = Vec::new();
        for row in self.store.webhooks(&self.reach, None).await? {
            let owner = self.owner_of(&row).await?;
            let webhook = webhook(row)?;
            if webhook.disabled.is_none() {
                receivers.push((Some(webhook.id), webhook.events, owner));
            }
        }
        if self.outlets.broker.is_some() {
            receivers.push((None, EventType::ALL.to_vec(), Caller::Everybody));
        }
        let mut rows = Vec::new();
        // What each caller sees of it.
        let mut seen: Vec<(Caller, Vec<Notice>)> = Vec::new();
        for (webhook_id, wanted, caller) in receivers {
            if !seen.iter().any(|(other, _)| *other == caller) {
                let notices = match self.on_behalf_of(caller.clone()).notices(event).await {
                    Err(ServiceError::Unknown { .. }) => Vec::new(),
                    notices => notices?,
                };
                seen.push((caller.clone(), notices));
            }
            let notices = seen.iter().filter(|(other, _)| *other == caller);
            for notice in notices.flat_map(|(_, notices)| notices) {
                if wanted.contains(&notice.event) {
                    rows.push(NewDeliveryRow {
                        id: new_id(),
                        webhook_id: webhook_id.clone(),
                        event: notice.event.name().to_owned(),
                        topic: notice.topic.clone(),
                        body: notice.body.clone(),
                    });
                }
            }
        }
        Ok(rows)
    }

    /// On whose behalf a webhook is told something: that of its key, as long as that opens anything.
    async fn owner_of(&self, row: &WebhookRow) -> Result<Caller, ServiceError> {
        if row.owner.is_empty() {
            return Ok(Caller::Everybody);
        }
        Ok(match self.store.key(&row.owner).await? {
            Some(key) if key.is_valid() => Caller::Holder(Box::new(key.try_into()?)),
            _ => Caller::Nobody,
        })
    }

    async fn notices(&self, event: &EventRow) -> Result<Vec<Notice>, ServiceError> {
        let job = self.job(&event.job_id).await?;
        let measured = self.measurement(&job.row.measurement_id).await?;
        let answer = match job.row.status {
            Status::Succeeded => Some(self.answer(&event.job_id).await?),
            _ => None,
        };
        let mut notices = vec![finished(event, &job, &measured, answer.as_ref())];
        if let (Some(_), Some(machine), Some(axis)) =
            (answer, &measured.row.machine, &measured.row.axis)
        {
            let rows = self.axis_changes(&measured.row, &event.job_id).await?;
            notices.extend(changed(event, &measured, machine, axis, rows));
        }
        Ok(notices)
    }
}

fn finished(event: &EventRow, job: &Job, measured: &Measured, answer: Option<&Answer>) -> Notice {
    let id = &event.job_id;
    let path = |end: &str| answer.map(|_| format!("/v1/jobs/{id}/{end}"));
    let failure = job.failure.as_ref().map(|failure| failure.reason.clone());
    let causes = answer.map_or(&[][..], Answer::causes);
    let data = JobFinished {
        job_id: id.clone(),
        kind: job.request.kind.name(),
        status: job.row.status.name(),
        headline: answer.map(report::headline).or(failure),
        verdict: answer.and_then(Answer::verdict),
        causes: causes.iter().map(|cause| cause.effect.clone()).collect(),
        measurement: about(measured),
        links: Links {
            job: format!("/v1/jobs/{id}"),
            result: path("result"),
            report: path("report.html"),
            history: None,
        },
    };
    let topic = format!("jobs/{id}/finished");
    notice(EventType::JobFinished, event.at_ms, topic, data)
}

/// `None` where nothing changed.
fn changed(
    event: &EventRow,
    measured: &Measured,
    machine: &str,
    axis: &str,
    rows: Vec<HistoryRow>,
) -> Option<Notice> {
    if rows.is_empty() {
        return None;
    }
    let change = |row: HistoryRow| Change {
        parameter: row.parameter,
        name: row.name,
        value: row.value,
        low95: row.low95,
        high95: row.high95,
        unit: row.unit,
        change: row.change,
    };
    let [machine_part, axis_part] = [machine, axis].map(|name| utf8_percent_encode(name, PLAIN));
    let history = format!("/v1/history.json?machine={machine_part}&axis={axis_part}");
    let data = AxisChanged {
        machine: machine.to_owned(),
        axis: axis.to_owned(),
        job_id: event.job_id.clone(),
        changes: rows.into_iter().map(change).collect(),
        measurement: about(measured),
        links: Links {
            job: format!("/v1/jobs/{}", event.job_id),
            result: Some(format!("/v1/jobs/{}/result", event.job_id)),
            report: None,
            history: Some(history),
        },
    };
    let topic = format!("axes/{machine_part}/{axis_part}/changed");
    Some(notice(EventType::AxisChanged, event.at_ms, topic, data))
}

fn about(measured: &Measured) -> About {
    let row = &measured.row;
    About {
        id: row.id.clone(),
        name: row.name.clone(),
        machine: row.machine.clone(),
        axis: row.axis.clone(),
        measured_at: row.measured_at.clone(),
    }
}

fn notice(event: EventType, at_ms: Millis, topic: String, data: impl Serialize) -> Notice {
    Notice { event, topic, body: body(event.name(), at_ms, data) }
}

fn body(event: &str, at_ms: Millis, data: impl Serialize) -> String {
    let timestamp = Timestamp::from_millisecond(at_ms).map(|time| time.to_string());
    let message = Message { event, timestamp: timestamp.unwrap_or_default(), data };
    // Text and numbers only: it cannot fail.
    serde_json::to_string(&message).unwrap_or_default()
}

/// The message of a test.
pub(super) fn test_body(webhook: &str) -> String {
    let now = Timestamp::now().as_millisecond();
    body("webhook.test", now, serde_json::json!({ "webhook_id": webhook }))
}

/// Id of a message, by which a receiver knows one that it has seen.
pub(super) fn new_id() -> String {
    format!("msg_{}", uuid::Uuid::now_v7().simple())
}
