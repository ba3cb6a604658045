//! The service over HTTP: requests in, views and problem documents out.
//!
//! `routes` is the whole interface as one list, which feeds the router and the
//! OpenAPI document. A handler extracts, calls the service and maps to a view.

mod access;
mod answer;
mod axes;
mod batches;
mod body;
mod cached;
mod callers;
mod connections;
mod dashboard;
mod descriptions;
mod document;
mod events;
mod exports;
mod flat;
mod gate;
mod given;
mod health;
mod inspections;
mod jobs;
mod keys;
mod layers;
mod lists;
mod mappings;
mod measurements;
mod memory;
mod nul;
mod plans;
mod plots;
mod previews;
mod problem;
mod query;
mod rates;
mod readings;
mod report;
mod results;
mod routes;
mod server;
mod sessions;
mod shares;
#[cfg(test)]
mod tests;
mod unpacking;
mod uploads;
mod validations;
mod views;
mod webhooks;

use axum::Router;
use utoipa_swagger_ui::{Config, SwaggerUi};

use crate::service::Service;

pub use body::Pace;
pub use callers::{Callers, is_of_loopback};
pub use routes::openapi;
pub use server::{Keeping, serve};

/// What the service lets in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Limits {
    /// Largest body as sent, bytes.
    pub sent_bytes: usize,
    /// Largest body once unpacked, bytes: a few kilobytes of gzip can stand for
    /// megabytes.
    pub unpacked_bytes: usize,
    /// Memory for the bodies of all requests together, bytes.
    pub bodies_bytes: usize,
    /// How fast a body must come.
    pub pace: Pace,
    /// Who may send requests.
    pub callers: Callers,
    /// Whether requests need a key also while none is stored.
    pub keys_always: bool,
}

/// What an operator watches of a process that serves nothing else: `/livez`, `/readyz`, `/metrics`.
pub fn watched(service: Service, keys_always: bool) -> Router {
    let limits = Limits {
        sent_bytes: 0,
        unpacked_bytes: 0,
        bodies_bytes: 0,
        pace: Pace::default(),
        callers: Callers { any_host: keys_always, ..Callers::default() },
        keys_always,
    };
    let (router, _) = routes::watched().split_for_parts();
    layers::around(router, service, limits)
}

/// The whole service: every route, and what surrounds them.
pub fn app(service: Service, limits: Limits) -> Router {
    let (router, _) = routes::list().split_for_parts();
    let documents = SwaggerUi::new("/docs").config(Config::from("/openapi.json"));
    let router = router.merge(routes::pages()).merge(documents);
    layers::around(router, service, limits)
}
