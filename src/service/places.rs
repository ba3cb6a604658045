//! Places for what is computed while a request waits: reading files, drawing, inspecting, planning.
//!
//! There are few, so that jobs and answers keep their processors, and one caller never has all of
//! them: whoever sends many requests at once waits for its own.

use std::collections::HashMap;
use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

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

/// A place that is taken; it is free again when this is dropped.
pub(super) struct Place {
    _of_caller: OwnedSemaphorePermit,
    _of_all: OwnedSemaphorePermit,
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
            Ok((Ok(of_caller), Ok(of_all))) => Ok(Place { _of_caller: of_caller, _of_all: of_all }),
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

impl Service {
    /// Computes off the threads that answer requests, once the caller has a place.
    ///
    /// # Errors
    /// [`ServiceError::Busy`] if there is none for long.
    pub(super) async fn in_place<T: Send + 'static>(
        &self,
        compute: impl FnOnce() -> T + Send + 'static,
    ) -> Result<T, ServiceError> {
        let place = self.places.short.take(&self.reach.owner).await?;
        // The thread keeps the place: it computes on where the request is gone.
        let computing = aside(move || {
            let _place = place;
            compute()
        });
        Ok(computing.await)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[tokio::test]
    async fn whoever_waits_for_too_long_is_told_to_come_again() {
        let places = Places { patience: Duration::from_millis(20), ..Places::new(1) };
        let _only = places.take("rig").await.unwrap();
        for caller in ["rig", "other"] {
            assert!(matches!(places.take(caller).await, Err(ServiceError::Busy)));
        }
    }
}
