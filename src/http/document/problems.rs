//! Which problems an operation may answer with.

use std::collections::BTreeMap;

use serde_json::json;
use utoipa::openapi::example::ExampleBuilder;
use utoipa::openapi::path::{Operation, Parameter, ParameterIn};
use utoipa::openapi::{ContentBuilder, Ref, RefOr, ResponseBuilder};

use super::Effect;
use crate::http::access::{Need, need};
use crate::http::problem::MEDIA_TYPE;

/// A problem: its status, its type, its title and what it may say. A type that is empty is
/// `about:blank`: the status says everything.
struct Kind {
    status: u16,
    kind: &'static str,
    title: &'static str,
    detail: &'static str,
}

const fn kind(status: u16, kind: &'static str, title: &'static str, detail: &'static str) -> Kind {
    Kind { status, kind, title, detail }
}

const BAD_REQUEST: Kind =
    kind(400, "", "Bad Request", "the body ends early: the connection was closed");
const BAD_QUERY: Kind =
    kind(400, "invalid-request", "Invalid request", "limit: it is not a whole number from 0 on");
const NUL: Kind = kind(
    400,
    "",
    "Bad Request",
    "the address has the character NUL (`%00`), which no name or text here has; leave it out",
);
const MALFORMED: Kind =
    kind(400, "malformed-json", "Malformed JSON", "the body is not JSON: expected value");
const NO_KEY: Kind = kind(
    401,
    "no-key",
    "A key is needed",
    "this server asks for a key; send a key as `Authorization: Bearer sk_servoscope_…`, or sign in; \
     whoever operates the server makes one with `servoscope keys add`",
);
const MISSING_SCOPE: Kind = kind(
    403,
    "missing-scope",
    "The key lacks a scope",
    "the key `rig 7` lacks the scope `admin`; it has `upload`, `run`, `read`",
);
const FOREIGN: Kind = kind(
    403,
    "",
    "Forbidden",
    "a page of another origin may not change anything here; start the server with `--cors-origin \
     https://bench.example` if that page is to use it",
);
const UNKNOWN: Kind = kind(404, "unknown", "No such resource", "there is no measurement `nobody`");
const NO_RESULT: Kind = kind(
    404,
    "no-result",
    "No result",
    "job `01a2` was cancelled and has no result; submit it again with `POST /v1/jobs`",
);
const NO_PLOT: Kind = kind(
    404,
    "no-plot",
    "No such plot",
    "job `01a2` has no plot `pie`: it is unknown; available: bode, residuals",
);
const NOT_FINISHED: Kind = kind(
    409,
    "not-finished",
    "No result yet",
    "job `01a2` is running, it has no result yet; ask `GET /v1/jobs/01a2?wait=30` until its status \
     is `succeeded`",
);
const HAS_JOBS: Kind = kind(
    409,
    "has-jobs",
    "Measurement has jobs",
    "measurement `01a2` has jobs, whose results depend on how its files were read; delete them with \
     `DELETE /v1/jobs/{id}`, or upload the files again with `POST /v1/measurements` for another \
     reading of them",
);
const ENDED: Kind = kind(
    409,
    "already-ended",
    "Already ended",
    "job `01a2` has already succeeded; there is nothing to cancel",
);
const TOO_SLOW: Kind = kind(
    408,
    "",
    "Request Timeout",
    "the body came too slowly: a client that sends may pause for 30 seconds at most, and must send 500 \
     bytes a second on average",
);
const TOO_LARGE: Kind =
    kind(413, "", "Payload Too Large", "the body is larger than 67108864 bytes as sent");
const NOT_READ: Kind =
    kind(415, "", "Unsupported Media Type", "`image/png` is not read here; send application/json");
