//! Errors as problem documents (RFC 9457).

use axum::Json;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use tracing::error;
use utoipa::ToSchema;

use crate::service::ServiceError;
use crate::store::StoreError;

const NO_ROOM: &str = "the disk is full, or the database as large as it may be; nothing of this \
                       request was stored; delete what is not needed and send it again";
const READ_ONLY: &str = "the database cannot be written; nothing of this request was stored; send \
                         it again when it can be";

const UNKEEPABLE: &str =
    "a text of the request has the character NUL, which is not kept; leave it out";

/// Seconds after which a request that met a sick database may be sent again.
const RETRY_AFTER_S: HeaderValue = HeaderValue::from_static("5");

/// How a caller shows who it is (RFC 6750).
const BEARER: HeaderValue = HeaderValue::from_static("Bearer realm=\"servoscope\"");

/// Media type of a problem document.
pub(super) const MEDIA_TYPE: &str = "application/problem+json";

/// A column by its position or by its name.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub(super) enum Column {
    /// Position in the line, from 1.
    Position(usize),
    /// Name of the column, or path within a JSON document.
    Name(String),
}

// Functions return it in a `Box`: an error this large would make every successful result as large.
/// What went wrong with a request, as RFC 9457 lays it out.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(super) struct Problem {
    /// Identifies the kind of problem.
    #[serde(rename = "type")]
    kind: String,
    /// The kind of problem in words.
    title: String,
    /// HTTP status code.
    status: u16,
    /// What is wrong with this request, and what would be right.
    detail: String,
    /// Uploaded file that is wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// Line that is wrong, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<u64>,
    /// Column that is wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    column: Option<Column>,
    /// Member of the request that is wrong, with dots where it is nested.
    #[serde(skip_serializing_if = "Option::is_none")]
    member: Option<String>,
    /// Where the operator finds more in the log.
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<String>,
    /// After how many seconds to try again.
    #[serde(skip)]
    retry_after_s: Option<u64>,
}

impl Problem {
    /// A problem that its status says everything about but the details.
    pub(super) fn of_status(status: StatusCode, detail: impl Into<String>) -> Box<Self> {
        let title = status.canonical_reason().unwrap_or("Error");
        Box::new(Self { kind: "about:blank".into(), ..Self::new(status, "", title, detail) })
    }

    /// The caller sent something that is not JSON.
    pub(super) fn malformed_json(error: &serde_json::Error) -> Box<Self> {
        let detail = format!("the body is not JSON: {error}");
        let status = StatusCode::BAD_REQUEST;
        Box::new(Self {
            line: Some(error.line() as u64),
            column: Some(Column::Position(error.column())),
            ..Self::new(status, "malformed-json", "Malformed JSON", detail)
        })
    }

    /// The caller sent JSON that does not have the members it should have.
    pub(super) fn wrong_json(member: String, error: &serde_json::Error) -> Box<Self> {
        Box::new(Self {
            line: Some(error.line() as u64),
            column: Some(Column::Position(error.column())),
            ..Self::invalid_request(member, error.to_string())
        })
    }

    /// A member of the request has an unusable value.
    pub(super) fn wrong_member(member: &str, error: &dyn std::fmt::Display) -> Box<Self> {
        Box::new(Self::invalid_request(member.to_owned(), format!("{member}: {error}")))
    }

    /// Something only the operator can look into. `log` is for the log alone.
    pub(super) fn internal(
        status: StatusCode,
        detail: &str,
        log: &dyn std::fmt::Display,
    ) -> Box<Self> {
        let reference = uuid::Uuid::now_v7().to_string();
        error!(reference, error = %log, "request failed");
        let detail = format!(
            "{detail}; tell the operator of the server the `reference` of this answer, which finds \
             the cause in the log"
        );
        let problem = Self::new(status, "internal", "Internal error", detail);
        Box::new(Self { reference: Some(reference), ..problem })
    }

    /// The caller asks, behind the question mark, for something that is not understood.
    pub(super) fn invalid_query(member: String, detail: String) -> Box<Self> {
        let status = StatusCode::BAD_REQUEST;
        let problem = Self::new(status, "invalid-request", "Invalid request", detail);
        Box::new(Self { member: Some(member), ..problem })
    }

    /// The caller has, or asks, as much as it may. `wait_s`: after how many seconds to try again;
    /// `None`: waiting alone does not help.
    pub(super) fn over_quota(detail: impl Into<String>, wait_s: Option<u64>) -> Self {
        let status = StatusCode::TOO_MANY_REQUESTS;
        let problem = Self::new(status, "over-quota", "Quota exceeded", detail);
        Self { retry_after_s: wait_s, ..problem }
    }

    fn invalid_request(member: String, detail: String) -> Self {
        let status = StatusCode::UNPROCESSABLE_ENTITY;
        let problem = Self::new(status, "invalid-request", "Invalid request", detail);
        Self { member: Some(member), ..problem }
    }

