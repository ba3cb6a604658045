//! `/v1/jobs/{id}/report.html`.

use axum::Extension;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::Response;

use std::sync::LazyLock;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

use crate::service::{Service, page_script};

use super::cached::{self, Kept, SETTLED};
use super::problem::Problem;

/// What the page may do: style itself, run the one script that it carries, and keep pictures of
/// its figures. It asks nobody for anything, and is nobody of this server's origin.
static POLICY: LazyLock<String> = LazyLock::new(|| {
    let digest = BASE64_STANDARD.encode(Sha256::digest(page_script()));
    format!(
        "default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{digest}'; img-src data:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'; \
         sandbox allow-scripts allow-downloads"
    )
});

/// The answer to a job as one page for a person: verdict, causes, figures,
/// model and provenance, without another file.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/report.html", tag = "jobs", operation_id = "get_report",
    params(
        ("id" = String, Path, description = "Id of the job"),
        ("If-None-Match" = Option<String>, Header, description = "`ETag` of an earlier answer"),
    ),
    responses(
        (status = 200, body = String, content_type = "text/html; charset=utf-8", headers(
            ("ETag" = String, description = "Tells this page from any other"),
        )),
        (status = 304, description = "The page is the one that `If-None-Match` names"),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "409 until the job has ended, 404 where it ended without a result"),
    )
)]
pub(super) async fn get(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Box<Problem>> {
    let page = service.report(&id).await?;
    let media_type = "text/html; charset=utf-8";
    Ok(cached::keep(&headers, Kept { media_type, policy: &POLICY, caching: SETTLED }, page.into()))
}
