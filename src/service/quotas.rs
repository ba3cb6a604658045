//! How much one key may store, queue, compute and ask for.
//!
//! What goes beyond a quota is written, counted with all else of its key, and taken back. So of
//! requests at the same moment none gets more than the quota, and a request that is repeated with
//! its idempotency key is answered also where the quota is used up.

mod held;

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::store::Usage;

use super::caller::Key;
use super::{Service, ServiceError};
use held::Exceeded;

pub use held::Held;

/// The time for which computing is counted.
const DAY: Duration = Duration::from_secs(24 * 3600);

/// The largest number that a quota can be, as of the settings of a server.
const LARGEST: usize = 1_000_000_000;

/// What a key may have. `None`: of one key, what the server gives every key; of the server, as much
/// as the key likes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Quotas {
    /// Measurements that are stored.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measurements: Option<usize>,
    /// Mebibytes of their files.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mib: Option<usize>,
    /// Jobs that wait or run.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jobs: Option<usize>,
    /// Minutes that its jobs run within a day.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compute_minutes: Option<usize>,
    /// Requests a minute.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub requests_per_minute: Option<usize>,
}

impl Quotas {
    /// Each with its name.
    pub fn entries(&self) -> [(&'static str, Option<usize>); 5] {
        [
            ("measurements", self.measurements),
            ("mib", self.mib),
            ("jobs", self.jobs),
            ("compute_minutes", self.compute_minutes),
            ("requests_per_minute", self.requests_per_minute),
        ]
    }

    /// Checks that each can be one.
    ///
    /// # Errors
    /// [`ServiceError::Request`] of the first that cannot.
    pub(super) fn check(&self) -> Result<(), ServiceError> {
        let fits = |most: usize| (1..=LARGEST).contains(&most);
        let wrong =
            self.entries().into_iter().find(|(_, most)| most.is_some_and(|most| !fits(most)));
        let Some((name, Some(most))) = wrong else { return Ok(()) };
        Err(ServiceError::Request {
            member: format!("quotas.{name}"),
            reason: format!("{most} is not from 1 to {LARGEST}"),
        })
    }
}

impl Service {
    /// What a key is held to.
    pub fn quotas_of(&self, key: &Key) -> Held {
        Held { own: key.quotas, server: self.quotas }
    }

    /// Takes a measurement back that was just stored, where its key has more than it may.
    ///
    /// # Errors
    /// [`ServiceError::OverQuota`] then.
    pub(super) async fn keep_measurement_within_quotas(
        &self,
        id: &str,
    ) -> Result<(), ServiceError> {
        let exceeded = |held: &Held, usage: &Usage| held.exceeded_by_upload(usage);
        let Some(refused) = self.over_quota(exceeded).await? else { return Ok(()) };
        self.store.delete_measurement(&self.reach, id).await?;
        Err(refused)
    }

    /// Takes a job back that was just queued, where its key has more than it may.
    ///
    /// # Errors
    /// [`ServiceError::OverQuota`] then.
    pub(super) async fn keep_job_within_quotas(&self, id: &str) -> Result<(), ServiceError> {
        let exceeded = |held: &Held, usage: &Usage| held.exceeded_by_job(usage);
        let Some(refused) = self.over_quota(exceeded).await? else { return Ok(()) };
        self.store.delete_job(&self.reach, id).await?;
        Err(refused)
    }

    /// Refuses a batch that has more jobs than a key may ever have.
    ///
    /// # Errors
    /// [`ServiceError::Request`] then.
    pub(super) fn check_batch_within_quotas(&self, jobs: usize) -> Result<(), ServiceError> {
        let held = self.caller.key().map(|key| self.quotas_of(key));
        let most = held.and_then(|held| held.most(|quotas| quotas.jobs, "jobs"));
        let Some((most, by)) = most.filter(|(most, _)| jobs > *most) else { return Ok(()) };
        Err(ServiceError::Request {
            member: "measurement_ids".into(),
            reason: format!(
                "these are {jobs}, and a key may have {most} jobs that wait or run ({by}); make \
                 batches of at most {most}"
            ),
        })
    }

    /// Takes a batch back that was just queued, where its key has more than it may.
    ///
    /// # Errors
    /// [`ServiceError::OverQuota`] then.
    pub(super) async fn keep_batch_within_quotas(&self, id: &str) -> Result<(), ServiceError> {
        let exceeded = |held: &Held, usage: &Usage| held.exceeded_by_job(usage);
        let Some(refused) = self.over_quota(exceeded).await? else { return Ok(()) };
        self.delete_batch(id).await?;
        Err(refused)
    }

    async fn over_quota(
        &self,
        exceeded: fn(&Held, &Usage) -> Option<Exceeded>,
    ) -> Result<Option<ServiceError>, ServiceError> {
        let Some(key) = self.caller.key() else { return Ok(None) };
        let held = self.quotas_of(key);
        if !held.counts() {
            return Ok(None);
        }
        let usage = self.store.usage(&key.id, DAY).await?;
        Ok(exceeded(&held, &usage).map(|(reason, wait_s)| ServiceError::OverQuota {
            name: key.name.clone(),
            reason,
            wait_s,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quota_that_nothing_fits_is_refused_by_its_name() {
        assert!(Quotas { jobs: Some(1), mib: Some(LARGEST), ..Quotas::default() }.check().is_ok());
        for quotas in [
            Quotas { mib: Some(0), ..Quotas::default() },
            Quotas { mib: Some(LARGEST + 1), ..Quotas::default() },
        ] {
            let text = quotas.check().unwrap_err().to_string();
            assert!(text.starts_with("quotas.mib: "), "{text}");
        }
    }
}
