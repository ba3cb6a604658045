//! Batches: many measurements that are computed in the same way, as one thing to watch and cancel.

mod shown;

use std::collections::{BTreeSet, HashMap};

use sha2::{Digest, Sha256};

use crate::store::{
    CancelledRows, IdempotencyKey, Inserted, MeasurementRow, NewBatchRow, NewMemberRow, Status,
};

use super::measurements::hexadecimal;
use super::{Added, JobRequest, Service, ServiceError, Submission};

pub use shown::{Batch, BatchJob, BatchState, Counts};

/// Most measurements of one batch.
pub const MAX_BATCH: usize = 10_000;

/// Most characters of its name.
const NAME_CHARACTERS: usize = 200;

/// Measurements that are looked up at once.
const LOOKED_UP: usize = 500;

/// Jobs that are cancelled, and jobs that are deleted with their results, in one transaction: others
/// wait for its end.
const CANCELLED: u32 = 1000;
const DELETED: u32 = 100;

/// What a caller asks for, unchecked.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BatchSubmission {
    /// Its name, for people.
    pub name: Option<String>,
    /// The measurements, each of which gets a job.
    pub measurement_ids: Vec<String>,
    /// What is asked of each; its own measurement is not looked at.
    pub each: Submission,
}

impl BatchSubmission {
    fn check(&self) -> Result<JobRequest, ServiceError> {
        let wrong = |member: &str, reason: String| {
            Err(ServiceError::Request { member: member.into(), reason })
        };
        let count = self.measurement_ids.len();
        if !(1..=MAX_BATCH).contains(&count) {
            let reason = format!("{count} is outside 1 to {MAX_BATCH} measurements of a batch");
            return wrong("measurement_ids", reason);
        }
        let mut seen = BTreeSet::new();
        if let Some(place) = self.measurement_ids.iter().position(|id| !seen.insert(id)) {
            let id = &self.measurement_ids[place];
            return wrong(&member(place), format!("`{id}` is in the list before; name it once"));
        }
        if self.name.as_ref().is_some_and(|name| name.chars().count() > NAME_CHARACTERS) {
            return wrong("name", format!("it is longer than {NAME_CHARACTERS} characters"));
        }
        JobRequest::check(&self.each)
    }

    /// What tells two batches apart.
    fn digest(&self, request: &str) -> String {
        let mut hash = Sha256::new();
        let name = self.name.as_deref().unwrap_or_default();
        for part in
            [name, request].into_iter().chain(self.measurement_ids.iter().map(String::as_str))
        {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
        hexadecimal(&hash.finalize())
    }
}

/// How a measurement of the list is named in errors.
fn member(place: usize) -> String {
    format!("measurement_ids[{place}]")
}

impl Service {
    /// Queues a job for each of many measurements: for all of them, or for none.
    ///
    /// # Errors
    /// As [`Service::submit`], of the first measurement that cannot be used.
    pub async fn submit_batch(
        &self,
        submission: &BatchSubmission,
        key: Option<String>,
    ) -> Result<Added<Batch>, ServiceError> {
        let request = submission.check()?;
        self.check_batch_within_quotas(submission.measurement_ids.len())?;
        let text = written(&request)?;
        let body_sha256 = submission.digest(&text);
        let key = key.map(|key| IdempotencyKey { key, body_sha256 });
        let row = NewBatchRow {
            id: uuid::Uuid::now_v7().to_string(),
            name: submission.name.clone(),
            submitter: self.submitter(&submission.each),
            kind: request.kind.name().to_owned(),
            priority: request.priority,
            jobs: self.jobs_of(&submission.measurement_ids, &request).await?,
            request: text,
        };
        match self.store.insert_batch(&self.reach, &row, key.as_ref()).await? {
            Inserted::Created => {
                self.keep_batch_within_quotas(&row.id).await?;
                self.signals.job_queued();
                Ok(Added { resource: self.batch(&row.id).await?, replayed: false })
            }
            Inserted::Replayed(id) => {
                Ok(Added { resource: self.batch(&id).await?, replayed: true })
            }
            Inserted::KeyReused => {
                Err(ServiceError::KeyReused { key: key.map(|key| key.key).unwrap_or_default() })
            }
        }
    }

