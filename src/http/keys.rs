//! `/v1/keys`: who may do what.

use axum::body::Bytes;
use axum::extract::Path;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{ObjectBuilder, Schema, Type};
use utoipa::{PartialSchema, ToSchema};

use crate::service::{Key, Listed, NewKey, Quotas, Scope, Service, Token};

use super::body;
use super::problem::Problem;
use super::views::{List, rfc3339};

impl PartialSchema for Scope {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(Type::String)
            .description(Some("Something that a key may do."))
            .enum_values(Some(Self::ALL.map(Self::name)))
            .into()
    }
}

impl ToSchema for Scope {}

/// A key to be made.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct AddKey {
    /// Its name, for people.
    #[schema(
        min_length = 1,
        max_length = 64,
        pattern = r"^[^\s\x00-\x1f\x7f-\x9f]([^\x00-\x1f\x7f-\x9f]*[^\s\x00-\x1f\x7f-\x9f])?$"
    )]
    name: String,
    /// What it may do.
    #[schema(min_items = 1)]
    scopes: Vec<Scope>,
    /// When it expires, RFC 3339; left out: never.
    #[schema(format = DateTime)]
    expires_at: Option<String>,
    /// What it may have, where it is not what every key may.
    #[serde(default)]
    quotas: KeyQuotas,
}

/// What a key may have; null or left out: what the settings of the server give every key.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct KeyQuotas {
    /// Measurements that it keeps.
    #[schema(minimum = 1, maximum = 1_000_000_000)]
    measurements: Option<usize>,
    /// Mebibytes of their files.
    #[schema(minimum = 1, maximum = 1_000_000_000)]
    mib: Option<usize>,
    /// Jobs of it that wait or run.
    #[schema(minimum = 1, maximum = 1_000_000_000)]
    jobs: Option<usize>,
    /// Minutes that its jobs run within 24 hours.
    #[schema(minimum = 1, maximum = 1_000_000_000)]
    compute_minutes: Option<usize>,
    /// Requests that it sends a minute.
    #[schema(minimum = 1, maximum = 1_000_000_000)]
    requests_per_minute: Option<usize>,
}

impl From<KeyQuotas> for Quotas {
    fn from(quotas: KeyQuotas) -> Self {
        let KeyQuotas { measurements, mib, jobs, compute_minutes, requests_per_minute } = quotas;
        Self { measurements, mib, jobs, compute_minutes, requests_per_minute }
    }
}

impl From<Quotas> for KeyQuotas {
    fn from(quotas: Quotas) -> Self {
        let Quotas { measurements, mib, jobs, compute_minutes, requests_per_minute } = quotas;
        Self { measurements, mib, jobs, compute_minutes, requests_per_minute }
    }
}

/// A key, without what only its holder has.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Key)]
pub(super) struct KeyView {
    /// The part of the key by which it is found.
    id: String,
    /// Its name.
    name: String,
    /// What it may do.
    scopes: Vec<Scope>,
    /// When it was made, RFC 3339.
    created_at: Option<String>,
    /// When it expires; null: never.
    expires_at: Option<String>,
    /// When it was revoked; null: it was not.
    revoked_at: Option<String>,
    /// When it was last used, to the minute; null: never.
    last_used_at: Option<String>,
    /// Whether it opens anything: it is neither revoked nor expired.
    valid: bool,
    /// What it may have, where it is not what every key may.
    quotas: KeyQuotas,
}

impl From<Key> for KeyView {
    fn from(key: Key) -> Self {
        Self {
            id: key.id,
            name: key.name,
            scopes: key.scopes,
            created_at: rfc3339(key.created_at_ms),
            expires_at: key.expires_at_ms.and_then(rfc3339),
            revoked_at: key.revoked_at_ms.and_then(rfc3339),
            last_used_at: key.used_at_ms.and_then(rfc3339),
            valid: key.valid,
            quotas: key.quotas.into(),
        }
    }
}

