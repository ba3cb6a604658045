//! Places for what is computed while a request waits: reading files, drawing, inspecting, planning.
//!
//! There are few, so that jobs and answers keep their processors, and one caller never has all of
//! them: whoever sends many requests at once waits for its own.

use std::collections::HashMap;
use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::store::FileRow;

use super::{Service, ServiceError, aside};

/// How long a request usually waits for its place.
const PATIENCE: Duration = Duration::from_secs(300);

/// The places of this process.
pub(super) struct AllPlaces {
    /// For what is computed in a moment: reading files, drawing.
    pub short: Places,
    /// For what takes seconds: inspecting and planning, one thing at a time.
    pub long: Places,
    /// For those who follow jobs: however many they are, others reach the store.
    pub following: Places,
}

impl Default for AllPlaces {
    fn default() -> Self {
        let short = Places::on_this_machine();
        Self { short, long: Places::new(1), following: Places::on_this_machine() }
    }
}

/// Places, shared by all callers.
pub(super) struct Places {
    all: Arc<Semaphore>,
    /// How many of them one caller may have.
    each: usize,
    /// How long a request waits for its place.
    patience: Duration,
    /// Of each caller that has or awaits one.
    callers: Mutex<HashMap<String, Arc<Semaphore>>>,
}

/// A place that is taken; it is free again when this and all its copies are dropped.
#[derive(Clone)]
pub(super) struct Place {
    _of_caller_and_of_all: Arc<[OwnedSemaphorePermit; 2]>,
}

impl Places {
    /// So many, of which one caller may have all but one.
    fn new(count: usize) -> Self {
        let all = Arc::new(Semaphore::new(count));
        let each = count.saturating_sub(1).max(1);
        Self { all, each, patience: PATIENCE, callers: Mutex::default() }
    }

    /// One for each processor, and two more: a page asks for several things at once, and what is quick
    /// should not wait for what is slow.
    fn on_this_machine() -> Self {
        Self::new(std::thread::available_parallelism().map_or(1, NonZeroUsize::get) + 2)
    }

    /// Waits for a place for a caller.
    ///
    /// # Errors
    /// [`ServiceError::Busy`] if there is none for long.
    pub(super) async fn take(&self, caller: &str) -> Result<Place, ServiceError> {
        let own = self.of(caller);
        let both = async {
            let of_caller = own.acquire_owned().await;
            (of_caller, Arc::clone(&self.all).acquire_owned().await)
        };
        match tokio::time::timeout(self.patience, both).await {
            Ok((Ok(of_caller), Ok(of_all))) => {
                Ok(Place { _of_caller_and_of_all: Arc::new([of_caller, of_all]) })
            }
            // They are never closed.
            Ok(_) | Err(_) => Err(ServiceError::Busy),
        }
    }

    fn of(&self, caller: &str) -> Arc<Semaphore> {
        let mut callers = self.callers.lock().unwrap_or_else(PoisonError::into_inner);
        callers.retain(|_, places| Arc::strong_count(places) > 1);
        let new = || Arc::new(Semaphore::new(self.each));
        Arc::clone(callers.entry(caller.to_owned()).or_insert_with(new))
    }
}

impl Place {
    /// Computes in this place, off the threads that answer requests.
    pub(super) async fn compute<T: Send + 'static>(
        &self,
        compute: impl FnOnce() -> T + Send + 'static,
    ) -> T {
        // The thread keeps the place: it computes on where the request is gone.
        let place = self.clone();
        let computing = aside(move || {
            let _place = place;
            compute()
        });
        computing.await
    }
}

impl Service {
    /// A place for what is computed in a moment, as soon as the caller has one.
    ///
    /// # Errors
    /// [`ServiceError::Busy`] if there is none for long.
    pub(super) async fn place(&self) -> Result<Place, ServiceError> {
        self.places.short.take(&self.reach.owner).await
    }

    /// The same with the files of a measurement. They are read once there is a place: however many
    /// wait, none of them holds files in memory.
    ///
    /// # Errors
    /// [`ServiceError::Busy`]; [`ServiceError::Unknown`] where the measurement is gone by then.
    pub(super) async fn place_with_files(
        &self,
        measurement: &str,
    ) -> Result<(Place, Vec<FileRow>), ServiceError> {
        let place = self.place().await?;
        Ok((place, self.files_of(measurement).await?))
    }

