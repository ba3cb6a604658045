//! Submitting, watching, cancelling and removing jobs.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use servoscope_core::answers::{Answer, ConvergenceRow, Progress};
use sha2::{Digest, Sha256};

use crate::store::{
    Cancelling, ConvergencePoint, IdempotencyKey, Inserted, JobFilter, JobRow, NewJobRow, Status,
};

use super::measurements::hexadecimal;
use super::{Added, JobRequest, Listed, Service, ServiceError, Submission, page, paged};

/// Why a job failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// For the caller.
    pub reason: String,
    /// Where to find more in the log; `None` where `reason` says everything.
    pub reference: Option<String>,
}

/// A job as it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// What the store keeps of it.
    pub row: JobRow,
    /// What was asked, every option in effect.
    pub request: JobRequest,
    /// How far it has come.
    pub progress: Option<Progress>,
    /// Why it failed.
    pub failure: Option<Failure>,
}

impl Service {
    /// Queues a job.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] for the measurement, [`ServiceError::Request`]
    /// for anything else that cannot be used.
    pub async fn submit(
        &self,
        submission: &Submission,
        key: Option<String>,
    ) -> Result<Added<Job>, ServiceError> {
        let request = JobRequest::check(submission)?;
        let measurement = self.measurement(&submission.measurement_id).await?.row;
        let second = match &request.validation_measurement_id {
            Some(second) => Some(self.measurement(second).await?.row),
            None => None,
        };
        let estimated_s = Some(self.cost(&measurement, second.as_ref(), &request)?);
        let request = JobRequest { estimated_s, ..request };
        let priority = request.priority;
        let request =
            serde_json::to_string(&request).map_err(|source| corrupt("request", source))?;
        let key = key.map(|key| {
            let mut hash = Sha256::new_with_prefix(measurement.id.as_bytes());
            hash.update(request.as_bytes());
            IdempotencyKey { key, body_sha256: hexadecimal(&hash.finalize()) }
        });
        let row = NewJobRow {
            id: uuid::Uuid::now_v7().to_string(),
            measurement_id: measurement.id,
            submitter: self.submitter(submission),
            kind: submission.kind.clone(),
            priority,
            request,
        };
        match self.store.insert_job(&self.reach, &row, key.as_ref()).await? {
            Inserted::Created => {
                self.keep_job_within_quotas(&row.id).await?;
                self.signals.job_queued();
                Ok(Added { resource: self.job(&row.id).await?, replayed: false })
            }
            Inserted::Replayed(id) => Ok(Added { resource: self.job(&id).await?, replayed: true }),
            Inserted::KeyReused => {
                Err(ServiceError::KeyReused { key: key.map(|key| key.key).unwrap_or_default() })
            }
        }
    }

    /// Whose turn it is: keys take turns; who has none is told apart by what the submission says.
    pub(super) fn submitter(&self, submission: &Submission) -> String {
        match self.reach.owner.as_str() {
            "" => submission.submitter.clone(),
            key => key.to_owned(),
        }
    }

