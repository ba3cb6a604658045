//! `/v1/jobs/{id}/plots`.

use axum::extract::{Path, Query, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use utoipa::{IntoParams, ToSchema};

use crate::service::{Plot, Service, Theme};

use super::problem::Problem;

/// A figure may style itself and nothing more: no script, no other file.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; sandbox";

/// A figure of a job that has ended stays the same but for new versions of the
/// service.
const SETTLED: &str = "private, max-age=3600";

/// Colours of a figure.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum PlotTheme {
    Auto,
    Light,
    Dark,
}

/// Query of a figure.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct PlotQuery {
    /// Colours: those the reader prefers (`auto`, if left out), `light` or `dark`.
    #[param(inline)]
    theme: Option<PlotTheme>,
}

/// A figure of a job as SVG; the convergence also while it runs.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/plots/{file}", tag = "jobs", operation_id = "get_plot",
    params(
        ("id" = String, Path, description = "Id of the job"),
        ("file" = String, Path,
         description = "`bode.svg`, `spectrum.svg`, `residuals.svg`, `convergence.svg` or \
                        `friction.svg`"),
        PlotQuery,
        ("If-None-Match" = Option<String>, Header, description = "`ETag` of an earlier answer"),
    ),
    responses(
        (status = 200, body = String, content_type = "image/svg+xml", headers(
            ("ETag" = String, description = "Tells this figure from any other"),
        )),
        (status = 304, description = "The figure is the one that `If-None-Match` names"),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "404 lists the figures there are, 409 until the job has ended"),
    )
)]
pub(super) async fn get(
    State(service): State<Service>,
    Path((id, file)): Path<(String, String)>,
    Query(query): Query<PlotQuery>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let theme = match query.theme {
        None | Some(PlotTheme::Auto) => Theme::Auto,
        Some(PlotTheme::Light) => Theme::Light,
        Some(PlotTheme::Dark) => Theme::Dark,
    };
    let name = file.strip_suffix(".svg").unwrap_or(&file);
    let Plot { svg, settled } = service.plot(&id, name, theme).await?;
    // Weak: the bytes on the wire may be compressed.
    let digest = Sha256::digest(svg.as_bytes());
    let tag: String = digest[..12].iter().map(|byte| format!("{byte:02x}")).collect();
    let tag = format!("W/\"{tag}\"");
    let caching = [
        (header::CACHE_CONTROL, if settled { SETTLED } else { "no-cache" }.to_owned()),
        (header::ETAG, tag.clone()),
    ];
    let known = headers.get(header::IF_NONE_MATCH).and_then(|value| value.to_str().ok());
    if known.is_some_and(|tags| tags.split(',').any(|known| known.trim() == tag)) {
        return Ok((StatusCode::NOT_MODIFIED, caching).into_response());
    }
    let content = [
        (header::CONTENT_TYPE, "image/svg+xml"),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    Ok((caching, content, svg).into_response())
}
