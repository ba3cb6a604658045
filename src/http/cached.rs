//! Documents that a client may keep: results, tables, figures, pages.

use std::borrow::Cow;

use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use sha2::{Digest, Sha256};

/// A document may style itself and nothing more: no script, no other file.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; sandbox";

/// What is made of a job that has ended stays the same but for new versions of
/// the service.
const SETTLED: &str = "private, max-age=3600";

/// What goes with a document.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kept {
    /// Its media type.
    pub(super) media_type: &'static str,
    /// What it may do in a browser.
    pub(super) policy: &'static str,
    /// How long it may be kept without asking again.
    pub(super) caching: &'static str,
}

/// Answers with a document that may style itself, or with 304 where the request
/// names it by its tag. `settled`: it will stay as it is.
pub(super) fn answer(
    request: &HeaderMap,
    media_type: &'static str,
    document: String,
    settled: bool,
) -> Response {
    let caching = if settled { SETTLED } else { "no-cache" };
    keep(request, Kept { media_type, policy: POLICY, caching }, document.into())
}

/// The same for any document.
pub(super) fn keep(request: &HeaderMap, kept: Kept, document: Cow<'static, str>) -> Response {
    // Weak: the bytes on the wire may be compressed.
    let digest = Sha256::digest(document.as_bytes());
    let tag: String = digest[..12].iter().map(|byte| format!("{byte:02x}")).collect();
    let tag = format!("W/\"{tag}\"");
    let caching = [(header::CACHE_CONTROL, kept.caching.to_owned()), (header::ETAG, tag.clone())];
    let known = request.get(header::IF_NONE_MATCH).and_then(|value| value.to_str().ok());
    if known.is_some_and(|tags| tags.split(',').any(|known| known.trim() == tag)) {
        return (StatusCode::NOT_MODIFIED, caching).into_response();
    }
    let content = [
        (header::CONTENT_TYPE, kept.media_type),
        (header::CONTENT_SECURITY_POLICY, kept.policy),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    (caching, content, document).into_response()
}
