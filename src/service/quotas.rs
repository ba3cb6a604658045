//! How much one key may store, queue, compute and ask for.
//!
//! What goes beyond a quota is written, counted with all else of its key, and taken back. So of
//! requests at the same moment none gets more than the quota, and a request that is repeated with
//! its idempotency key is answered also where the quota is used up.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::store::Usage;

use super::caller::Key;
use super::{Service, ServiceError};

/// The time for which computing is counted.
const DAY: Duration = Duration::from_secs(24 * 3600);

/// Seconds after which to ask again for a place in the queue, and for time to compute.
const QUEUE_WAIT_S: u64 = 30;
const COMPUTE_WAIT_S: u64 = 1800;

/// Bytes of a mebibyte.
const MIB: i64 = 1 << 20;

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

/// What was used up, and how long to wait until there is room; `None`: nothing comes back by itself.
type Exceeded = (String, Option<u64>);

/// The quotas of one key, and those that hold where it has none of its own.
#[derive(Debug, Clone, Copy)]
pub struct Held {
    own: Quotas,
    server: Quotas,
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

impl Held {
    /// How many there may be of something, and who says so.
    fn most(&self, of: fn(&Quotas) -> Option<usize>, flag: &str) -> Option<(usize, String)> {
        let own = of(&self.own).map(|most| (most, "set for this key".to_owned()));
        own.or_else(|| of(&self.server).map(|most| (most, format!("`--key-{flag}`"))))
    }

    /// Whether what a key has must be counted.
    fn counts(&self) -> bool {
        let counted =
            |quotas: Quotas| Quotas { requests_per_minute: None, ..quotas } != Quotas::default();
        counted(self.own) || counted(self.server)
    }

    /// Requests a minute, and who says so.
    pub fn requests_per_minute(&self) -> Option<(usize, String)> {
        self.most(|quotas| quotas.requests_per_minute, "requests-per-minute")
    }

    fn exceeded_by_upload(&self, usage: &Usage) -> Option<Exceeded> {
        let kept = self.most(|quotas| quotas.measurements, "measurements");
        if let Some((most, by)) = kept.filter(|(most, _)| usage.measurements > *most as i64) {
            let measurements = if most == 1 { "measurement" } else { "measurements" };
            return Some((
                format!(
                    "has reached its limit of {most} {measurements} ({by}); delete what is not needed"
                ),
                None,
            ));
        }
        let mebibytes = (usage.bytes + MIB - 1) / MIB;
        let bytes = self.most(|quotas| quotas.mib, "mib");
        let (most, by) = bytes.filter(|(most, _)| mebibytes > *most as i64)?;
        Some((
            format!(
                "may keep {most} MiB of measurements ({by}), and with this one it would have {:.1} \
                 MiB; delete what is not needed",
                usage.bytes as f64 / MIB as f64
            ),
            None,
        ))
    }

    fn exceeded_by_job(&self, usage: &Usage) -> Option<Exceeded> {
        let unfinished = self.most(|quotas| quotas.jobs, "jobs");
        if let Some((most, by)) = unfinished.filter(|(most, _)| usage.unfinished > *most as i64) {
            let jobs = if most == 1 { "job that waits or runs" } else { "jobs that wait or run" };
            return Some((
                format!(
                    "may have {most} {jobs} ({by}), and this job would exceed it; wait for others to finish"
                ),
                Some(QUEUE_WAIT_S),
            ));
        }
        let minutes = usage.computed_ms / 60_000;
        let computed = self.most(|quotas| quotas.compute_minutes, "compute-minutes");
        let (most, by) = computed.filter(|(most, _)| minutes >= *most as i64)?;
        let unit = if most == 1 { "minute" } else { "minutes" };
        Some((
            format!(
                "may compute {most} {unit} in 24 hours ({by}), and its jobs have run for {minutes}; \
                 wait until those of a day ago no longer count"
            ),
            Some(COMPUTE_WAIT_S),
        ))
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

    const NONE: Quotas = Quotas {
        measurements: None,
        mib: None,
        jobs: None,
        compute_minutes: None,
        requests_per_minute: None,
    };

    const USAGE: Usage =
        Usage { measurements: 3, bytes: 2 * MIB, unfinished: 2, computed_ms: 600_000 };

    fn of_server(server: Quotas) -> Held {
        Held { own: NONE, server }
    }

    #[test]
    fn what_is_just_within_a_quota_is_kept_and_what_is_beyond_is_not() {
        let of = |quotas: Quotas| {
            let held = of_server(quotas);
            [held.exceeded_by_upload(&USAGE), held.exceeded_by_job(&USAGE)]
                .map(|exceeded| exceeded.map(|(_, wait_s)| wait_s))
        };
        assert_eq!(of(NONE), [None, None]);
        assert_eq!(
            of(Quotas {
                measurements: Some(3),
                mib: Some(2),
                jobs: Some(2),
                compute_minutes: Some(11),
                requests_per_minute: Some(1),
            }),
            [None, None]
        );
        assert_eq!(of(Quotas { measurements: Some(2), ..NONE }), [Some(None), None]);
        assert_eq!(of(Quotas { mib: Some(1), ..NONE }), [Some(None), None]);
        assert_eq!(of(Quotas { jobs: Some(1), ..NONE }), [None, Some(Some(QUEUE_WAIT_S))]);
        let time = Quotas { compute_minutes: Some(10), ..NONE };
        assert_eq!(of(time), [None, Some(Some(COMPUTE_WAIT_S))]);
    }

    #[test]
    fn a_part_of_a_mebibyte_counts_as_one() {
        let beyond = Usage { bytes: 2 * MIB + 1, ..USAGE };
        let held = of_server(Quotas { mib: Some(2), ..NONE });
        let (text, _) = held.exceeded_by_upload(&beyond).unwrap();
        assert!(text.contains("2.0 MiB; delete"), "{text}");
    }

    #[test]
    fn what_is_set_for_a_key_holds_before_what_the_server_gives_every_key() {
        let server = Quotas { measurements: Some(2), jobs: Some(1), ..NONE };
        let held = Held { own: Quotas { measurements: Some(3), ..NONE }, server };
        assert_eq!(held.exceeded_by_upload(&USAGE), None);
        let (text, _) = held.exceeded_by_job(&USAGE).unwrap();
        assert!(text.contains("(`--key-jobs`)"), "{text}");
        let less = Held { own: Quotas { measurements: Some(1), ..NONE }, server };
        let (text, _) = less.exceeded_by_upload(&USAGE).unwrap();
        assert!(
            text.contains("has reached its limit of 1 measurement (set for this key)"),
            "{text}"
        );
        assert!(held.counts() && less.counts());
        assert!(!of_server(Quotas { requests_per_minute: Some(1), ..NONE }).counts());
    }

    #[test]
    fn a_quota_that_nothing_fits_is_refused_by_its_name() {
        assert!(Quotas { jobs: Some(1), mib: Some(LARGEST), ..NONE }.check().is_ok());
        for quotas in [Quotas { mib: Some(0), ..NONE }, Quotas { mib: Some(LARGEST + 1), ..NONE }] {
            let text = quotas.check().unwrap_err().to_string();
            assert!(text.starts_with("quotas.mib: "), "{text}");
        }
    }
}
