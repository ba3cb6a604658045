//! Batches as they are shown: where their jobs stand, and what came of them.

use std::collections::BTreeMap;

use servoscope_core::answers::Verdict;

use crate::store::{
    BatchRow, FailureRow, MemberRow, Millis, NOT_TESTED, Standing, Status, TallyRow,
};

use super::super::jobs::Failure;
use super::super::{JobRequest, Listed, Service, ServiceError, page, paged};
use super::unknown;

/// Most reasons for failures that are shown of a batch.
const REASONS: u32 = 20;

/// Rows that are read at once for a whole table.
const READ_AT_ONCE: u32 = 1000;

/// What is said of a job that is gone.
const DELETED: &str = "the job was deleted, by itself or with its measurement";

/// Where a batch stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BatchState {
    /// None of its jobs has begun.
    Queued,
    /// Some of its jobs have begun, and some have not ended.
    Running,
    /// All of its jobs have ended or are gone.
    Ended,
}

/// How many jobs of a batch stand where.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// They wait for a worker.
    pub queued: i64,
    /// They are computed.
    pub running: i64,
    /// They have a result.
    pub succeeded: i64,
    /// They have a reason why there is no result.
    pub failed: i64,
    /// They were cancelled.
    pub cancelled: i64,
    /// They were deleted, by themselves or with their measurement.
    pub deleted: i64,
}

impl Counts {
    fn at(&mut self, status: Status) -> &mut i64 {
        match status {
            Status::Queued => &mut self.queued,
            Status::Running => &mut self.running,
            Status::Succeeded => &mut self.succeeded,
            Status::Failed => &mut self.failed,
            Status::Cancelled => &mut self.cancelled,
        }
    }

    fn state(&self, jobs: i64) -> BatchState {
        match (self.queued, self.running) {
            (0, 0) => BatchState::Ended,
            (queued, 0) if queued + self.deleted == jobs => BatchState::Queued,
            _ => BatchState::Running,
        }
    }
}

/// A batch as it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch {
    /// What the store keeps of it.
    pub row: BatchRow,
    /// What was asked of each measurement, every option in effect.
    pub request: JobRequest,
    /// Where it stands.
    pub state: BatchState,
    /// How many of its jobs stand where.
    pub counts: Counts,
    /// When the first of its jobs began, of those that were begun again the latest attempt.
    pub started_ms: Option<Millis>,
    /// When the last of its jobs ended; `None` until all have.
    pub ended_ms: Option<Millis>,
    /// How many results have which verdict; those without any test are `not_tested`.
    pub verdicts: BTreeMap<String, i64>,
    /// How many results name which cause first.
    pub causes: BTreeMap<String, i64>,
    /// Why jobs failed, the most frequent reasons first.
    pub failures: Vec<FailureRow>,
}

impl Batch {
    fn of(row: BatchRow, tallies: &[TallyRow]) -> Result<Self, ServiceError> {
        let request = serde_json::from_str(&row.request)
            .map_err(|source| ServiceError::Corrupt { what: "request", source })?;
        let mut counts = Counts::default();
        let (mut verdicts, mut causes) = (BTreeMap::new(), BTreeMap::new());
        for tally in tallies.iter().filter(|tally| tally.batch_id == row.id) {
            *counts.at(tally.status) += tally.jobs;
            for (name, among) in [(&tally.verdict, &mut verdicts), (&tally.cause, &mut causes)] {
                if let Some(name) = name {
                    *among.entry(name.clone()).or_default() += tally.jobs;
                }
            }
        }
        let Counts { queued, running, succeeded, failed, cancelled, .. } = counts;
        counts.deleted = row.jobs - (queued + running + succeeded + failed + cancelled);
        let state = counts.state(row.jobs);
        let own = || tallies.iter().filter(|tally| tally.batch_id == row.id);
        let started_ms = own().filter_map(|tally| tally.started_ms).min();
        let ended_ms = own().filter_map(|tally| tally.finished_ms).max();
        let ended_ms = ended_ms.filter(|_| state == BatchState::Ended);
        let failures = Vec::new();
        Ok(Self { row, request, state, counts, started_ms, ended_ms, verdicts, causes, failures })
    }
}

/// One measurement of a batch, and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct BatchJob {
    /// What the store keeps of it, with the verdict as results have it.
    pub row: MemberRow,
    /// Whether the data were enough to test the base model; `None` where there is no verdict.
    pub tested: Option<bool>,
    /// Why there is no result.
    pub problem: Option<String>,
}

impl BatchJob {
    fn of(mut row: MemberRow) -> Result<Self, ServiceError> {
        let failure = row.failure.as_deref().map(serde_json::from_str::<Failure>).transpose();
        let failure =
            failure.map_err(|source| ServiceError::Corrupt { what: "failure", source })?;
        let problem = match row.status {
            None => Some(DELETED.to_owned()),
            Some(_) => failure.map(|failure| failure.reason),
        };
        let tested = row.verdict.as_ref().map(|verdict| verdict != NOT_TESTED);
        if tested == Some(false) {
            row.verdict = Some(Verdict::Adequate.name().to_owned());
        }
        Ok(Self { row, tested, problem })
    }
}

