//! `/v1/jobs/{id}/report.html`.

use axum::Extension;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::Response;

use std::sync::LazyLock;

use crate::service::{Service, page_script};

use super::cached::{self, Kept, SETTLED};
use super::problem::Problem;

/// The one script that the page carries.
static SCRIPT: LazyLock<String> = LazyLock::new(|| cached::digest(page_script()));

/// What a page may do: style itself, run its script, and keep pictures of its figures. It asks
/// nobody for anything, and is nobody of this server's origin.
fn policy(page: &str) -> String {
    format!(
        "default-src 'none'; style-src {}; script-src {}; img-src data:; base-uri 'none'; \
         form-action 'none'; frame-ancestors 'none'; sandbox allow-scripts allow-downloads",
        cached::styles(page),
        *SCRIPT
    )
}

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
    let (media_type, policy) = ("text/html; charset=utf-8", policy(&page));
    let kept = Kept { media_type, policy: &policy, caching: SETTLED };
    Ok(cached::keep(&headers, kept, page.into()))
}
