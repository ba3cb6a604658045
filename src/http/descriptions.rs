//! `PATCH /v1/measurements/{id}`: what a measurement says of itself.

use std::collections::BTreeMap;

use axum::Extension;
use axum::Json;
use axum::body::Bytes;
use axum::extract::Path;
use axum::http::HeaderMap;
use serde::Deserialize;
use utoipa::ToSchema;
use utoipa::openapi::schema::{ObjectBuilder, Schema, SchemaType, Type};

use crate::service::{Redescribed, Service};

use super::body;
use super::problem::Problem;
use super::views::MeasurementView;

/// What is changed; what is left out stays. An empty text removes a value.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct DescribeMeasurement {
    /// Its name.
    #[schema(max_length = 1000)]
    name: Option<String>,
    /// The machine.
    #[schema(max_length = 1000)]
    machine: Option<String>,
    /// The axis of the machine.
    #[schema(max_length = 1000)]
    axis: Option<String>,
    /// Who measured.
    #[schema(max_length = 1000)]
    operator: Option<String>,
    /// When it was measured, RFC 3339.
    measured_at: Option<String>,
    #[schema(schema_with = labels)]
    labels: Option<BTreeMap<String, String>>,
}

/// All labels of a measurement.
fn labels() -> Schema {
    let labels = ObjectBuilder::new()
        .schema_type(SchemaType::from_iter([Type::Object, Type::Null]))
        .description(Some("All labels: those that are not among them go."));
    let text = ObjectBuilder::new().schema_type(Type::String).max_length(Some(1000));
    labels.additional_properties(Some(text)).max_properties(Some(100)).build().into()
}

/// Changes the details of a measurement.
///
/// Units, response and loop stay as they were read. `PUT /v1/measurements/{id}/reading` reads the
/// files again, until there is a job on the measurement.
#[utoipa::path(
    patch, path = "/v1/measurements/{id}", tag = "measurements",
    operation_id = "describe_measurement",
    params(("id" = String, Path, description = "Id of the measurement")),
    request_body = DescribeMeasurement,
    responses(
        (status = 200, body = MeasurementView),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn describe(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Json<MeasurementView>, Box<Problem>> {
    let change: DescribeMeasurement = body::json(&headers, &body)?;
    let DescribeMeasurement { name, machine, axis, operator, measured_at, labels } = change;
    let change = Redescribed { name, machine, axis, operator, measured_at, labels };
    Ok(Json(service.describe_measurement(&id, change).await?.into()))
}