/// A key with what only its holder has.
#[derive(Serialize, ToSchema)]
pub(super) struct AddedKey {
    #[serde(flatten)]
    pub(super) stored: KeyView,
    /// The whole key. It is not shown again.
    pub(super) key: String,
}

impl AddedKey {
    fn new(key: Key, token: &Token) -> Self {
        Self { stored: key.into(), key: token.text() }
    }
}

/// Makes a key. From the first one on, every request needs one.
#[utoipa::path(
    post, path = "/v1/keys", tag = "keys", operation_id = "add_key",
    request_body = AddKey,
    responses(
        (status = 201, body = AddedKey,
         headers(("Location" = String, description = "Where the key is"))),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn add(
    Extension(service): Extension<Service>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, Box<Problem>> {
    let AddKey { name, scopes, expires_at, quotas } = body::json(&headers, &body)?;
    let expires_at = expires_at.map(|text| text.parse::<Timestamp>()).transpose();
    let expires_at = expires_at.map_err(|error| Problem::wrong_member("expires_at", &error))?;
    let expires_at_ms = expires_at.map(Timestamp::as_millisecond);
    let new = NewKey { name, scopes, expires_at_ms, quotas: quotas.into() };
    let (key, token) = service.add_key(new).await?;
    let location = [(header::LOCATION, format!("/v1/keys/{}", key.id))];
    Ok((StatusCode::CREATED, location, Json(AddedKey::new(key, &token))).into_response())
}

/// Keys, those that were made last first, also those that open nothing any more; at most 1000.
#[utoipa::path(
    get, path = "/v1/keys", tag = "keys", operation_id = "list_keys",
    responses((status = 200, body = List<KeyView>))
)]
pub(super) async fn list(
    Extension(service): Extension<Service>,
) -> Result<Json<List<KeyView>>, Box<Problem>> {
    Ok(Json(List::new(Listed { items: service.keys().await?, next: None })))
}

/// One key.
#[utoipa::path(
    get, path = "/v1/keys/{id}", tag = "keys", operation_id = "get_key",
    params(("id" = String, Path, description = "Id of the key")),
    responses(
        (status = 200, body = KeyView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn get(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Json<KeyView>, Box<Problem>> {
    Ok(Json(service.key(&id).await?.into()))
}

/// Gives a key another secret.
///
/// Its id, name, scopes and data stay, and it lives as long again as it was to live at first. The
/// old secret, and sessions that were begun with it, end at once.
#[utoipa::path(
    post, path = "/v1/keys/{id}/rotate", tag = "keys", operation_id = "rotate_key",
    params(("id" = String, Path, description = "Id of the key")),
    responses(
        (status = 200, body = AddedKey),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "422 where it was revoked"),
    )
)]
pub(super) async fn rotate(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<Json<AddedKey>, Box<Problem>> {
    let (key, token) = service.rotate_key(&id).await?;
    Ok(Json(AddedKey::new(key, &token)))
}

/// Gives a key other quotas in place of all that it had.
///
/// They hold from its next request on; what it has already stays.
#[utoipa::path(
    put, path = "/v1/keys/{id}/quotas", tag = "keys", operation_id = "limit_key",
    params(("id" = String, Path, description = "Id of the key")),
    request_body = KeyQuotas,
    responses(
        (status = 200, body = KeyView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn limit(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Json<KeyView>, Box<Problem>> {
    let quotas: KeyQuotas = body::json(&headers, &body)?;
    Ok(Json(service.limit_key(&id, &quotas.into()).await?.into()))
}

/// Revokes a key for good. It stays in the list, and what it made stays stored.
#[utoipa::path(
    delete, path = "/v1/keys/{id}", tag = "keys", operation_id = "revoke_key",
    params(("id" = String, Path, description = "Id of the key")),
    responses(
        (status = 204, description = "It opens nothing any more"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn revoke(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
) -> Result<StatusCode, Box<Problem>> {
    service.revoke_key(&id).await?;
    Ok(StatusCode::NO_CONTENT)
}
