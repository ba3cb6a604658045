//! Use cases: the only place that joins storage and numerics.
//!
//! What comes in is checked here, whoever asks: the HTTP service and the command
//! line refuse the same things in the same words.

mod axes;
mod batches;
mod both;
mod caller;
mod compared;
mod connection_counts;
mod cost;
mod curves;
mod deliveries;
mod descriptions;
mod ends;
mod error;
mod events;
mod exports;
mod holders;
mod inspections;
mod jobs;
mod kept;
mod keys;
mod mappings;
mod measurements;
mod metrics;
mod notices;
mod numerics;
mod places;
mod plans;
mod plots;
mod preview;
mod quantities;
mod quotas;
mod reading;
mod readings;
mod report;
mod request;
mod results;
mod running;
mod signals;
mod spreadsheet;
#[cfg(test)]
pub(crate) mod testing;
mod token;
mod validations;
mod webhooks;

use std::sync::Arc;
use std::time::Duration;

pub use axes::HistoryQuery;
pub use batches::{Batch, BatchJob, BatchState, BatchSubmission, Counts, MAX_BATCH};
pub use caller::{Caller, Key, Scope};
pub use compared::Compared;
pub use connection_counts::{Closed, ConnectionCounts};
pub use descriptions::Redescribed;
use ends::Ends;
pub use error::ServiceError;
pub use events::JobEvent;
pub use holders::Session;
use inspections::Asked;
pub use jobs::{Failure, Job};
pub use keys::NewKey;
pub use mappings::Mapping;
pub(crate) use measurements::hexadecimal;
pub use measurements::{MAX_FILES, MAX_NAME_BYTES, MAX_POINTS, Measured, Upload};
pub use metrics::Metrics;
pub use numerics::{BuiltIn, Numerics};
use places::AllPlaces;
pub use plans::PlanFor;
pub use plots::Plot;
pub use preview::Preview;
pub use quantities::{Quantities, Quantity};
pub use quotas::{Held, Quotas};
pub use report::measured;
pub use request::{JobRequest, Submission};
pub use running::RunError;
pub use signals::Signals;
pub use spreadsheet::harmless;
pub use token::Token;
pub use webhooks::{EventType, NewWebhook, Outlets, Tested, Webhook};

use crate::store::{Reach, Store};

pub use servoscope_core::measurement::formats::{
    ColumnLook, FileLook, Lack, Look, ParseError, QUANTITIES, QuantityChoice, TableLook,
};

pub use crate::report::figures::{Format, Theme};
pub use crate::report::script::inline as page_script;

/// The most items a list returns at once.
pub const MAX_PAGE: u32 = 200;

/// A page ends with the item whose texts bring it to so many bytes: whatever was stored, a page stays
/// within some mebibytes.
const PAGE_BYTES: usize = 2 << 20;

/// One page of a list.
#[derive(Debug, Clone, PartialEq)]
pub struct Listed<T> {
    /// The items, newest first.
    pub items: Vec<T>,
    /// Where the next page begins; `None` after the last one.
    pub next: Option<String>,
}

/// What was asked for, and whether the same request was answered before.
#[derive(Debug, Clone, PartialEq)]
pub struct Added<T> {
    /// The resource.
    pub resource: T,
    /// An earlier request with the same idempotency key made it.
    pub replayed: bool,
}

/// The use cases over a store and the numeric core, for one caller: what is out of its reach is
/// not there.
#[derive(Clone)]
pub struct Service {
    store: Arc<dyn Store>,
    numerics: Arc<dyn Numerics>,
    signals: Arc<Signals>,
    metrics: Arc<Metrics>,
    asked: Arc<Asked>,
    places: Arc<AllPlaces>,
    outlets: Arc<Outlets>,
    ends: Arc<Ends>,
    caller: Arc<Caller>,
    reach: Reach,
    most_cost: Duration,
    quotas: Quotas,
}

impl Service {
    /// Joins them, for the server itself: see [`Service::on_behalf_of`]. `signals` are shared with
    /// the worker of this process. Webhooks go to public addresses, there is no broker, a job may
    /// cost what it will, and a key have what it likes: see [`Service::telling`],
    /// [`Service::accepting`] and [`Service::within`].
    pub fn new(store: Arc<dyn Store>, numerics: Arc<dyn Numerics>, signals: Arc<Signals>) -> Self {
        let (metrics, asked, places, outlets, ends) = Default::default();
        let (caller, reach) = (Arc::new(Caller::Everybody), Reach::everything());
        let (most_cost, quotas) = (Duration::MAX, Quotas::default());
        Self {
            store,
            numerics,
            signals,
            metrics,
            asked,
            places,
            outlets,
            ends,
            caller,
            reach,
            most_cost,
            quotas,
        }
    }

