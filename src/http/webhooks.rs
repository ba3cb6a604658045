//! `/v1/webhooks`.

use axum::body::Bytes;
use axum::extract::Path;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::service::{EventType, Listed, NewWebhook, Service, Tested, Webhook};
use crate::store::DeliveryRow;

use super::body;
use super::problem::Problem;
use super::views::{List, rfc3339};

/// An event that a webhook can get.
#[derive(Debug, Clone, Copy, Serialize, Deserialize, ToSchema)]
#[schema(as = EventType)]
pub(super) enum EventName {
    /// A job succeeded, failed or was cancelled.
    #[serde(rename = "job.finished")]
    JobFinished,
    /// A parameter of an axis differs from the measurement before by more than the joint 95 %
    /// interval of both.
    #[serde(rename = "axis.changed")]
    AxisChanged,
}

impl From<EventType> for EventName {
    fn from(event: EventType) -> Self {
        match event {
            EventType::JobFinished => Self::JobFinished,
            EventType::AxisChanged => Self::AxisChanged,
        }
    }
}

impl From<EventName> for EventType {
    fn from(name: EventName) -> Self {
        match name {
            EventName::JobFinished => Self::JobFinished,
            EventName::AxisChanged => Self::AxisChanged,
        }
    }
}

/// Who is to be told what.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct AddWebhook {
    /// Where messages go, http or https. Its name must lead to public addresses, or to ones
    /// that the operator allows.
    #[schema(max_length = 2000)]
    url: String,
    /// The events that it gets; left out: all.
    #[schema(min_items = 1)]
    events: Option<Vec<EventName>>,
    /// What messages are signed with: `whsec_` and 24 to 64 bytes in base64; left out: a new one.
    #[schema(
        pattern = "^whsec_(([A-Za-z0-9+/]{4}){8,20}([A-Za-z0-9+/]{2}[AEIMQUYcgkosw048]=)?|([A-Za-z0-9+/]{4}){8,21}([A-Za-z0-9+/][AQgw]==)?)$"
    )]
    secret: Option<String>,
}

/// A registered webhook.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Webhook)]
pub(super) struct WebhookView {
    /// Its id.
    id: String,
    /// When it was stored, RFC 3339.
    created_at: Option<String>,
    /// Where messages go.
    url: String,
    /// The events that it gets.
    events: Vec<EventName>,
    /// Why it gets no more messages; null if it still gets them.
    disabled: Option<String>,
}

impl From<Webhook> for WebhookView {
    fn from(Webhook { id, created_at_ms, url, events, disabled }: Webhook) -> Self {
        let events = events.into_iter().map(Into::into).collect();
        Self { id, created_at: rfc3339(created_at_ms), url, events, disabled }
    }
}

/// A webhook with its secret.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct AddedWebhook {
    #[serde(flatten)]
    webhook: WebhookView,
    /// What messages are signed with. It is not shown again.
    secret: String,
}

/// State of a message.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Delivery {
    /// Its id: the header `webhook-id`, the same at every attempt.
    id: String,
    /// Type of event.
    event: String,
    /// `waiting`, `delivered` or `given_up`.
    status: String,
    /// Attempts so far.
    attempts: u32,
    /// When it was stored, RFC 3339.
    created_at: Option<String>,
    /// When it is tried next; null once it is settled.
    next_attempt_at: Option<String>,
    /// When it was settled; null while it waits.
    ended_at: Option<String>,
    /// Status of the latest answer; null where there was none.
    answered: Option<u16>,
    /// Why the latest attempt failed; null where it did not.
    error: Option<String>,
}

impl From<DeliveryRow> for Delivery {
    fn from(row: DeliveryRow) -> Self {
        let next_attempt_at = row.ended_at_ms.is_none().then(|| rfc3339(row.due_ms)).flatten();
        Self {
            id: row.id,
            event: row.event,
            status: row.status,
            attempts: row.attempts,
            created_at: rfc3339(row.created_at_ms),
            next_attempt_at,
            ended_at: row.ended_at_ms.and_then(rfc3339),
            answered: row.answered,
            error: row.error,
        }
    }
}

