//! `/v1/jobs/{id}/events`.

use std::convert::Infallible;
use std::time::Duration;

use axum::Extension;
use axum::extract::Path;
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::StreamExt;
use serde::Serialize;

use crate::service::{JobEvent, Service};

use super::problem::Problem;
use super::views::JobView;

/// How often a silent stream says that it is alive: proxies close those that do
/// not within a minute.
const KEEP_ALIVE: Duration = Duration::from_secs(15);

/// What happens to a job, as server-sent events.
///
/// `convergence` (a row of history) and `end` (the job, once) are numbered from 1
/// and repeated after `Last-Event-ID`; `status` (the job as it stands) has no
/// number. The stream closes after `end`, and without it when the server stops.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/events", tag = "jobs", operation_id = "follow_job",
    params(
        ("id" = String, Path, description = "Id of the job"),
        ("Last-Event-ID" = Option<u32>, Header, maximum = 2_147_483_647,
         description = "Number of the last event that was seen"),
    ),
    responses(
        (status = 200, body = String, content_type = "text/event-stream"),
        (status = 204, description = "`end` was seen; nothing follows"),
        (status = "4XX", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(super) async fn follow(
    Extension(service): Extension<Service>,
    Path(id): Path<String>,
    headers: HeaderMap,
) -> Result<Response, Box<Problem>> {
    let after = last_event(&headers)?;
    let Some(events) = service.events(&id, after).await? else {
        return Ok(StatusCode::NO_CONTENT.into_response());
    };
    let events = events.map(|happened| Ok::<_, Infallible>(event(happened)));
    let alive = KeepAlive::new().interval(KEEP_ALIVE);
    // A proxy that collects an answer before it passes it on would hold it all back.
    let unbuffered =
        [(HeaderName::from_static("x-accel-buffering"), HeaderValue::from_static("no"))];
    Ok((unbuffered, Sse::new(events).keep_alive(alive)).into_response())
}

fn last_event(headers: &HeaderMap) -> Result<i64, Box<Problem>> {
    let Some(value) = headers.get("last-event-id") else { return Ok(0) };
    let number = value.to_str().ok().and_then(|text| text.trim().parse::<u32>().ok());
    number.map(i64::from).ok_or_else(|| {
        let detail = "`Last-Event-ID` must be the `id` of an event of this job, a whole number; leave it \
                      out to start from the first event";
        Problem::of_status(StatusCode::BAD_REQUEST, detail)
    })
}

fn event(happened: JobEvent) -> Event {
    match happened {
        JobEvent::Changed(job) => with_data(Event::default().event("status"), JobView::from(*job)),
        JobEvent::Row { number, row } => {
            with_data(Event::default().event("convergence").id(number.to_string()), row)
        }
        JobEvent::Ended { number, job } => {
            let event = Event::default().event("end").id(number.to_string());
            with_data(event, JobView::from(*job))
        }
    }
}

fn with_data(event: Event, data: impl Serialize) -> Event {
    // Numbers and text only: it cannot fail.
    event.clone().json_data(data).unwrap_or(event)
}