    /// The same for a caller: it finds what it may see, and owns what it makes.
    pub fn on_behalf_of(&self, caller: Caller) -> Self {
        let reach = caller.reach();
        Self { caller: Arc::new(caller), reach, ..self.clone() }
    }

    /// Who asks.
    pub fn caller(&self) -> &Caller {
        &self.caller
    }

    /// The same, telling others in this way.
    pub fn telling(self, outlets: Outlets) -> Self {
        Self { outlets: Arc::new(outlets), ..self }
    }

    /// The same, refusing jobs that are estimated to take longer on one processor.
    pub fn accepting(self, most_cost: Duration) -> Self {
        Self { most_cost, ..self }
    }

    /// The same, holding each key to these quotas.
    pub fn within(self, quotas: Quotas) -> Self {
        Self { quotas, ..self }
    }

    /// What is counted of this service.
    pub fn metrics(&self) -> &Metrics {
        &self.metrics
    }

    /// The metrics as text, with the queue as it stands.
    ///
    /// # Errors
    /// When the database does not answer.
    pub async fn metrics_text(&self) -> Result<String, ServiceError> {
        Ok(self.metrics.text(self.store.queue().await?, self.store.waiting().await?))
    }

    /// Whether requests can be served.
    ///
    /// # Errors
    /// When the database does not answer.
    pub async fn ready(&self) -> Result<(), ServiceError> {
        Ok(self.store.ping().await?)
    }
}

/// Computes off the threads that answer requests; a panic goes on in the request
/// that asked for it.
async fn aside<T: Send + 'static>(compute: impl FnOnce() -> T + Send + 'static) -> T {
    match tokio::task::spawn_blocking(compute).await {
        Ok(computed) => computed,
        Err(panicked) => std::panic::resume_unwind(panicked.into_panic()),
    }
}

/// Cuts a list read with one row more than `limit` to a page. `bytes` is the size of what is shown of
/// a row.
fn paged<R, T>(
    mut rows: Vec<R>,
    limit: u32,
    id: impl Fn(&R) -> &str,
    bytes: impl Fn(&R) -> usize,
    view: impl Fn(R) -> Result<T, ServiceError>,
) -> Result<Listed<T>, ServiceError> {
    let fit = fitting(rows.iter().take(limit as usize), bytes);
    let more = rows.len() > fit;
    rows.truncate(fit);
    let next = rows.last().filter(|_| more).map(|row| id(row).to_owned());
    Ok(Listed { items: rows.into_iter().map(view).collect::<Result<_, _>>()?, next })
}

/// How many of these rows fit on a page, one at least. `bytes` is the size of what is shown of a row.
fn fitting<'r, R: 'r>(rows: impl IntoIterator<Item = &'r R>, bytes: impl Fn(&R) -> usize) -> usize {
    let mut left = PAGE_BYTES;
    let fit = rows.into_iter().take_while(|row| {
        let fits = left > 0;
        left = left.saturating_sub(bytes(row));
        fits
    });
    fit.count()
}

/// Checks a page asked for, and asks the store for one row more.
fn page(limit: u32, cursor: Option<String>) -> Result<crate::store::Page, ServiceError> {
    if !(1..=MAX_PAGE).contains(&limit) {
        return Err(ServiceError::Request {
            member: "limit".into(),
            reason: format!("{limit} is outside 1 to {MAX_PAGE}"),
        });
    }
    if let Some(text) = cursor.as_deref()
        && uuid::Uuid::try_parse(text).is_err()
    {
        return Err(ServiceError::Request {
            member: "cursor".into(),
            reason: format!("`{text}` is not the `next` of an earlier page"),
        });
    }
    Ok(crate::store::Page { limit: limit + 1, before: cursor })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_ends_where_its_items_become_too_large_and_goes_on_behind_them() {
        let page = |rows: &[(&'static str, usize)], limit| {
            let listed = paged(rows.to_vec(), limit, |row| row.0, |row| row.1, Ok).unwrap();
            (listed.items.len(), listed.next)
        };
        let small = [("a", 10), ("b", 10), ("c", 10)];
        assert_eq!(page(&small, 3), (3, None));
        assert_eq!(page(&small, 2), (2, Some("b".into())));
        let half = PAGE_BYTES / 2;
        let large = [("a", half), ("b", half), ("c", half)];
        assert_eq!(page(&large, 3), (2, Some("b".into())));
        let huge = [("a", 10 * PAGE_BYTES), ("b", 1)];
        assert_eq!(page(&huge, 2), (1, Some("a".into())), "each page has one at least");
    }
}
