//! `/` and `/assets`: the dashboard.

use axum::extract::{Path, Request};
use axum::http::{HeaderMap, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};

use crate::web::{self, Asset};

use super::cached::{self, Kept};
use super::problem::Problem;

/// What the page may use: this server, and nothing else; no script or style in
/// line, and no page around it. A figure becomes a picture by way of `data:`.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'";

/// A new version of the program brings new files under the same names: a browser
/// asks each time, and is told that nothing has changed.
const CACHING: &str = "no-cache";

/// The page, at each address that its script knows.
pub(super) async fn page(headers: HeaderMap) -> Response {
    answer(&headers, web::index())
}

/// Whether a request is that of a browser for a page: it prefers HTML, and does not ask for a file
/// or of the interface for programs.
pub(super) fn is_page(request: &Request) -> bool {
    let accept = request.headers().get(header::ACCEPT).and_then(|value| value.to_str().ok());
    let first = accept.unwrap_or_default().split([',', ';']).next().unwrap_or_default();
    let path = request.uri().path();
    let of_programs = ["/v1/", "/assets/"].iter().any(|part| path.starts_with(part));
    request.method() == Method::GET && first.trim() == "text/html" && !of_programs
}

/// The page at an address that its script does not know, where it says so.
pub(super) fn unknown_page() -> Response {
    let Asset { media_type, text } = web::index();
    let headers = [(header::CONTENT_TYPE, media_type), (header::CONTENT_SECURITY_POLICY, POLICY)];
    (StatusCode::NOT_FOUND, headers, text.into_owned()).into_response()
}

/// A file that the page asks for.
pub(super) async fn asset(
    Path(name): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Box<Problem>> {
    let found = web::asset(&name);
    let missing =
        || Problem::of_status(StatusCode::NOT_FOUND, format!("there is no file `{name}`"));
    Ok(answer(&headers, found.ok_or_else(missing)?))
}

fn answer(headers: &HeaderMap, asset: Asset) -> Response {
    let Asset { media_type, text } = asset;
    let kept = Kept { media_type, policy: POLICY, caching: CACHING };
    cached::keep(headers, kept, text).into_response()
}