    /// One job as it stands.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn job(&self, id: &str) -> Result<Job, ServiceError> {
        let row = self.store.job(&self.reach, id).await?;
        job(row.ok_or_else(|| ServiceError::Unknown { what: "job", id: id.into() })?)
    }

    /// One job, as soon as it has ended or `patience` is over or the process is
    /// asked to stop.
    ///
    /// # Errors
    /// As [`Service::job`].
    pub async fn job_when_ended(&self, id: &str, patience: Duration) -> Result<Job, ServiceError> {
        if patience.is_zero() {
            return self.job(id).await;
        }
        // Before looking: a job that ends in between is not missed.
        let ended = self.ends.of(id, &self.store, &self.signals);
        let job = self.job(id).await?;
        if job.row.status.is_final() {
            return Ok(job);
        }
        tokio::select! {
            _ = ended => {}
            () = tokio::time::sleep(patience) => {}
            () = self.signals.stopped() => {}
        }
        self.job(id).await
    }

    /// Jobs, newest first.
    ///
    /// # Errors
    /// [`ServiceError::Request`] for a limit or cursor that cannot be used.
    pub async fn jobs(
        &self,
        filter: &JobFilter,
        limit: u32,
        cursor: Option<String>,
    ) -> Result<Listed<Job>, ServiceError> {
        let rows = self.store.jobs(&self.reach, filter, &page(limit, cursor)?).await?;
        let bytes = |row: &JobRow| row.request.len() + row.failure.as_ref().map_or(0, String::len);
        paged(rows, limit, |row| &row.id, bytes, job)
    }

    /// The result of a job, the JSON that was stored.
    ///
    /// # Errors
    /// [`ServiceError::NotFinished`] before it has one, [`ServiceError::NoResult`]
    /// when it ended without.
    pub async fn result(&self, id: &str) -> Result<String, ServiceError> {
        if let Some(result) = self.store.result(&self.reach, id).await? {
            return Ok(result);
        }
        let job = self.job(id).await?;
        Err(match job.row.status {
            status if !status.is_final() => ServiceError::NotFinished { id: id.into(), status },
            Status::Cancelled => {
                ServiceError::NoResult { id: id.into(), how: "was cancelled".into() }
            }
            _ => {
                let reason = job.failure.map(|failure| failure.reason).unwrap_or_default();
                ServiceError::NoResult { id: id.into(), how: format!("failed ({reason})") }
            }
        })
    }

    /// The answer to a job.
    ///
    /// # Errors
    /// As [`Service::result`]; [`ServiceError::Corrupt`] where this version cannot
    /// read what was stored.
    pub(super) async fn answer(&self, id: &str) -> Result<Answer, ServiceError> {
        answer(&self.result(id).await?)
    }

    /// Convergence history of a job's latest attempt.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is no such job.
    pub async fn convergence(&self, id: &str) -> Result<Vec<ConvergenceRow>, ServiceError> {
        self.job(id).await?;
        Ok(self
            .store
            .convergence(&self.reach, id)
            .await?
            .into_iter()
            .map(convergence_row)
            .collect())
    }

    /// Cancels a queued job at once; asks a running one to stop, which it does at
    /// its next evaluation. Cancelling twice is no error.
    ///
    /// # Errors
    /// [`ServiceError::Ended`] when it has already succeeded or failed.
    pub async fn cancel(&self, id: &str) -> Result<Job, ServiceError> {
        match self.store.cancel(&self.reach, id).await? {
            Cancelling::Unknown => Err(ServiceError::Unknown { what: "job", id: id.into() }),
            Cancelling::Ended(status @ (Status::Succeeded | Status::Failed)) => {
                Err(ServiceError::Ended { id: id.into(), status })
            }
            Cancelling::Cancelled => {
                let job = self.job(id).await?;
                self.metrics.job_ended(&job.row.kind, Status::Cancelled, None);
                self.signals.job_ended();
                Ok(job)
            }
            Cancelling::Requested => {
                self.signals.job_unwanted();
                self.job(id).await
            }
            Cancelling::Ended(_) => self.job(id).await,
        }
    }

    /// Removes a job with its result and history. One that runs is stopped.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn delete_job(&self, id: &str) -> Result<(), ServiceError> {
        if !self.store.delete_job(&self.reach, id).await? {
            return Err(ServiceError::Unknown { what: "job", id: id.into() });
        }
        self.signals.job_unwanted();
        self.signals.job_ended();
        Ok(())
    }
}

fn job(row: JobRow) -> Result<Job, ServiceError> {
    let request =
        serde_json::from_str(&row.request).map_err(|source| corrupt("request", source))?;
    let progress = row.progress.as_deref().map(serde_json::from_str::<Progress>).transpose();
    let progress = progress.map_err(|source| corrupt("progress", source))?.map(|progress| {
        // No time is left of a job that has ended.
        let remaining_s = progress.remaining_s.filter(|_| !row.status.is_final());
        Progress { remaining_s, ..progress }
    });
    let failure = row.failure.as_deref().map(serde_json::from_str).transpose();
    let failure = failure.map_err(|source| corrupt("failure", source))?;
    Ok(Job { row, request, progress, failure })
}

/// A result as it was stored, read.
pub(super) fn answer(result: &str) -> Result<Answer, ServiceError> {
    Answer::from_json(result).map_err(|error| corrupt("result", error.into_inner()))
}

fn corrupt(what: &'static str, source: serde_json::Error) -> ServiceError {
    ServiceError::Corrupt { what, source }
}

pub(super) fn convergence_row(point: ConvergencePoint) -> ConvergenceRow {
    ConvergenceRow {
        stage: point.stage,
        cycle: point.cycle.unsigned_abs(),
        evaluations: point.evaluations.unsigned_abs(),
        best: point.best,
        mean: point.mean,
        elapsed_s: point.elapsed_s,
    }
}
