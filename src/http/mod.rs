//! The service over HTTP: requests in, views and problem documents out.
//!
//! `routes` is the whole interface as one list, which feeds the router and the
//! OpenAPI document. A handler extracts, calls the service and maps to a view.

mod body;
mod cached;
mod health;
mod jobs;
mod layers;
mod measurements;
mod plots;
mod problem;
mod report;
mod routes;
mod server;
#[cfg(test)]
mod tests;
mod validations;
mod views;

use axum::Router;

use crate::service::Service;

pub use routes::openapi;
pub use server::serve;

/// The whole service: every route, and what surrounds them. Bodies larger than
/// `max_upload_bytes`, as sent or unpacked, are refused.
pub fn app(service: Service, max_upload_bytes: usize) -> Router {
    let (router, _) = routes::list().split_for_parts();
    layers::around(router.with_state(service), max_upload_bytes)
}
