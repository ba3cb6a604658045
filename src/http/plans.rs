//! `/v1/plans`: experiments planned before anything is measured.

use axum::body::Bytes;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::Deserialize;
use servoscope_core::answers::{Plan, PlanOptions, RoughAxis};
use utoipa::{IntoParams, ToSchema};

use crate::service::{PlanFor, Service};

use super::body;
use super::plots::{PlotQuery, PlotTheme};
use super::problem::Problem;
use super::query::Query;

/// The axis to plan for: given directly, or taken from an earlier result.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct AskForPlan {
    /// A rough idea of the axis.
    axis: Option<RoughAxis>,
    /// In its place a job that has succeeded, of either kind: the axis is its base model.
    job_id: Option<String>,
    /// Time that the experiments may take in all, settling included, s.
    #[schema(exclusive_minimum = 0.0)]
    budget_s: f64,
    /// Limits, noise and seed.
    #[serde(default)]
    options: PlanOptions,
}

impl From<AskForPlan> for PlanFor {
    fn from(asked: AskForPlan) -> Self {
        let AskForPlan { axis, job_id, budget_s, options } = asked;
        Self { axis, job_id, budget_s, options }
    }
}

/// Which input is written.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct ExcitationQuery {
    /// `stepped-sine` (if left out) or `multisine`.
    #[param(pattern = "^(stepped-sine|multisine)$")]
    kind: Option<String>,
}

/// How the figure of a plan is drawn.
#[derive(Debug, Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(super) struct PlanFigureQuery {
    /// Colours: those the reader prefers (`auto`, if left out), `light` or `dark`.
    #[param(inline)]
    theme: Option<PlotTheme>,
    /// Width, pixels; left out: in proportion to the height, 800 without one.
    #[param(minimum = 50, maximum = 10000)]
    width: Option<u32>,
    /// Height, pixels; left out: in proportion to the width. With both, the figure is as large as
    /// fits in.
    #[param(minimum = 50, maximum = 10000)]
    height: Option<u32>,
    /// Unit of the input, which the axis of magnitudes names.
    input_unit: Option<String>,
}

/// Plans experiments: where to measure, in which order, and which effects a diagnosis could then identify.
///
/// It takes a few seconds and stores nothing: the same question has the same answer.
#[utoipa::path(
    post, path = "/v1/plans", tag = "plans", operation_id = "plan",
    request_body = AskForPlan,
    responses(
        (status = 200, body = Plan),
        (status = "4XX", body = Problem, content_type = "application/problem+json",
         description = "422 names the member that cannot be used; 404 for an unknown job"),
    )
)]
pub(super) async fn create(
    Extension(service): Extension<Service>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Json<Plan>, Box<Problem>> {
    let asked: AskForPlan = body::json(&headers, &body)?;
    Ok(Json(Plan::clone(&*service.plan(asked.into()).await?)))
}

/// The input of a plan as samples, which a generator or a drive can play.
///
/// With a column `output` added, it is a record that `POST /v1/measurements` takes.
#[utoipa::path(
    post, path = "/v1/plans/excitation.csv", tag = "plans", operation_id = "plan_excitation",
    params(ExcitationQuery),
    request_body = AskForPlan,
    responses(
        (status = 200, body = String, content_type = "text/csv"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn excitation(
    Extension(service): Extension<Service>,
    Query(query): Query<ExcitationQuery>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, Box<Problem>> {
    let asked: AskForPlan = body::json(&headers, &body)?;
    let kind = query.kind.as_deref().unwrap_or("stepped-sine");
    let text = service.plan_excitation(asked.into(), kind).await?;
    Ok(([(header::CONTENT_TYPE, "text/csv")], text).into_response())
}

/// A plan as SVG: its experiments, and what they identify beside a sweep.
#[utoipa::path(
    post, path = "/v1/plans/plan.svg", tag = "plans", operation_id = "plan_figure",
    params(PlanFigureQuery),
    request_body = AskForPlan,
    responses(
        (status = 200, body = String, content_type = "image/svg+xml"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn figure(
    Extension(service): Extension<Service>,
    Query(query): Query<PlanFigureQuery>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, Box<Problem>> {
    let asked: AskForPlan = body::json(&headers, &body)?;
    let PlanFigureQuery { theme, width, height, input_unit } = query;
    let format = PlotQuery { theme, width, height }.format()?;
    let unit = input_unit.unwrap_or_default();
    let svg = service.plan_figure(asked.into(), &unit, format).await?;
    Ok(([(header::CONTENT_TYPE, "image/svg+xml")], svg).into_response())
}
