//! `/v1/mappings`: what is given beside files of one layout, under a name.

use std::collections::BTreeMap;

use axum::body::Bytes;
use axum::extract::Path;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Extension, Json};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;
use utoipa::openapi::schema::{ObjectBuilder, Schema, Type};

use crate::service::{Listed, Mapping, Service};

use super::body;
use super::problem::Problem;
use super::views::{List, rfc3339};

const TOML: &str = "application/toml";

/// A mapping to be stored.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct PutMapping {
    #[schema(schema_with = settings)]
    settings: BTreeMap<String, String>,
    /// `layout` of a preview: files of this layout are read with the mapping by itself where they
    /// cannot be read without it. Left out: it is used by its name alone.
    layout: Option<String>,
}

/// The settings of a mapping to be stored.
fn settings() -> Schema {
    let settings = ObjectBuilder::new().description(Some(
        "What is given beside a file, by the names of the fields of an upload: `column_names`, \
         `response`, `magnitude` …",
    ));
    let text = ObjectBuilder::new().schema_type(Type::String);
    settings.additional_properties(Some(text)).min_properties(Some(1)).build().into()
}

/// A stored mapping.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Mapping)]
pub(super) struct MappingView {
    /// Its name.
    name: String,
    /// What is given beside a file.
    settings: BTreeMap<String, String>,
    /// Layout of the files that it is used for automatically; null: it is used by its name alone.
    layout: Option<String>,
    /// When it was last stored, RFC 3339.
    updated_at: Option<String>,
}

impl From<Mapping> for MappingView {
    fn from(Mapping { name, settings, layout, updated_at_ms }: Mapping) -> Self {
        Self { name, settings, layout, updated_at: rfc3339(updated_at_ms) }
    }
}

/// Stores a mapping under a name, in place of one that has it.
#[utoipa::path(
    put, path = "/v1/mappings/{name}", tag = "mappings", operation_id = "put_mapping",
    params(("name" = String, Path, min_length = 1, max_length = 64, pattern = r"^[^\W_][\w .-]*$",
            description = "1 to 64 letters (of any script), digits, blanks, `-`, `_` and `.` that \
                           begin with a letter or a digit")),
    request_body = PutMapping,
    responses(
        (status = 200, body = MappingView, description = "It has taken the place of another"),
        (status = 201, body = MappingView, description = "It is new"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn put(
    Extension(service): Extension<Service>,
    Path(name): Path<String>,
    headers: HeaderMap,
    body: Bytes,
) -> Result<Response, Box<Problem>> {
    let PutMapping { settings, layout } = body::json(&headers, &body)?;
    let stored = service.put_mapping(&name, settings, layout).await?;
    let status = if stored.replayed { StatusCode::OK } else { StatusCode::CREATED };
    Ok((status, Json(MappingView::from(stored.resource))).into_response())
}

/// One mapping.
#[utoipa::path(
    get, path = "/v1/mappings/{name}", tag = "mappings", operation_id = "get_mapping",
    params(
        ("name" = String, Path, description = "Name of the mapping"),
        ("Accept" = Option<String>, Header,
         description = "`application/toml` asks for the file that `--mapping` of the command line \
                        reads"),
    ),
    responses(
        (status = 200, description = "The mapping",
         content((MappingView = "application/json"), (String = "application/toml"))),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn get(
    Extension(service): Extension<Service>,
    Path(name): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Box<Problem>> {
    let mapping = service.mapping(&name).await?;
    let accepted = headers.get_all(header::ACCEPT).iter().filter_map(|value| value.to_str().ok());
    if accepted.flat_map(|line| line.split(',')).any(|kind| kind.trim().starts_with(TOML)) {
        return Ok(in_toml(&mapping));
    }
    Ok(Json(MappingView::from(mapping)).into_response())
}

/// A mapping as the file that `--mapping` of the command line reads.
#[utoipa::path(
    get, path = "/v1/mappings/{name}/mapping.toml", tag = "mappings",
    operation_id = "get_mapping_toml",
    params(("name" = String, Path, description = "Name of the mapping")),
    responses(
        (status = 200, body = String, content_type = "application/toml"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn toml(
    Extension(service): Extension<Service>,
    Path(name): Path<String>,
) -> Result<Response, Box<Problem>> {
    Ok(in_toml(&service.mapping(&name).await?))
}

fn in_toml(mapping: &Mapping) -> Response {
    ([(header::CONTENT_TYPE, TOML)], mapping.toml()).into_response()
}

/// Every mapping, by name.
#[utoipa::path(
    get, path = "/v1/mappings", tag = "mappings", operation_id = "list_mappings",
    responses((status = 200, body = List<MappingView>))
)]
pub(super) async fn list(
    Extension(service): Extension<Service>,
) -> Result<Json<List<MappingView>>, Box<Problem>> {
    Ok(Json(List::new(Listed { items: service.mappings().await?, next: None })))
}

/// Removes a mapping. Measurements that were read with it stay as they are.
#[utoipa::path(
    delete, path = "/v1/mappings/{name}", tag = "mappings", operation_id = "delete_mapping",
    params(("name" = String, Path, description = "Name of the mapping")),
    responses(
        (status = 204, description = "It is gone"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn delete(
    Extension(service): Extension<Service>,
    Path(name): Path<String>,
) -> Result<StatusCode, Box<Problem>> {
    service.delete_mapping(&name).await?;
    Ok(StatusCode::NO_CONTENT)
}
