//! Every route, in one list.

use axum::Router;
use axum::routing::get;
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::{
    access, axes, batches, dashboard, descriptions, document, events, exports, health, inspections,
    jobs, keys, mappings, measurements, plans, plots, previews, readings, report, results,
    sessions, validations, webhooks,
};

#[derive(OpenApi)]
#[openapi(
    info(
        title = "servoscope",
        description = "From the measured frequency response of a servo axis to its transfer \
                       function and friction. Every error is a problem document (RFC 9457)."
    ),
    tags(
        (name = "measurements", description = "Measured data"),
        (name = "plans", description = "Experiments planned before measuring"),
        (name = "mappings", description = "Stored settings for reading files of one layout"),
        (name = "jobs", description = "Identifications and diagnoses"),
        (name = "batches", description = "Jobs for many measurements"),
        (name = "axes", description = "Results of an axis over time"),
        (name = "webhooks", description = "Webhooks"),
        (name = "keys", description = "API keys"),
        (name = "service", description = "The service itself"),
    )
)]
struct Document;

/// The routes, and with them the document that describes them.
pub(super) fn list() -> OpenApiRouter {
    OpenApiRouter::with_openapi(Document::openapi())
        .routes(routes!(measurements::add, measurements::list))
        .routes(routes!(previews::preview))
        .routes(routes!(mappings::list))
        .routes(routes!(mappings::get, mappings::put, mappings::delete))
        .routes(routes!(mappings::toml))
        .routes(routes!(measurements::get, descriptions::describe, measurements::delete))
        .routes(routes!(readings::read_again))
        .routes(routes!(readings::preview))
        .routes(routes!(exports::measurement_csv))
        .routes(routes!(exports::measurement_json))
        .routes(routes!(inspections::get))
        .routes(routes!(exports::measurement_figure))
        .routes(routes!(plans::create))
        .routes(routes!(plans::excitation))
        .routes(routes!(plans::figure))
        .routes(routes!(jobs::submit, jobs::list))
        .routes(routes!(jobs::get, jobs::delete))
        .routes(routes!(results::get))
        .routes(routes!(results::convergence))
        .routes(routes!(results::convergence_csv))
        .routes(routes!(events::follow))
        .routes(routes!(exports::parameters_csv))
        .routes(routes!(exports::comparison_csv))
        .routes(routes!(plots::get))
        .routes(routes!(report::get))
        .routes(routes!(jobs::cancel))
        .routes(routes!(batches::submit, batches::list))
        .routes(routes!(batches::get, batches::delete))
        .routes(routes!(batches::results))
        .routes(routes!(batches::results_csv))
        .routes(routes!(batches::cancel))
        .routes(routes!(validations::create))
        .routes(routes!(axes::results_json))
        .routes(routes!(axes::results_csv))
        .routes(routes!(axes::list))
        .routes(routes!(axes::history_json))
        .routes(routes!(axes::history_csv))
        .routes(routes!(axes::history_svg))
        .routes(routes!(webhooks::add, webhooks::list))
        .routes(routes!(webhooks::get, webhooks::delete))
        .routes(routes!(webhooks::test))
        .routes(routes!(webhooks::deliveries))
        .routes(routes!(keys::add, keys::list))
        .routes(routes!(keys::get, keys::revoke))
        .routes(routes!(keys::rotate))
        .routes(routes!(keys::limit))
        .routes(routes!(sessions::sign_in, sessions::get, sessions::sign_out))
        .merge(watched())
        .routes(routes!(health::document))
}

/// The routes that an operator watches.
pub(super) fn watched() -> OpenApiRouter {
    OpenApiRouter::new()
        .routes(routes!(health::live))
        .routes(routes!(health::ready))
        .routes(routes!(health::metrics))
}

/// The pages for people, not for programs: they are not in the document.
pub(super) fn pages() -> Router {
    access::PAGES.into_iter().fold(Router::new(), |router, path| match path {
        "/assets/{file}" => router.route(path, get(dashboard::asset)),
        page => router.route(page, get(dashboard::page)),
    })
}

/// The OpenAPI document of the service.
pub fn openapi() -> utoipa::openapi::OpenApi {
    let mut document = list().into_openapi();
    document::teach(&mut document);
    document
}
