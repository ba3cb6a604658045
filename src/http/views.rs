//! Resources as a client sees them.

mod jobs;
mod measurements;

use serde::Serialize;
use utoipa::ToSchema;

use crate::service::Listed;
use crate::store::{AxisRow, Millis};

pub(super) use jobs::{Convergence, JobStatus, JobView, PriorityView, SubmitJob};
pub(super) use measurements::{MeasurementView, SignalView};

/// A page of a list.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct List<T> {
    /// The items.
    items: Vec<T>,
    /// `cursor` of the next page; null after the last one.
    next: Option<String>,
}

impl<T> List<T> {
    pub(super) fn new<S: Into<T>>(listed: Listed<S>) -> Self {
        Self { items: listed.items.into_iter().map(Into::into).collect(), next: listed.next }
    }
}

/// An axis that measurements name.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Axis {
    /// The machine.
    machine: String,
    /// The axis.
    axis: String,
    /// Measurements of it.
    measurements: i64,
    /// Those of them with a result.
    results: i64,
    /// When it was first measured (RFC 3339). If an upload does not state its time, the time of
    /// upload counts.
    first_at: Option<String>,
    /// When it was last measured.
    last_at: Option<String>,
}

impl From<AxisRow> for Axis {
    fn from(row: AxisRow) -> Self {
        Self {
            machine: row.machine,
            axis: row.axis,
            measurements: row.measurements,
            results: row.results,
            first_at: rfc3339(row.first_ms),
            last_at: rfc3339(row.last_ms),
        }
    }
}

pub(super) fn rfc3339(millis: Millis) -> Option<String> {
    jiff::Timestamp::from_millisecond(millis).ok().map(|time| time.to_string())
}