/// What came of a test.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct TestedWebhook {
    /// Whether the receiver took the message.
    delivered: bool,
    /// Status of its answer; null where there was none.
    answered: Option<u16>,
    /// Why it did not take it; null where it did.
    error: Option<String>,
    /// How long it took, seconds.
    seconds: f64,
}

impl From<Tested> for TestedWebhook {
    fn from(Tested { answered, error, seconds }: Tested) -> Self {
        Self { delivered: error.is_none(), answered, error, seconds }
    }
}

/// Registers a webhook.
///
/// Messages are signed as Standard Webhooks lays down, and repeated for three days until they are
/// answered with 2xx. A message may arrive more than once, with the same `webhook-id`.
#[utoipa::path(
    post, path = "/v1/webhooks", tag = "webhooks", operation_id = "add_webhook",
    request_body = AddWebhook,
    responses(
        (status = 201, body = AddedWebhook,
         headers(("Location" = String, description = "Where the webhook is"))),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "422 where its address may not be used"),
    )
)]
pub(super) async fn add(
    Extension(service): Extension<Service>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, Box<Problem>> {
    let AddWebhook { url, events, secret } = body::json(&headers, &body)?;
    let events = events.map(|events| events.into_iter().map(Into::into).collect());
    let (webhook, secret) = service.add_webhook(NewWebhook { url, events, secret }).await?;
    let location = [(header::LOCATION, format!("/v1/webhooks/{}", webhook.id))];
    let view = AddedWebhook { webhook: webhook.into(), secret: secret.text() };
    Ok((StatusCode::CREATED, location, Json(view)).into_response())
}

/// Webhooks, newest first. A key has at most 100, which are on one page; of those of all keys it shows
/// 1000 at most.
#[utoipa::path(
    get, path = "/v1/webhooks", tag = "webhooks", operation_id = "list_webhooks",
    responses(
        (status = 200, body = List<WebhookView>),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn list(
    Extension(service): Extension<Service>,
) -> Result<Json<List<WebhookView>>, Box<Problem>> {
    Ok(Json(List::new(Listed { items: service.webhooks().await?, next: None })))
}

/// One webhook.
#[utoipa::path(
    get, path = "/v1/webhooks/{id}", tag = "webhooks", operation_id = "get_webhook",
    params(("id" = String, Path, description = "Id of the webhook")),
    responses(
        (status = 200, body = WebhookView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn get(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Json<WebhookView>, Box<Problem>> {
    Ok(Json(service.webhook(&id).await?.into()))
}

/// Removes a webhook and what waits for it.
#[utoipa::path(
    delete, path = "/v1/webhooks/{id}", tag = "webhooks", operation_id = "delete_webhook",
    params(("id" = String, Path, description = "Id of the webhook")),
    responses(
        (status = 204, description = "It is gone"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn delete(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<StatusCode, Box<Problem>> {
    service.delete_webhook(&id).await?;
    Ok(StatusCode::NO_CONTENT)
}

/// Sends a webhook a message of the type `webhook.test` now, and says what came back.
///
/// It is sent once, whatever comes back.
#[utoipa::path(
    post, path = "/v1/webhooks/{id}/test", tag = "webhooks", operation_id = "test_webhook",
    params(("id" = String, Path, description = "Id of the webhook")),
    responses(
        (status = 200, body = TestedWebhook),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn test(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Json<TestedWebhook>, Box<Problem>> {
    Ok(Json(service.test_webhook(&id).await?.into()))
}

/// The latest messages to a webhook, newest first; at most 200, of the last 14 days.
#[utoipa::path(
    get, path = "/v1/webhooks/{id}/deliveries", tag = "webhooks", operation_id = "list_deliveries",
    params(("id" = String, Path, description = "Id of the webhook")),
    responses(
        (status = 200, body = List<Delivery>),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn deliveries(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Json<List<Delivery>>, Box<Problem>> {
    Ok(Json(List::new(Listed { items: service.deliveries(&id).await?, next: None })))
}
