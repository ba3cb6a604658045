//! `/v1/jobs/{id}/plots`.

use axum::Extension;
use axum::extract::Path;
use axum::http::{HeaderMap, StatusCode};
use axum::response::Response;
use serde::Deserialize;
use utoipa::{IntoParams, ToSchema};

use crate::service::{Format, Plot, Service, Theme};

use super::cached;
use super::problem::Problem;
use super::query::Query;

/// Colours of a figure.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum PlotTheme {
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
    pub(super) theme: Option<PlotTheme>,
    /// Width, pixels; left out: in proportion to the height, 800 without one.
    #[param(minimum = 50, maximum = 10000)]
    pub(super) width: Option<u32>,
    /// Height, pixels; left out: in proportion to the width. With both, the figure
    /// is as large as fits in.
    #[param(minimum = 50, maximum = 10000)]
    pub(super) height: Option<u32>,
}

/// Sides of a figure, pixels: what can be read, and what a browser can draw.
const SIDES: std::ops::RangeInclusive<u32> = 50..=10_000;

impl PlotQuery {
    pub(super) fn format(&self) -> Result<Format, Box<Problem>> {
        for (name, side) in [("width", self.width), ("height", self.height)] {
            if let Some(side) = side.filter(|side| !SIDES.contains(side)) {
                let [least, most] = [SIDES.start(), SIDES.end()];
                let detail = format!("{name}: {side} is outside {least} to {most} pixels");
                return Err(Problem::of_status(StatusCode::BAD_REQUEST, detail));
            }
        }
        let theme = match self.theme {
            None | Some(PlotTheme::Auto) => Theme::Auto,
            Some(PlotTheme::Light) => Theme::Light,
            Some(PlotTheme::Dark) => Theme::Dark,
        };
        Ok(Format { theme, width: self.width, height: self.height })
    }
}

/// A figure of a job as SVG; the convergence also while it runs.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/plots/{file}", tag = "jobs", operation_id = "get_plot",
    params(
        ("id" = String, Path, description = "Id of the job"),
        ("file" = String, Path,
         description = "`bode.svg`, `linearity.svg`, `spectrum.svg`, `residuals.svg`, \
                        `convergence.svg` or `friction.svg`; with the causes of a diagnosis \
                        `spectrum-after.svg`, `residuals-after.svg` or `friction-after.svg`; \
                        `bode-against-{job}.svg` with the id of another job: both in one"),
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
    Extension(service): Extension<Service>,
    Path((id, file)): Path<(String, String)>,
    Query(query): Query<PlotQuery>,
    headers: HeaderMap,
) -> Result<Response, Box<Problem>> {
    let name = file.strip_suffix(".svg").unwrap_or(&file);
    let Plot { svg, settled } = service.plot(&id, name, query.format()?).await?;
    Ok(cached::answer(&headers, "image/svg+xml", svg, settled))
}