    /// The jobs of a batch, each with its estimate.
    async fn jobs_of(
        &self,
        measurements: &[String],
        request: &JobRequest,
    ) -> Result<Vec<NewMemberRow>, ServiceError> {
        let mut jobs = Vec::with_capacity(measurements.len());
        for ids in measurements.chunks(LOOKED_UP) {
            let rows = self.store.measurements_of(&self.reach, ids).await?;
            let rows: HashMap<&str, &MeasurementRow> =
                rows.iter().map(|row| (row.id.as_str(), row)).collect();
            for id in ids {
                let of_member = |source| ServiceError::Member {
                    member: member(jobs.len()),
                    source: Box::new(source),
                };
                let unknown = || ServiceError::Unknown { what: "measurement", id: id.clone() };
                let row = rows.get(id.as_str()).ok_or_else(|| of_member(unknown()))?;
                let estimated_s = Some(self.cost(row, None, request).map_err(of_member)?);
                let files: Vec<String> = serde_json::from_str(&row.files)
                    .map_err(|source| ServiceError::Corrupt { what: "files", source })?;
                jobs.push(NewMemberRow {
                    // Ids that are made later are larger: they keep the order of the request.
                    job_id: uuid::Uuid::now_v7().to_string(),
                    measurement_id: id.clone(),
                    request: written(&JobRequest { estimated_s, ..request.clone() })?,
                    file: files.into_iter().next(),
                });
            }
        }
        Ok(jobs)
    }

    /// Cancels the jobs of a batch that have not ended: those that wait at once, those that run at
    /// their next evaluation. What has ended stays as it is, and cancelling twice is no error.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn cancel_batch(&self, id: &str) -> Result<Batch, ServiceError> {
        let batch = self.store.batch(&self.reach.for_changes(), id).await?;
        let kind = batch.ok_or_else(|| unknown(id))?.kind;
        loop {
            let step = self.store.cancel_batch(&self.reach, id, CANCELLED).await?;
            let CancelledRows { cancelled, requested } = step.ok_or_else(|| unknown(id))?;
            for _ in 0..cancelled {
                self.metrics.job_ended(&kind, Status::Cancelled, None);
            }
            if cancelled + requested == 0 {
                break;
            }
        }
        self.signals.job_unwanted();
        self.signals.job_ended();
        self.batch(id).await
    }

    /// Removes a batch with its jobs, their results and their history; the measurements stay. Jobs
    /// that run are stopped.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn delete_batch(&self, id: &str) -> Result<(), ServiceError> {
        let mut removed = self.store.delete_batch(&self.reach, id, DELETED).await?;
        if removed.is_none() {
            return Err(unknown(id));
        }
        // Another request may have removed the rest in the meantime.
        while removed.is_some_and(|jobs| jobs >= u64::from(DELETED)) {
            removed = self.store.delete_batch(&self.reach, id, DELETED).await?;
        }
        self.signals.job_unwanted();
        self.signals.job_ended();
        Ok(())
    }
}

fn unknown(id: &str) -> ServiceError {
    ServiceError::Unknown { what: "batch", id: id.into() }
}

fn written(request: &JobRequest) -> Result<String, ServiceError> {
    serde_json::to_string(request)
        .map_err(|source| ServiceError::Corrupt { what: "request", source })
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::JobKind;

    use super::*;

    fn of(ids: &[&str]) -> BatchSubmission {
        let each = Submission { kind: JobKind::Identify.name().into(), ..Submission::default() };
        let measurement_ids = ids.iter().map(|id| (*id).to_owned()).collect();
        BatchSubmission { name: None, measurement_ids, each }
    }

    #[test]
    fn a_list_that_is_empty_too_long_or_says_one_twice_is_refused() {
        of(&["a", "b"]).check().unwrap();
        let refused = |submission: &BatchSubmission| submission.check().unwrap_err().to_string();
        let text = refused(&of(&[]));
        assert!(text.starts_with("measurement_ids: 0 is outside 1 to 10000"), "{text}");
        let many: Vec<String> = (0..=MAX_BATCH).map(|id| id.to_string()).collect();
        let text = refused(&BatchSubmission { measurement_ids: many, ..of(&[]) });
        assert!(text.starts_with("measurement_ids: 10001 is"), "{text}");
        let text = refused(&of(&["a", "b", "a"]));
        assert!(text.starts_with("measurement_ids[2]: `a` is in the list before"), "{text}");
        let text = refused(&BatchSubmission { name: Some("x".repeat(201)), ..of(&["a"]) });
        assert!(text.starts_with("name: it is longer than 200"), "{text}");
    }

    #[test]
    fn batches_of_other_measurements_options_or_names_are_told_apart() {
        let one = of(&["a", "b"]);
        assert_eq!(one.digest("{}"), one.clone().digest("{}"));
        assert_ne!(one.digest("{}"), one.digest("{ }"));
        assert_ne!(one.digest("{}"), of(&["ab"]).digest("{}"));
        assert_ne!(one.digest("{}"), of(&["b", "a"]).digest("{}"));
        assert_ne!(
            one.digest("{}"),
            BatchSubmission { name: Some("x".into()), ..one }.digest("{}")
        );
    }
}
