//! What happens to a job, as it happens and again from the beginning.
//!
//! Every row of convergence history is an event with its position in the history,
//! from 1, as its number; the end has the number after the last row. So a reader
//! that was cut off names the last number it saw and misses nothing: the numbers
//! are those of stored rows and mean the same after a restart, in any process.
//! Where a job stands right now is an event without a number, never repeated.

use std::collections::VecDeque;
use std::pin::pin;
use std::time::Duration;

use futures_util::Stream;
use futures_util::stream::unfold;
use tracing::warn;

use servoscope_core::answers::ConvergenceRow;

use super::jobs::convergence_row;
use super::{Job, Service, ServiceError};

/// How often the store is looked at without a signal: the job may run elsewhere.
const LOOK_AGAIN: Duration = Duration::from_secs(1);

/// Rows read at once.
const BATCH: u32 = 500;

/// Something that happened to a job.
#[derive(Debug, Clone, PartialEq)]
pub enum JobEvent {
    /// It stands elsewhere, or has come further.
    Changed(Box<Job>),
    /// One more row of history.
    Row {
        /// Its number.
        number: i64,
        /// The row.
        row: ConvergenceRow,
    },
    /// It has ended; nothing follows.
    Ended {
        /// Its number.
        number: i64,
        /// The job.
        job: Box<Job>,
    },
}

struct Follower {
    service: Service,
    id: String,
    /// Number of the latest row that was read.
    read: i64,
    ready: VecDeque<JobEvent>,
    /// What was last said of the job.
    said: Option<Job>,
    ended: bool,
}

impl Service {
    /// What happens to a job, from the event after number `after` on. It ends with
    /// [`JobEvent::Ended`], or without it where the process stops or the job is
    /// deleted. `None`: the reader has seen the end.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is no such job.
    pub async fn events(
        &self,
        id: &str,
        after: i64,
    ) -> Result<Option<impl Stream<Item = JobEvent> + Send + use<>>, ServiceError> {
        let job = self.job(id).await?;
        let mut read = after.max(0);
        if read > 0 && self.store.history(&self.reach, id, read - 1, 1).await?.is_empty() {
            // No row has that number: that of the end, or one that was never given.
            if job.row.status.is_final() {
                return Ok(None);
            }
            read = 0;
        }
        let follower = Follower {
            service: self.clone(),
            id: id.to_owned(),
            read,
            ready: VecDeque::new(),
            said: None,
            ended: false,
        };
        let next = |mut follower: Follower| async {
            let event = follower.next().await?;
            Some((event, follower))
        };
        Ok(Some(unfold(follower, next)))
    }
}

impl Follower {
    async fn next(&mut self) -> Option<JobEvent> {
        let signals = std::sync::Arc::clone(&self.service.signals);
        loop {
            if let Some(event) = self.ready.pop_front() {
                return Some(event);
            }
            if self.ended {
                return None;
            }
            let mut changed = pin!(signals.changed());
            // Before looking: what happens in between is not missed.
            changed.as_mut().enable();
            match self.read().await {
                Ok(()) if !self.ready.is_empty() => continue,
                Ok(()) => {}
                Err(ServiceError::Unknown { .. }) => return None,
                Err(error) => warn!(job = self.id, %error, "the history cannot be followed"),
            }
            tokio::select! {
                () = changed => {}
                () = tokio::time::sleep(LOOK_AGAIN) => {}
                () = signals.stopped() => return None,
            }
        }
    }

    async fn read(&mut self) -> Result<(), ServiceError> {
        let _place = self.service.places.following.take(&self.service.reach.owner).await?;
        // The job first: once it has ended its history is complete.
        let job = self.service.job(&self.id).await?;
        let rows =
            self.service.store.history(&self.service.reach, &self.id, self.read, BATCH).await?;
        let complete = rows.len() < BATCH as usize;
        for point in rows {
            self.read = point.seq + 1;
            let row = convergence_row(point);
            self.ready.push_back(JobEvent::Row { number: self.read, row });
        }
        if complete && job.row.status.is_final() {
            self.ended = true;
            let number = self.read + 1;
            self.ready.push_back(JobEvent::Ended { number, job: Box::new(job) });
        } else if self.said.as_ref() != Some(&job) {
            self.said = Some(job.clone());
            self.ready.push_back(JobEvent::Changed(Box::new(job)));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use futures_util::StreamExt;

    use super::*;
    use crate::service::testing::Scripted;
    use crate::service::{Signals, Submission, Upload};
    use crate::store::{FileRow, Sqlite};

    #[tokio::test]
    async fn whoever_follows_waits_for_a_place_to_read_and_nobody_else_does() {
        let folder = tempfile::tempdir().unwrap();
        let store = Arc::new(Sqlite::open(folder.path()).await.unwrap());
        let service = Service::new(store, Arc::new(Scripted), Arc::new(Signals::default()));
        let (name, content_type) = ("a.csv".to_owned(), "text/csv".to_owned());
        let files = vec![FileRow { name, content_type, bytes: b"any".to_vec() }];
        let upload = Upload { files, ..Upload::default() };
        let measured = service.add_measurement(upload, None).await.unwrap();
        let measurement_id = measured.resource.row.id;
        let submission =
            Submission { measurement_id, kind: "identify".into(), ..Submission::default() };
        let id = service.submit(&submission, None).await.unwrap().resource.row.id;

        let soon = Duration::from_millis(100);
        let mut taken = Vec::new();
        let follows = &service.places.following;
        while let Ok(place) = tokio::time::timeout(soon, follows.take("")).await {
            taken.push(place.unwrap());
        }
        let mut events = Box::pin(service.events(&id, 0).await.unwrap().unwrap());
        assert!(tokio::time::timeout(soon, events.next()).await.is_err());
        assert_eq!(service.job(&id).await.unwrap().row.id, id);
        drop(taken);
        assert!(matches!(events.next().await, Some(JobEvent::Changed(_))));
    }
}