impl Service {
    /// One batch as it stands.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn batch(&self, id: &str) -> Result<Batch, ServiceError> {
        let row = self.store.batch(&self.reach, id).await?.ok_or_else(|| unknown(id))?;
        let shown = self.shown(vec![row]).await?;
        shown.into_iter().next().ok_or_else(|| unknown(id))
    }

    /// Batches, newest first.
    ///
    /// # Errors
    /// [`ServiceError::Request`] for a limit or cursor that cannot be used.
    pub async fn batches(
        &self,
        limit: u32,
        cursor: Option<String>,
    ) -> Result<Listed<Batch>, ServiceError> {
        let rows = self.store.batches(&self.reach, &page(limit, cursor)?).await?;
        let Listed { items, next } =
            paged(rows, limit, |row| &row.id, |row| row.request.len(), Ok)?;
        Ok(Listed { items: self.shown(items).await?, next })
    }

    async fn shown(&self, rows: Vec<BatchRow>) -> Result<Vec<Batch>, ServiceError> {
        let ids: Vec<String> = rows.iter().map(|row| row.id.clone()).collect();
        let tallies = self.store.batch_tallies(&self.reach, &ids).await?;
        let mut shown = Vec::with_capacity(rows.len());
        for row in rows {
            let mut batch = Batch::of(row, &tallies)?;
            if batch.counts.failed > 0 {
                let id = &batch.row.id;
                batch.failures = self.store.batch_failures(&self.reach, id, REASONS).await?;
            }
            shown.push(batch);
        }
        Ok(shown)
    }

    /// What came of each measurement of a batch, in the order of the request.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id, [`ServiceError::Request`] for a
    /// limit or cursor that cannot be used.
    pub async fn batch_jobs(
        &self,
        id: &str,
        standing: Option<Standing>,
        limit: u32,
        cursor: Option<String>,
    ) -> Result<Listed<BatchJob>, ServiceError> {
        let asked = page(limit, cursor)?;
        self.store.batch(&self.reach, id).await?.ok_or_else(|| unknown(id))?;
        let after = asked.before.as_deref();
        let rows = self.store.batch_members(&self.reach, id, standing, after, asked.limit).await?;
        let bytes = |row: &MemberRow| row.failure.as_ref().map_or(0, String::len);
        paged(rows, limit, |row| &row.job_id, bytes, BatchJob::of)
    }

    /// The same of all measurements at once.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn batch_table(&self, id: &str) -> Result<Vec<BatchJob>, ServiceError> {
        self.store.batch(&self.reach, id).await?.ok_or_else(|| unknown(id))?;
        let mut all: Vec<BatchJob> = Vec::new();
        loop {
            let after = all.last().map(|job| job.row.job_id.as_str());
            let store = &self.store;
            let rows = store.batch_members(&self.reach, id, None, after, READ_AT_ONCE).await?;
            let last = rows.len() < READ_AT_ONCE as usize;
            for row in rows {
                all.push(BatchJob::of(row)?);
            }
            if last {
                return Ok(all);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(tallies: &[(Status, i64)]) -> Batch {
        let row = BatchRow {
            id: "a".into(),
            created_at_ms: 0,
            name: None,
            kind: "identify".into(),
            request: serde_json::json!({
                "kind": "identify", "plant": null, "method": "abc-ann", "options": {},
            })
            .to_string(),
            jobs: 5,
        };
        let tally = |&(status, jobs): &(Status, i64)| TallyRow {
            batch_id: "a".into(),
            status,
            verdict: status.is_final().then(|| "explained".into()),
            cause: None,
            jobs,
            started_ms: (status != Status::Queued).then_some(10),
            finished_ms: status.is_final().then_some(20),
        };
        let mut all: Vec<TallyRow> = tallies.iter().map(tally).collect();
        // Of another batch.
        all.push(TallyRow { batch_id: "b".into(), ..tally(&(Status::Failed, 7)) });
        Batch::of(row, &all).unwrap()
    }

    #[test]
    fn a_verdict_without_any_test_is_adequate_and_told_apart() {
        let shown = |verdict: Option<&str>| {
            let row = MemberRow {
                measurement_id: "m".into(),
                file: None,
                job_id: "j".into(),
                status: Some(Status::Succeeded),
                verdict: verdict.map(Into::into),
                cause: None,
                confidence: None,
                failure: None,
            };
            let BatchJob { row, tested, .. } = BatchJob::of(row).unwrap();
            (row.verdict, tested)
        };
        assert_eq!(shown(Some(NOT_TESTED)), (Some("adequate".into()), Some(false)));
        assert_eq!(shown(Some("adequate")), (Some("adequate".into()), Some(true)));
        assert_eq!(shown(None), (None, None));
    }

    #[test]
    fn a_batch_has_ended_once_all_its_jobs_have_or_are_gone() {
        let queued = batch(&[(Status::Queued, 4)]);
        assert_eq!((queued.state, queued.counts.deleted), (BatchState::Queued, 1));
        assert_eq!((queued.started_ms, queued.ended_ms), (None, None));
        let running = batch(&[(Status::Queued, 4), (Status::Succeeded, 1)]);
        assert_eq!((running.state, running.counts.deleted), (BatchState::Running, 0));
        assert_eq!((running.started_ms, running.ended_ms), (Some(10), None));
        let ended = batch(&[(Status::Succeeded, 2), (Status::Failed, 2)]);
        assert_eq!((ended.state, ended.counts.deleted), (BatchState::Ended, 1));
        assert_eq!((ended.ended_ms, ended.verdicts["explained"]), (Some(20), 4));
        assert_eq!(batch(&[]).state, BatchState::Ended);
    }
}