const UNREADABLE: Kind = kind(
    422,
    "unreadable-measurement",
    "Unreadable measurement",
    "axis.csv, line 4, column gain: `two` is not a number",
);
const INVALID: Kind = kind(
    422,
    "invalid-request",
    "Invalid request",
    "options.noise_std: -1 is not a positive number",
);
const KEY_REUSED: Kind = kind(
    422,
    "idempotency-key-reused",
    "Idempotency key reused",
    "the idempotency key `7` was used before for another request; use a new key",
);
const TOO_COSTLY: Kind = kind(
    422,
    "too-costly",
    "Too costly",
    "it would compute about 9 hours on one processor, more than the 60 minutes that a job may",
);
const OVER_QUOTA: Kind = kind(
    429,
    "over-quota",
    "Quota exceeded",
    "the key `rig 7` may have 100 jobs that wait or run (`--key-jobs`), and this job would exceed it; wait \
     for others to finish",
);
const UNINSPECTED: Kind = kind(
    422,
    "uninspected",
    "Measurement cannot be inspected",
    "the measurement cannot be inspected: it has no experiment",
);
const INTERNAL: Kind = kind(
    500,
    "internal",
    "Internal error",
    "an internal error stopped the request; tell the operator of the server the `reference` of \
     this answer, which finds the cause in the log",
);
const NO_DATABASE: Kind = kind(
    503,
    "internal",
    "Internal error",
    "the database does not answer as it should; tell the operator of the server the `reference` of \
     this answer, which finds the cause in the log",
);
const BUSY: Kind = kind(
    503,
    "",
    "Service Unavailable",
    "all connections of the server are in use; send the request again in some seconds (the operator can \
     raise `max_connections`)",
);
const NO_ROOM: Kind = kind(
    507,
    "internal",
    "Internal error",
    "the disk is full, or the database as large as it may be; tell the operator of the server the `reference` of \
     this answer, which finds the cause in the log",
);

/// The problems of single operations.
const OWN: &[(&str, &[&Kind])] = &[
    ("add_measurement", &[&UNREADABLE, &INVALID, &KEY_REUSED]),
    ("preview_measurement", &[&INVALID]),
    ("read_again", &[&UNREADABLE, &HAS_JOBS]),
    ("get_measurement_csv", &[&UNREADABLE]),
    ("get_measurement_json", &[&UNREADABLE]),
    ("get_measurement_figure", &[&UNREADABLE]),
    ("inspect_measurement", &[&UNREADABLE, &UNINSPECTED, &TOO_COSTLY]),
    ("list_measurements", &[&INVALID]),
    ("list_jobs", &[&INVALID]),
    ("submit_job", &[&UNKNOWN, &KEY_REUSED, &TOO_COSTLY]),
    ("submit_batch", &[&UNKNOWN, &KEY_REUSED, &TOO_COSTLY]),
    ("list_batches", &[&INVALID]),
    ("list_batch_results", &[&INVALID]),
    ("get_result", &[&NOT_FINISHED, &NO_RESULT]),
    ("get_parameters_csv", &[&NOT_FINISHED, &NO_RESULT]),
    ("get_comparison_csv", &[&NOT_FINISHED, &NO_RESULT, &NO_PLOT, &UNREADABLE]),
    ("get_plot", &[&NOT_FINISHED, &NO_RESULT, &NO_PLOT]),
    ("get_report", &[&NOT_FINISHED, &NO_RESULT]),
    ("cancel_job", &[&ENDED]),
    ("follow_job", &[&BAD_REQUEST]),
    ("validate", &[&UNKNOWN, &NOT_FINISHED, &NO_RESULT, &UNREADABLE, &TOO_COSTLY]),
    ("get_history_figure", &[&UNKNOWN]),
    ("rotate_key", &[&INVALID]),
    ("sign_in", &[&NO_KEY]),
    ("plan", &[&UNKNOWN, &NOT_FINISHED, &NO_RESULT, &TOO_COSTLY]),
    ("plan_excitation", &[&UNKNOWN, &NOT_FINISHED, &NO_RESULT, &TOO_COSTLY]),
    ("plan_figure", &[&UNKNOWN, &NOT_FINISHED, &NO_RESULT, &TOO_COSTLY]),
];

