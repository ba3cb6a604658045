//! Why a request was not carried out.

use servoscope_core::answers::InvalidOptions;
use servoscope_core::measurement::formats::ParseError;

use crate::store::{Status, StoreError};

use super::caller::Scope;

/// Why a request was not carried out. Texts are for the caller; what only the
/// operator may know is in the source of [`ServiceError::Store`] and
/// [`ServiceError::Corrupt`].
#[derive(Debug, thiserror::Error)]
pub enum ServiceError {
    /// No such resource.
    #[error("there is no {what} `{id}`")]
    Unknown {
        /// `measurement`, `job`, `webhook` ….
        what: &'static str,
        /// What was asked for.
        id: String,
    },
    /// Nobody knows who asks.
    #[error(
        "{reason}; send a key as `Authorization: Bearer sk_servoscope_…`, or sign in; whoever \
         operates the server makes one with `servoscope keys add`"
    )]
    Unrecognised {
        /// Why.
        reason: &'static str,
    },
    /// The key may not do this.
    #[error("the key `{name}` lacks the scope `{scope}`; it has {}", names(scopes))]
    Lacking {
        /// Name of the key.
        name: String,
        /// What it lacks.
        scope: Scope,
        /// What it has.
        scopes: Vec<Scope>,
    },
    /// The upload cannot be read; nothing of it was stored.
    #[error(transparent)]
    Upload(#[from] ParseError),
    /// A member of the request has an unusable value.
    #[error("{member}: {reason}")]
    Request {
        /// The member, with dots where it is nested.
        member: String,
        /// What is wrong, and what is known instead.
        reason: String,
    },
    /// One of many members of the request cannot be used.
    #[error("{member}: {source}")]
    Member {
        /// Which one.
        member: String,
        /// Why.
        source: Box<ServiceError>,
    },
    /// The result of a job that has not ended.
    #[error("job `{id}` is {}, it has no result yet; ask `GET /v1/jobs/{id}?wait=30` until its \
             status is `succeeded`", status.name())]
    NotFinished {
        /// The job.
        id: String,
        /// Where it stands.
        status: Status,
    },
    /// The result of a job that ended without one.
    #[error("job `{id}` {how} and has no result; submit it again with `POST /v1/jobs`")]
    NoResult {
        /// The job.
        id: String,
        /// How it ended.
        how: String,
    },
    /// A figure that cannot be drawn of a job.
    #[error("job `{id}` has no plot `{name}`: {reason}; available: {}", listed(available))]
    NoPlot {
        /// The job.
        id: String,
        /// What was asked for.
        name: String,
        /// What is missing.
        reason: String,
        /// The figures there are.
        available: Vec<&'static str>,
    },
    /// A measurement that cannot be inspected.
    #[error("the measurement cannot be inspected: {reason}")]
    Uninspected {
        /// What is wrong.
        reason: String,
    },
    /// Reading the files of a measurement again, on which there is a job.
    #[error(
        "measurement `{id}` has jobs, whose results depend on how its files were read; delete them \
         with `DELETE /v1/jobs/{{id}}`, or upload the files again with `POST /v1/measurements` for \
         another reading of them"
    )]
    HasJobs {
        /// The measurement.
        id: String,
    },
    /// Cancelling a job that has ended.
    #[error("job `{id}` has already {}; there is nothing to cancel", status.name())]
    Ended {
        /// The job.
        id: String,
        /// How it ended.
        status: Status,
    },
    /// A job, or what is computed while a request waits, that would take too long.
    #[error(
        "it would compute about {} on one processor, more than the {} that a job may; {less}, or \
         have the server started with a larger `--job-cost-minutes`",
        in_words(*minutes), in_words(*most_minutes)
    )]
    TooCostly {
        /// Estimate, minutes of one processor.
        minutes: f64,
        /// What a job may take.
        most_minutes: f64,
        /// How to ask for less.
        less: String,
    },
    /// Others have had all places for what is computed while a request waits.
    #[error(
        "the server is busy with what it computes for other requests; nothing of this one was \
         stored; send it again in some seconds, and few at a time"
    )]
    Busy,
    /// A key has, or asks, as much as a key may.
    #[error("the key `{name}` {reason}")]
    OverQuota {
        /// Name of the key.
        name: String,
        /// How much it may, by which setting, and what to do.
        reason: String,
        /// After how many seconds to try again; `None`: waiting alone does not help.
        wait_s: Option<u64>,
    },
    /// The idempotency key came with another request before.
    #[error("the idempotency key `{key}` was used before for another request; use a new key")]
    KeyReused {
        /// The key.
        key: String,
    },
    /// The database refused or is out of reach.
    #[error("the database does not answer as it should")]
    Store(#[from] StoreError),
    /// What the database returned is not what was stored.
    #[error("stored {what} cannot be read")]
    Corrupt {
        /// What it should be.
        what: &'static str,
        /// Why it is not.
        source: serde_json::Error,
    },
}

fn in_words(minutes: f64) -> String {
    if minutes < 2.0 {
        format!("{:.0} seconds", 60.0 * minutes)
    } else if minutes < 120.0 {
        format!("{minutes:.0} minutes")
    } else {
        format!("{:.0} hours", minutes / 60.0)
    }
}

fn listed(names: &[&str]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn names(scopes: &[Scope]) -> String {
    let names: Vec<String> = scopes.iter().map(|scope| format!("`{scope}`")).collect();
    names.join(", ")
}

impl From<InvalidOptions> for ServiceError {
    fn from(invalid: InvalidOptions) -> Self {
        let member = match invalid.option {
            "method" => "method".to_owned(),
            option => format!("options.{option}"),
        };
        ServiceError::Request { member, reason: invalid.reason }
    }
}
