//! Measurements and answers as tables for other programs, and a figure.

use axum::Extension;
use axum::extract::Path;
use axum::http::HeaderMap;
use axum::response::Response;

use crate::service::Service;

use super::cached;
use super::problem::Problem;

const CSV: &str = "text/csv; charset=utf-8";
const JSON: &str = "application/json";
const SVG: &str = "image/svg+xml";

/// Declares the handler of a table that a client may keep: `service` is the method of
/// [`Service`] that makes it of an id, and the rest is what the document says of it.
macro_rules! export {
    (
        $(#[$doc:meta])+
        $handler:ident,
        path: $path:literal,
        tag: $tag:literal,
        operation: $operation:literal,
        id: $of_what:literal,
        service: $make:ident -> $media_type:ident,
        body: $body:ty as $documented_type:literal,
        unchanged: $unchanged:literal
    ) => {
        $(#[$doc])+
        #[utoipa::path(
            get, path = $path, tag = $tag, operation_id = $operation,
            params(
                ("id" = String, Path, description = $of_what),
                ("If-None-Match" = Option<String>, Header,
                 description = "`ETag` of an earlier answer"),
            ),
            responses(
                (status = 200, body = $body, content_type = $documented_type),
                (status = 304, description = $unchanged),
                (status = "4XX", body = Problem, content_type = "application/problem+json"),
            )
        )]
        pub(super) async fn $handler(
            Extension(service): Extension<Service>,
            Path(id): Path<String>,
            headers: HeaderMap,
        ) -> Result<Response, Box<Problem>> {
            Ok(cached::answer(&headers, $media_type, service.$make(&id).await?, true))
        }
    };
}

export! {
    /// The data of a measurement as a harmonic table, which can be uploaded again.
    ///
    /// Units are in the lines before the header, and in the names of the columns.
    /// Records are given as the harmonics that were computed from them.
    measurement_csv,
    path: "/v1/measurements/{id}/data.csv",
    tag: "measurements",
    operation: "get_measurement_csv",
    id: "Id of the measurement",
    service: measurement_csv -> CSV,
    body: String as "text/csv",
    unchanged: "The data are what `If-None-Match` names"
}

export! {
    /// The same as JSON.
    measurement_json,
    path: "/v1/measurements/{id}/data.json",
    tag: "measurements",
    operation: "get_measurement_json",
    id: "Id of the measurement",
    service: measurement_json -> JSON,
    body: Object as "application/json",
    unchanged: "The data are what `If-None-Match` names"
}

export! {
    /// What was measured as an SVG: gain and phase over frequency, and one period of records over
    /// time.
    measurement_figure,
    path: "/v1/measurements/{id}/measured.svg",
    tag: "measurements",
    operation: "get_measurement_figure",
    id: "Id of the measurement",
    service: measurement_figure -> SVG,
    body: String as "image/svg+xml",
    unchanged: "The figure is the one that `If-None-Match` names"
}

export! {
    /// The parameters of a result, one row each with its interval and unit.
    parameters_csv,
    path: "/v1/jobs/{id}/parameters.csv",
    tag: "jobs",
    operation: "get_parameters_csv",
    id: "Id of the job",
    service: parameters_csv -> CSV,
    body: String as "text/csv",
    unchanged: "The table is what `If-None-Match` names"
}

export! {
    /// Measured and simulated harmonics of a result, units in the header.
    ///
    /// `std_estimated` is 1 where `std` is estimated from the residual, and 0 where the upload or
    /// its repeats tell it.
    comparison_csv,
    path: "/v1/jobs/{id}/comparison.csv",
    tag: "jobs",
    operation: "get_comparison_csv",
    id: "Id of the job",
    service: comparison_csv -> CSV,
    body: String as "text/csv",
    unchanged: "The table is what `If-None-Match` names"
}