/// Puts every status of an error, with its types of problem, in place of what the handlers say.
pub(super) fn declare(path: &str, effect: &Effect, operation: &mut Operation) {
    let responses = &mut operation.responses.responses;
    let is_error = |status: &str| status.starts_with(['4', '5']);
    let said = responses.iter().find_map(|(status, response)| match response {
        RefOr::T(response) if is_error(status) => Some(response.description.clone()),
        _ => None,
    });
    responses.retain(|status, _| !is_error(status));
    let mut by_status: BTreeMap<u16, Vec<&Kind>> = BTreeMap::new();
    for kind in kinds(path, effect, operation) {
        let known = by_status.entry(kind.status).or_default();
        if known.iter().all(|other| other.kind != kind.kind) {
            known.push(kind);
        }
    }
    // What a handler says of its errors is not of a single status.
    if let Some(said) = said.filter(|said| !said.is_empty()) {
        let more = operation.description.get_or_insert_default();
        let gap = if more.is_empty() { "" } else { "\n\n" };
        more.push_str(&format!("{gap}Errors: {said}."));
    }
    for (status, kinds) in by_status {
        let response = response(&kinds);
        operation.responses.responses.insert(status.to_string(), RefOr::T(response));
    }
}

fn kinds(path: &str, effect: &Effect, operation: &Operation) -> Vec<&'static Kind> {
    let id = operation.operation_id.as_deref().unwrap_or_default();
    let mut kinds: Vec<&Kind> = match need(id) {
        Some(Need::Scope(_)) => vec![&NO_KEY, &MISSING_SCOPE, &OVER_QUOTA],
        Some(Need::Key) => vec![&NO_KEY, &OVER_QUOTA],
        Some(Need::Nothing) if matches!(id, "sign_in" | "openapi_document") => vec![&OVER_QUOTA],
        Some(Need::Nothing) | None => Vec::new(),
    };
    if matches!(id, "ready" | "metrics") {
        kinds.push(&NO_DATABASE);
    }
    if !path.starts_with("/v1/") {
        return kinds;
    }
    let parameters = operation.parameters.iter().flatten();
    let has = |place: ParameterIn| {
        let mut places = parameters.clone().filter_map(|parameter| match parameter {
            RefOr::T(Parameter { parameter_in, .. }) => Some(parameter_in),
            RefOr::Ref(_) => None,
        });
        places.any(|of| *of == place)
    };
    kinds.extend([&INTERNAL, &NO_DATABASE, &BUSY]);
    if has(ParameterIn::Path) && id != "put_mapping" {
        kinds.push(&UNKNOWN);
    }
    if has(ParameterIn::Query) {
        kinds.push(&BAD_QUERY);
    }
    if has(ParameterIn::Path) || has(ParameterIn::Query) {
        kinds.push(&NUL);
    }
    if let Some(RefOr::T(body)) = &operation.request_body {
        kinds.extend([&BAD_REQUEST, &TOO_SLOW, &TOO_LARGE, &NOT_READ]);
        if body.content.len() == 1 {
            kinds.extend([&MALFORMED, &INVALID]);
        }
    }
    if matches!(effect, Effect::Writes) {
        kinds.extend([&NO_ROOM, &FOREIGN]);
    }
    let own = OWN.iter().find(|(of, _)| *of == id);
    kinds.extend(own.into_iter().flat_map(|(_, own)| own.iter().copied()));
    kinds
}

fn response(kinds: &[&Kind]) -> utoipa::openapi::Response {
    let mut content = ContentBuilder::new().schema(Some(Ref::from_schema_name("Problem")));
    let mut titles: Vec<&str> = Vec::new();
    for Kind { status, kind, title, detail } in kinds {
        let (name, kind) = match *kind {
            "" => ("about-blank", "about:blank".to_owned()),
            kind => (kind, format!("urn:servoscope:problem:{kind}")),
        };
        let value = json!({"type": kind, "title": title, "status": status, "detail": detail});
        let example =
            ExampleBuilder::new().summary(format!("{title}: `{kind}`")).value(Some(value));
        content = content.examples_from_iter([(name, example.build())]);
        titles.push(title);
    }
    ResponseBuilder::new()
        .description(titles.join("; "))
        .content(MEDIA_TYPE, content.build())
        .build()
}
