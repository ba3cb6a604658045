//! How much one key may store, queue and compute.
//!
//! What goes beyond a quota is written, counted with all else of its key, and taken back. So of
//! requests at the same moment none gets more than the quota, and a request that is repeated with
//! its idempotency key is answered also where the quota is used up.

use std::time::Duration;

use crate::store::Usage;

use super::{Service, ServiceError};

/// The time for which computing is counted.
const DAY: Duration = Duration::from_secs(24 * 3600);

/// Seconds after which to ask again for a place in the queue, and for time to compute.
const QUEUE_WAIT_S: u64 = 30;
const COMPUTE_WAIT_S: u64 = 1800;

/// Bytes of a mebibyte.
const MIB: i64 = 1 << 20;

/// What each key may have; `None`: as much as it likes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Quotas {
    /// Measurements that are stored.
    pub measurements: Option<usize>,
    /// Mebibytes of their files.
    pub mebibytes: Option<usize>,
    /// Jobs that wait or run.
    pub jobs: Option<usize>,
    /// Minutes that its jobs run within a day.
    pub compute_minutes: Option<usize>,
}

/// What was used up, and how long to wait until there is room; `None`: nothing comes back by itself.
type Exceeded = (String, Option<u64>);

impl Quotas {
    fn exceeded_by_upload(&self, usage: &Usage) -> Option<Exceeded> {
        let more = |used: i64, most: Option<usize>| most.filter(|most| used > *most as i64);
        if let Some(most) = more(usage.measurements, self.measurements) {
            let measurements = if most == 1 { "measurement" } else { "measurements" };
            return Some((
                format!(
                    "may keep {most} {measurements} (`--key-measurements`) and has as many; delete \
                     what is not needed"
                ),
                None,
            ));
        }
        let most = more((usage.bytes + MIB - 1) / MIB, self.mebibytes)?;
        Some((
            format!(
                "may keep {most} MiB of measurements (`--key-mib`), and with this one it would have \
                 {:.1} MiB; delete what is not needed",
                usage.bytes as f64 / MIB as f64
            ),
            None,
        ))
    }

    fn exceeded_by_job(&self, usage: &Usage) -> Option<Exceeded> {
        if let Some(most) = self.jobs.filter(|most| usage.unfinished > *most as i64) {
            let jobs = if most == 1 { "job that waits or runs" } else { "jobs that wait or run" };
            return Some((
                format!(
                    "may have {most} {jobs} (`--key-jobs`), and this would be more; wait until some end"
                ),
                Some(QUEUE_WAIT_S),
            ));
        }
        let minutes = usage.computed_ms / 60_000;
        let most = self.compute_minutes.filter(|most| minutes >= *most as i64)?;
        Some((
            format!(
                "may compute {most} minutes in 24 hours (`--key-compute-minutes`), and its jobs \
                 have run for {minutes}; wait until those of a day ago no longer count"
            ),
            Some(COMPUTE_WAIT_S),
        ))
    }
}

impl Service {
    /// Takes a measurement back that was just stored, where its key has more than it may.
    ///
    /// # Errors
    /// [`ServiceError::OverQuota`] then.
    pub(super) async fn keep_measurement_within_quotas(
        &self,
        id: &str,
    ) -> Result<(), ServiceError> {
        let exceeded = |quotas: &Quotas, usage: &Usage| quotas.exceeded_by_upload(usage);
        let Some(refused) = self.over_quota(exceeded).await? else { return Ok(()) };
        self.store.delete_measurement(&self.reach, id).await?;
        Err(refused)
    }

    /// Takes a job back that was just queued, where its key has more than it may.
    ///
    /// # Errors
    /// [`ServiceError::OverQuota`] then.
    pub(super) async fn keep_job_within_quotas(&self, id: &str) -> Result<(), ServiceError> {
        let exceeded = |quotas: &Quotas, usage: &Usage| quotas.exceeded_by_job(usage);
        let Some(refused) = self.over_quota(exceeded).await? else { return Ok(()) };
        self.store.delete_job(&self.reach, id).await?;
        Err(refused)
    }

    /// Refuses a batch that has more jobs than a key may ever have.
    ///
    /// # Errors
    /// [`ServiceError::Request`] then.
    pub(super) fn check_batch_within_quotas(&self, jobs: usize) -> Result<(), ServiceError> {
        let most = self.caller.key().and(self.quotas.jobs).filter(|most| jobs > *most);
        let Some(most) = most else { return Ok(()) };
        Err(ServiceError::Request {
            member: "measurement_ids".into(),
            reason: format!(
                "these are {jobs}, and a key may have {most} jobs that wait or run (`--key-jobs`); \
                 make batches of at most {most}"
            ),
        })
    }

    /// Takes a batch back that was just queued, where its key has more than it may.
    ///
    /// # Errors
    /// [`ServiceError::OverQuota`] then.
    pub(super) async fn keep_batch_within_quotas(&self, id: &str) -> Result<(), ServiceError> {
        let exceeded = |quotas: &Quotas, usage: &Usage| quotas.exceeded_by_job(usage);
        let Some(refused) = self.over_quota(exceeded).await? else { return Ok(()) };
        self.delete_batch(id).await?;
        Err(refused)
    }

    async fn over_quota(
        &self,
        exceeded: fn(&Quotas, &Usage) -> Option<Exceeded>,
    ) -> Result<Option<ServiceError>, ServiceError> {
        let Some(key) = self.caller.key().filter(|_| self.quotas != Quotas::default()) else {
            return Ok(None);
        };
        let usage = self.store.usage(&key.id, DAY).await?;
        Ok(exceeded(&self.quotas, &usage).map(|(reason, wait_s)| ServiceError::OverQuota {
            name: key.name.clone(),
            reason,
            wait_s,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const USAGE: Usage =
        Usage { measurements: 3, bytes: 2 * MIB, unfinished: 2, computed_ms: 600_000 };

    #[test]
    fn what_is_just_within_a_quota_is_kept_and_what_is_beyond_is_not() {
        let of = |quotas: Quotas| {
            [quotas.exceeded_by_upload(&USAGE), quotas.exceeded_by_job(&USAGE)]
                .map(|exceeded| exceeded.map(|(_, wait_s)| wait_s))
        };
        let none = Quotas::default();
        assert_eq!(of(none), [None, None]);
        assert_eq!(
            of(Quotas {
                measurements: Some(3),
                mebibytes: Some(2),
                jobs: Some(2),
                compute_minutes: Some(11),
            }),
            [None, None]
        );
        assert_eq!(of(Quotas { measurements: Some(2), ..none }), [Some(None), None]);
        assert_eq!(of(Quotas { mebibytes: Some(1), ..none }), [Some(None), None]);
        assert_eq!(of(Quotas { jobs: Some(1), ..none }), [None, Some(Some(QUEUE_WAIT_S))]);
        let time = Quotas { compute_minutes: Some(10), ..none };
        assert_eq!(of(time), [None, Some(Some(COMPUTE_WAIT_S))]);
    }

    #[test]
    fn a_part_of_a_mebibyte_counts_as_one() {
        let quotas = Quotas { mebibytes: Some(2), ..Quotas::default() };
        let beyond = Usage { bytes: 2 * MIB + 1, ..USAGE };
        let (text, _) = quotas.exceeded_by_upload(&beyond).unwrap();
        assert!(text.contains("2.0 MiB; delete"), "{text}");
    }
}
