//! What surrounds every route: limits, problem documents, log, compression.

use std::any::Any;
use std::sync::Arc;
use std::time::Instant;

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::{DefaultBodyLimit, MatchedPath, Request, State};
use axum::http::{HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::{Next, from_fn, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::cors::CorsLayer;
use tower_http::request_id::{MakeRequestUuid, PropagateRequestIdLayer, SetRequestIdLayer};
use tower_http::trace::{DefaultOnResponse, TraceLayer};
use tracing::field::Empty;
use tracing::{Level, Span, info_span};

use crate::service::Service;

use super::access::Needs;
use super::gate::{self, Gate};
use super::memory::Memory;
use super::problem::{MEDIA_TYPE, Problem};
use super::rates::Rates;
use super::server::Reserved;
use super::{Limits, body, dashboard, nul, routes, unpacking};

/// The longest text of a foreign error that is taken into a problem document.
const DETAIL_BYTES: usize = 4096;

/// What data may do in a browser: nothing.
const DATA_POLICY: &str = "default-src 'none'; frame-ancestors 'none'";

/// What the page of the interface needs: its own files, and pictures that are in its style sheet.
const DOCS_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; \
                           img-src 'self' data:; connect-src 'self'; base-uri 'none'; \
                           form-action 'none'; frame-ancestors 'none'";

/// Routes that answer however full the server is.
pub(super) const WATCHED: [&str; 3] = ["/livez", "/readyz", "/metrics"];

/// The methods that are counted by their names.
const METHODS: [Method; 7] = [
    Method::GET,
    Method::HEAD,
    Method::POST,
    Method::PUT,
    Method::PATCH,
    Method::DELETE,
    Method::OPTIONS,
];

/// Surrounds the routes; the last layer sees a request first.
pub(super) fn around(router: Router, service: Service, limits: Limits) -> Router {
    let Limits { sent_bytes, unpacked_bytes, pace, callers, .. } = limits;
    let (rates, always) = (Arc::new(Rates::default()), limits.keys_always);
    let needs = Arc::new(Needs::of(&routes::openapi()));
    let gate = Gate { service: service.clone(), needs, rates, always };
    let reading = Memory::new(limits.bodies_bytes, sent_bytes.saturating_add(unpacked_bytes));
    let unpacking = reading.clone();
    let origins = callers.origins.clone();
    let router = router
        .layer(DefaultBodyLimit::max(unpacked_bytes))
        .layer(from_fn(move |request: Request, next: Next| {
            let memory = unpacking.clone();
            async move { unpacking::unpacked(request, next, unpacked_bytes, &memory).await }
        }))
        .layer(CatchPanicLayer::custom(panicked))
        .layer(from_fn(move |request: Request, next: Next| {
            let memory = reading.clone();
            async move { body::whole(request, next, sent_bytes, pace, &memory).await }
        }))
        .layer(from_fn(move |request: Request, next: Next| {
            problems_only(request, next, [sent_bytes, unpacked_bytes])
        }))
        .layer(from_fn(nul::refused))
        // Before a body is read: a stranger's is not, but for what has been sent by then.
        .layer(from_fn_with_state(gate, gate::admit))
        .layer(from_fn(room))
        .layer(from_fn(move |request: Request, next: Next| callers.clone().admit(request, next)))
        .layer(from_fn(guarded))
        .layer(CompressionLayer::new())
        .layer(PropagateRequestIdLayer::x_request_id())
        .layer(from_fn_with_state(service, counted))
        .layer(
            TraceLayer::new_for_http()
                .make_span_with(span)
                .on_response(DefaultOnResponse::new().level(Level::INFO)),
        )
        .layer(SetRequestIdLayer::x_request_id(MakeRequestUuid));
    // Without it no page from elsewhere can read an answer.
    if origins.is_empty() { router } else { router.layer(cross_origin(origins)) }
}

/// What a browser may make of an answer, unless its route says it.
///
/// Answers are data: no page may be made of them, nor around them, no page of another origin may
/// embed them, and nobody learns from a link in one where it was. The page at `/docs` is another
/// program's.
async fn guarded(request: Request, next: Next) -> Response {
    let policy = if request.uri().path().starts_with("/docs") { DOCS_POLICY } else { DATA_POLICY };
    let mut response = next.run(request).await;
    let headers = response.headers_mut();
    for (name, value) in [
        (header::CONTENT_SECURITY_POLICY, policy),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ] {
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    }
    response
}

/// Refuses what comes on a connection beyond the limit, but for what an operator watches.
async fn room(request: Request, next: Next) -> Response {
    let watched = WATCHED.contains(&request.uri().path());
    if request.extensions().get::<Reserved>().is_none() {
        return next.run(request).await;
    }
    let mut response = if watched {
        next.run(request).await
    } else {
        let detail = "all connections of the server are in use; send the request again in some seconds \
                      (the operator can raise `max_connections`)";
        Problem::of_status(StatusCode::SERVICE_UNAVAILABLE, detail).into_response()
    };
    let close = HeaderValue::from_static("close");
    response.headers_mut().insert(header::CONNECTION, close);
    response
}

fn cross_origin(origins: Vec<HeaderValue>) -> CorsLayer {
    let name = HeaderName::from_static;
    CorsLayer::new()
        .allow_origin(origins)
        .allow_methods([Method::GET, Method::POST, Method::PUT, Method::PATCH, Method::DELETE])
        .allow_headers([
            header::AUTHORIZATION,
            header::CONTENT_TYPE,
            header::IF_NONE_MATCH,
            name("idempotency-key"),
            name("last-event-id"),
            name("x-request-id"),
        ])
        .expose_headers([header::ETAG, header::LOCATION, header::RETRY_AFTER, name("x-request-id")])
}

/// Counts what was answered, by route and status.
async fn counted(State(service): State<Service>, request: Request, next: Next) -> Response {
    let began = Instant::now();
    // Anybody can make methods up, and each would be a series for ever.
    let method = METHODS.iter().find(|known| *known == request.method());
    let method = method.map_or("other", Method::as_str);
    let route = request.extensions().get::<MatchedPath>().cloned();
    let response = next.run(request).await;
    let route = route.as_ref().map_or("none", MatchedPath::as_str);
    let status = response.status().as_u16();
    service.metrics().answered(method, route, status, began.elapsed());
    response
}

fn span<B>(request: &axum::http::Request<B>) -> Span {
    let id = request.headers().get("x-request-id").and_then(|id| id.to_str().ok());
    let (method, path) = (request.method(), request.uri().path());
    // The gate says whose key it is.
    info_span!("request", %method, path, id, key = Empty)
}

#[expect(clippy::needless_pass_by_value, reason = "the signature is that of a panic handler")]
fn panicked(payload: Box<dyn Any + Send + 'static>) -> axum::http::Response<Body> {
    let text = payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("a panic without text");
    let status = StatusCode::INTERNAL_SERVER_ERROR;
    Problem::internal(status, "an internal error stopped the request", &text).into_response()
}

/// Turns every error that is not a problem document into one: those of the
/// router, of extractors and of other layers.
async fn problems_only(request: Request, next: Next, max_bytes: [usize; 2]) -> Response {
    let method = request.method().clone();
    let path = request.uri().path().to_owned();
    let of_browser = dashboard::is_page(&request);
    let response = next.run(request).await;
    let status = response.status();
    let media_type = response.headers().get(header::CONTENT_TYPE);
    let is_error = status.is_client_error() || status.is_server_error();
    if !is_error || media_type.is_some_and(|value| value == MEDIA_TYPE) {
        return response;
    }
    if status == StatusCode::NOT_FOUND && of_browser {
        return dashboard::unknown_page().into_response();
    }
    let (parts, body) = response.into_parts();
    let text = to_bytes(body, DETAIL_BYTES).await.unwrap_or_default();
    let detail = match status {
        StatusCode::NOT_FOUND => {
            format!("nothing is served at `{path}`; `/openapi.json` lists what is")
        }
        StatusCode::METHOD_NOT_ALLOWED => {
            format!("`{path}` does not answer {method}; the header `Allow` says what it does")
        }
        StatusCode::PAYLOAD_TOO_LARGE => body::too_large(max_bytes),
        StatusCode::UNSUPPORTED_MEDIA_TYPE if text.is_empty() => {
            "of the encodings of a body (`Content-Encoding`) only gzip is unpacked here".to_owned()
        }
        _ => String::from_utf8_lossy(&text).into_owned(),
    };
    let mut response = Problem::of_status(status, detail).into_response();
    // `Allow` and the like stay; what described the replaced body does not.
    for (name, value) in &parts.headers {
        if !matches!(*name, header::CONTENT_TYPE | header::CONTENT_LENGTH) {
            response.headers_mut().insert(name, value.clone());
        }
    }
    response
}