    fn new(status: StatusCode, kind: &str, title: &str, detail: impl Into<String>) -> Self {
        Self {
            kind: format!("urn:servoscope:problem:{kind}"),
            title: title.into(),
            status: status.as_u16(),
            detail: detail.into(),
            file: None,
            line: None,
            column: None,
            member: None,
            reference: None,
            retry_after_s: None,
        }
    }
}

impl From<ServiceError> for Box<Problem> {
    fn from(error: ServiceError) -> Self {
        Self::new(Problem::of_service(error))
    }
}

impl Problem {
    /// The one table from what went wrong to what the caller sees.
    fn of_service(error: ServiceError) -> Self {
        let text = error.to_string();
        match error {
            ServiceError::Unknown { .. } => {
                Self::new(StatusCode::NOT_FOUND, "unknown", "No such resource", text)
            }
            ServiceError::Unrecognised { .. } => {
                Self::new(StatusCode::UNAUTHORIZED, "no-key", "A key is needed", text)
            }
            ServiceError::Lacking { .. } => {
                Self::new(StatusCode::FORBIDDEN, "missing-scope", "The key lacks a scope", text)
            }
            ServiceError::Upload(wrong) => Self {
                file: Some(wrong.file),
                line: wrong.line,
                column: wrong.column.map(Column::Name),
                ..Self::new(
                    StatusCode::UNPROCESSABLE_ENTITY,
                    "unreadable-measurement",
                    "Unreadable measurement",
                    text,
                )
            },
            ServiceError::Request { member, .. } => Self::invalid_request(member, text),
            ServiceError::Member { member, source } => {
                Self { detail: text, member: Some(member), ..Self::of_service(*source) }
            }
            ServiceError::NotFinished { .. } => {
                Self::new(StatusCode::CONFLICT, "not-finished", "No result yet", text)
            }
            ServiceError::NoResult { .. } => {
                Self::new(StatusCode::NOT_FOUND, "no-result", "No result", text)
            }
            ServiceError::NoPlot { .. } => {
                Self::new(StatusCode::NOT_FOUND, "no-plot", "No such plot", text)
            }
            ServiceError::Uninspected { .. } => Self::new(
                StatusCode::UNPROCESSABLE_ENTITY,
                "uninspected",
                "Measurement cannot be inspected",
                text,
            ),
            ServiceError::HasJobs { .. } => {
                Self::new(StatusCode::CONFLICT, "has-jobs", "Measurement has jobs", text)
            }
            ServiceError::Ended { .. } => {
                Self::new(StatusCode::CONFLICT, "already-ended", "Already ended", text)
            }
            ServiceError::TooCostly { .. } => {
                Self::new(StatusCode::UNPROCESSABLE_ENTITY, "too-costly", "Too costly", text)
            }
            ServiceError::Busy => *Self::of_status(StatusCode::SERVICE_UNAVAILABLE, text),
            ServiceError::OverQuota { wait_s, .. } => Self::over_quota(text, wait_s),
            ServiceError::KeyReused { .. } => Self::new(
                StatusCode::UNPROCESSABLE_ENTITY,
                "idempotency-key-reused",
                "Idempotency key reused",
                text,
            ),
            ServiceError::Store(StoreError::Unkeepable(_)) => {
                *Self::of_status(StatusCode::UNPROCESSABLE_ENTITY, UNKEEPABLE)
            }
            ServiceError::Store(source) => {
                let (status, text) = match &source {
                    StoreError::Full(_) => (StatusCode::INSUFFICIENT_STORAGE, NO_ROOM),
                    StoreError::ReadOnly(_) => (StatusCode::SERVICE_UNAVAILABLE, READ_ONLY),
                    _ => (StatusCode::SERVICE_UNAVAILABLE, text.as_str()),
                };
                *Self::internal(status, text, &source)
            }
            ServiceError::Corrupt { source, .. } => {
                *Self::internal(StatusCode::INTERNAL_SERVER_ERROR, &text, &source)
            }
        }
    }
}

impl IntoResponse for Box<Problem> {
    fn into_response(self) -> Response {
        let status = StatusCode::from_u16(self.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let retry_after = self.retry_after_s.map(HeaderValue::from);
        let mut response = (status, Json(self)).into_response();
        if let Some(seconds) = retry_after {
            response.headers_mut().insert(header::RETRY_AFTER, seconds);
        }
        if matches!(status, StatusCode::SERVICE_UNAVAILABLE | StatusCode::INSUFFICIENT_STORAGE) {
            response.headers_mut().insert(header::RETRY_AFTER, RETRY_AFTER_S);
        }
        if status == StatusCode::UNAUTHORIZED {
            response.headers_mut().insert(header::WWW_AUTHENTICATE, BEARER);
        }
        let media_type = HeaderValue::from_static(MEDIA_TYPE);
        response.headers_mut().insert(header::CONTENT_TYPE, media_type);
        response
    }
}