    /// The files of a measurement, for whoever has a place.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] where there is none with this id.
    pub(super) async fn files_of(&self, measurement: &str) -> Result<Vec<FileRow>, ServiceError> {
        let files = self.store.measurement_files(&self.reach, measurement).await?;
        match files.is_empty() {
            false => Ok(files),
            true => Err(ServiceError::Unknown { what: "measurement", id: measurement.into() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::testing::Scripted;
    use crate::service::{Signals, Upload};
    use crate::store::Sqlite;

    /// Whether there is a place at once.
    async fn taken(places: &Places, caller: &str) -> Option<Place> {
        let taking = tokio::time::timeout(Duration::from_millis(50), places.take(caller));
        taking.await.ok().and_then(Result::ok)
    }

    #[tokio::test]
    async fn a_caller_that_waits_for_its_own_places_leaves_one_to_others() {
        let places = Places::new(3);
        let mut rig =
            vec![taken(&places, "rig").await.unwrap(), taken(&places, "rig").await.unwrap()];
        assert!(taken(&places, "rig").await.is_none());
        let other = taken(&places, "other").await.unwrap();
        assert!(taken(&places, "third").await.is_none(), "all are taken");
        drop(other);
        assert!(taken(&places, "third").await.is_some());
        rig.pop();
        assert!(taken(&places, "rig").await.is_some());
    }

    #[tokio::test]
    async fn nothing_is_kept_of_callers_that_are_gone() {
        let places = Places::new(2);
        for caller in 0..100 {
            drop(places.take(&caller.to_string()).await.unwrap());
        }
        assert!(places.callers.lock().unwrap().len() <= 1);
    }

    /// A service over an empty store, and a measurement in it.
    async fn with_measurement(folder: &tempfile::TempDir) -> (Service, String) {
        let store = Arc::new(Sqlite::open(folder.path()).await.unwrap());
        let service = Service::new(store, Arc::new(Scripted), Arc::new(Signals::default()));
        let (name, content_type) = ("a.csv".to_owned(), "text/csv".to_owned());
        let files = vec![FileRow { name, content_type, bytes: b"any".to_vec() }];
        let upload = Upload { files, ..Upload::default() };
        let id = service.add_measurement(upload, None).await.unwrap().resource.row.id;
        (service, id)
    }

    #[tokio::test]
    async fn files_are_read_by_whoever_has_a_place_and_not_by_those_who_wait() {
        let folder = tempfile::tempdir().unwrap();
        let (service, id) = with_measurement(&folder).await;
        let soon = Duration::from_millis(100);
        let mut all = Vec::new();
        for places in [&service.places.short, &service.places.long] {
            while let Ok(place) = tokio::time::timeout(soon, places.take("")).await {
                all.push(place.unwrap());
            }
        }
        let mut waiting = [
            tokio::spawn({
                let (service, id) = (service.clone(), id.clone());
                async move { service.measurement_csv(&id).await.err() }
            }),
            tokio::spawn({
                let (service, id) = (service.clone(), id.clone());
                async move { service.preview_reading(&id, None).await.err() }
            }),
            tokio::spawn({
                let (service, id) = (service.clone(), id.clone());
                async move { service.inspection(&id).await.err() }
            }),
        ];
        for waiting in &mut waiting {
            assert!(tokio::time::timeout(soon, waiting).await.is_err(), "there is no place");
        }
        // Had they read its files by now, they would not notice.
        service.delete_measurement(&id).await.unwrap();
        drop(all);
        for waiting in waiting {
            let error = waiting.await.unwrap();
            assert!(matches!(error, Some(ServiceError::Unknown { .. })), "{error:?}");
        }
    }

    #[tokio::test]
    async fn an_inspection_that_is_kept_needs_no_place() {
        let folder = tempfile::tempdir().unwrap();
        let (service, id) = with_measurement(&folder).await;
        let found = service.inspection(&id).await.unwrap();
        let _only = service.places.long.take("rig").await.unwrap();
        let again = tokio::time::timeout(Duration::from_secs(10), service.inspection(&id)).await;
        assert_eq!(again.expect("it does not wait").unwrap(), found);
    }

    #[tokio::test]
    async fn whoever_waits_for_too_long_is_told_to_come_again() {
        let places = Places { patience: Duration::from_millis(20), ..Places::new(1) };
        let _only = places.take("rig").await.unwrap();
        for caller in ["rig", "other"] {
            assert!(matches!(places.take(caller).await, Err(ServiceError::Busy)));
        }
    }
}
