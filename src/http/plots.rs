//! `/v1/jobs/{id}/plots`.

use axum::extract::{Path, Query, State};
use axum::http::HeaderMap;
use axum::response::Response;
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

use crate::service::{Plot, Service, Theme};

use super::cached;
use super::problem::Problem;

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
    Ok(cached::answer(&headers, "image/svg+xml", svg, settled))
}
