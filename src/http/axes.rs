//! `/v1/results`, `/v1/axes` and `/v1/history`: flat, over the time of measuring.

use axum::http::HeaderMap;
use axum::response::Response;
use axum::{Extension, Json};
use serde::{Deserialize, Serialize};
use servoscope_core::answers::{HistoryRow, ResultRow};
use utoipa::{IntoParams, ToSchema};

use crate::service::{HistoryQuery, Service};
use crate::store::ResultFilter;

use super::plots::{PlotQuery, PlotTheme};
use super::problem::Problem;
use super::query::Query;
use super::views::{Axis, List};
use super::{cached, flat, lists};

/// Rows of a table.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Rows<T> {
    /// The rows.
    rows: Vec<T>,
}

/// Query of results.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct ResultsQuery {
    /// Only of this machine.
    machine: Option<String>,
    /// Only of this axis.
    axis: Option<String>,
    /// Only of this measurement.
    measurement_id: Option<String>,
    /// Only measurements made at this time or later (RFC 3339). If an upload does not state its
    /// time, the time of upload counts.
    #[param(format = DateTime)]
    from: Option<String>,
    /// Only those measured before this time.
    #[param(format = DateTime)]
    to: Option<String>,
}

impl ResultsQuery {
    fn filter(self) -> Result<ResultFilter, Box<Problem>> {
        Ok(ResultFilter {
            from_ms: lists::time("from", self.from.as_deref())?,
            to_ms: lists::time("to", self.to.as_deref())?,
            machine: self.machine,
            axis: self.axis,
            measurement_id: self.measurement_id,
            latest_only: false,
        })
    }
}

/// What came of jobs, one row each, latest measured first; at most 500.
#[utoipa::path(
    get, path = "/v1/results.json", tag = "axes", operation_id = "list_results",
    params(ResultsQuery),
    responses(
        (status = 200, body = Rows<ResultRow>),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn results_json(
    Extension(service): Extension<Service>,
    Query(query): Query<ResultsQuery>,
) -> Result<Json<Rows<ResultRow>>, Box<Problem>> {
    Ok(Json(Rows { rows: service.results(&query.filter()?).await? }))
}

/// The same as a table.
#[utoipa::path(
    get, path = "/v1/results.csv", tag = "axes", operation_id = "list_results_csv",
    params(ResultsQuery),
    responses(
        (status = 200, body = String, content_type = "text/csv"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn results_csv(
    Extension(service): Extension<Service>,
    Query(query): Query<ResultsQuery>,
) -> Result<Response, Box<Problem>> {
    flat::csv(ResultRow::COLUMNS, &service.results(&query.filter()?).await?)
}

/// Query of axes.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct AxesQuery {
    /// Only of this machine.
    machine: Option<String>,
}

/// Axes that measurements name, by machine and axis.
#[utoipa::path(
    get, path = "/v1/axes", tag = "axes", operation_id = "list_axes",
    params(AxesQuery),
    responses(
        (status = 200, body = List<Axis>),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn list(
    Extension(service): Extension<Service>,
    Query(query): Query<AxesQuery>,
) -> Result<Json<List<Axis>>, Box<Problem>> {
    Ok(Json(List::new(service.axes(query.machine.as_deref()).await?)))
}

/// Query of the history of an axis.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct AxisQuery {
    /// The machine.
    machine: String,
    /// The axis.
    axis: String,
    /// Only this parameter.
    parameter: Option<String>,
    /// Only values that changed (`true`), or that did not.
    changed: Option<bool>,
    /// Only measurements made at this time or later (RFC 3339). If an upload does not state its
    /// time, the time of upload counts.
    #[param(format = DateTime)]
    from: Option<String>,
    /// Only what was measured before this time.
    #[param(format = DateTime)]
    to: Option<String>,
}

impl AxisQuery {
    fn check(self) -> Result<HistoryQuery, Box<Problem>> {
        Ok(HistoryQuery {
            from_ms: lists::time("from", self.from.as_deref())?,
            to_ms: lists::time("to", self.to.as_deref())?,
            machine: self.machine,
            axis: self.axis,
            parameter: self.parameter,
            changed: self.changed,
        })
    }
}

/// Parameters of an axis with their intervals, by the time of measuring.
///
/// Of each measurement it is the result that was asked for last, of the model that
/// explains it best. `changed`: the value differs from the one before by more than
/// the joint 95 % interval of both.
#[utoipa::path(
    get, path = "/v1/history.json", tag = "axes", operation_id = "get_history",
    params(AxisQuery),
    responses(
        (status = 200, body = Rows<HistoryRow>),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn history_json(
    Extension(service): Extension<Service>,
    Query(query): Query<AxisQuery>,
) -> Result<Json<Rows<HistoryRow>>, Box<Problem>> {
    Ok(Json(Rows { rows: service.axis_history(&query.check()?).await? }))
}

/// The same as a table.
#[utoipa::path(
    get, path = "/v1/history.csv", tag = "axes", operation_id = "get_history_csv",
    params(AxisQuery),
    responses(
        (status = 200, body = String, content_type = "text/csv"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn history_csv(
    Extension(service): Extension<Service>,
    Query(query): Query<AxisQuery>,
) -> Result<Response, Box<Problem>> {
    flat::csv(HistoryRow::COLUMNS, &service.axis_history(&query.check()?).await?)
}

/// Query of the same as a figure.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct FigureQuery {
    /// The machine.
    machine: String,
    /// The axis.
    axis: String,
    /// Only this parameter.
    parameter: Option<String>,
    /// Only measurements made at this time or later (RFC 3339).
    #[param(format = DateTime)]
    from: Option<String>,
    /// Only what was measured before this time.
    #[param(format = DateTime)]
    to: Option<String>,
    /// Colours: those the reader prefers (`auto`, if left out), `light` or `dark`.
    #[param(inline)]
    theme: Option<PlotTheme>,
    /// Width, pixels.
    #[param(minimum = 50, maximum = 10000)]
    width: Option<u32>,
    /// Height, pixels.
    #[param(minimum = 50, maximum = 10000)]
    height: Option<u32>,
}

/// The same as a figure: each parameter with its interval, changes marked.
#[utoipa::path(
    get, path = "/v1/history.svg", tag = "axes", operation_id = "get_history_figure",
    params(FigureQuery),
    responses(
        (status = 200, body = String, content_type = "image/svg+xml"),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "404 where nothing is known of the axis at that time"),
    )
)]
pub(super) async fn history_svg(
    Extension(service): Extension<Service>,
    Query(query): Query<FigureQuery>,
    headers: HeaderMap,
) -> Result<Response, Box<Problem>> {
    let FigureQuery { machine, axis, parameter, from, to, theme, width, height } = query;
    let format = PlotQuery { theme, width, height }.format()?;
    let query = AxisQuery { machine, axis, parameter, changed: None, from, to }.check()?;
    let svg = service.axis_figure(&query, format).await?;
    Ok(cached::answer(&headers, "image/svg+xml", svg, false))
}
