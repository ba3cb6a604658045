//! `/v1/session`: browsers that are signed in with a key.

use axum::body::Bytes;
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::service::Service;

use super::keys::KeyView;
use super::problem::Problem;
use super::{body, gate};

/// What a browser signs in with.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SignIn {
    /// The whole key.
    key: String,
}

/// Who asks.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Session)]
pub(super) struct SessionView {
    /// The key; null where the server has no keys and asks for none.
    pub(super) key: Option<KeyView>,
}

/// Signs a browser in: from then on its cookie stands for the key, for 12 hours at most.
///
/// One that is signed in already is signed out first. Of more than 20 browsers that are signed in with
/// one key, the first is signed out.
///
/// Scripts cannot read the cookie, and pages of other sites cannot make a browser send it. A change
/// that comes with it must name its page in `Origin` or `Sec-Fetch-Site`, as browsers do.
#[utoipa::path(
    post, path = "/v1/session", tag = "keys", operation_id = "sign_in",
    request_body = SignIn,
    responses(
        (status = 200, body = SessionView,
         headers(("Set-Cookie" = String, description = "The session"))),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn sign_in(
    Extension(service): Extension<Service>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, Box<Problem>> {
    let SignIn { key } = body::json(&headers, &body)?;
    let session = service.sign_in(key.trim(), gate::session(&headers)).await?;
    let cookie = gate::cookie(&session.secret, session.lifetime.as_secs(), &headers);
    let view = SessionView { key: Some(session.key.into()) };
    Ok(([(header::SET_COOKIE, cookie)], Json(view)).into_response())
}

/// Who asks: the key that was sent, or the one that the browser is signed in with.
#[utoipa::path(
    get, path = "/v1/session", tag = "keys", operation_id = "get_session",
    responses((status = 200, body = SessionView))
)]
pub(super) async fn get(Extension(service): Extension<Service>) -> Json<SessionView> {
    let key = service.caller().key().cloned().map(KeyView::from);
    Json(SessionView { key })
}

/// Signs a browser out.
#[utoipa::path(
    delete, path = "/v1/session", tag = "keys", operation_id = "sign_out",
    responses(
        (status = 204, description = "The session has ended"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn sign_out(
    Extension(service): Extension<Service>,
    headers: HeaderMap,
) -> Result<Response, Box<Problem>> {
    if let Some(secret) = gate::session(&headers) {
        service.sign_out(secret).await?;
    }
    let forgotten = [
        (header::SET_COOKIE, gate::cookie("", 0, &headers)),
        // What the browser has kept was for the key that is gone.
        (HeaderName::from_static("clear-site-data"), "\"cache\"".to_owned()),
    ];
    Ok((StatusCode::NO_CONTENT, forgotten).into_response())
}
