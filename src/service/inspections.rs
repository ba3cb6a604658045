//! Measurements looked at before anything is computed of them.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use servoscope_core::answers::Inspection;
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::observer::Observer;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::measurements::sources;
use super::{Service, ServiceError, aside, curves};

/// Inspections that are kept: a page that is opened again answers at once.
const KEPT: usize = 64;

/// Inspections of this process: at most one is computed at a time, so that jobs keep their
/// processors.
pub(super) struct Inspections {
    turn: Arc<Semaphore>,
    known: Mutex<Vec<(String, Inspection)>>,
}

impl Default for Inspections {
    fn default() -> Self {
        Self { turn: Arc::new(Semaphore::new(1)), known: Mutex::default() }
    }
}

impl Inspections {
    /// Waits until nothing else is looked at or planned.
    pub(super) async fn turn(&self) -> Option<OwnedSemaphorePermit> {
        // It is never closed.
        Arc::clone(&self.turn).acquire_owned().await.ok()
    }

    fn known(&self, id: &str) -> Option<Inspection> {
        let known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.iter().find(|(of, _)| of == id).map(|(_, inspection)| inspection.clone())
    }

    fn keep(&self, id: &str, inspection: &Inspection) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|(of, _)| of != id);
        known.push((id.to_owned(), inspection.clone()));
        let surplus = known.len().saturating_sub(KEPT);
        known.drain(..surplus);
    }
}

/// Stops a computation when the request that waits for it is gone.
pub(super) struct Gone(pub Arc<AtomicBool>);

impl Drop for Gone {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// An observer that only says whether the request is gone.
pub(super) struct WhileWaiting(pub Arc<AtomicBool>);

impl Observer for WhileWaiting {
    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

impl Service {
    /// Looks at a measurement: what looks wrong with it, and which effects it can show. It takes
    /// seconds, and ends when the caller no longer waits.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id; [`ServiceError::Uninspected`]
    /// where it cannot be inspected.
    pub async fn inspection(&self, id: &str) -> Result<Inspection, ServiceError> {
        self.measurement(id).await?;
        let files = self.store.measurement_files(&self.reach, id).await?;
        let flag = Arc::new(AtomicBool::new(false));
        let _gone = Gone(Arc::clone(&flag));
        let turn = self.inspections.turn().await;
        if let Some(known) = self.inspections.known(id) {
            return Ok(known);
        }
        let numerics = Arc::clone(&self.numerics);
        let looking = aside(move || {
            let _turn = turn;
            let measurement = numerics.read(&sources(&files))?;
            let request = IdentifyRequest::default();
            let found = numerics.inspect(&measurement, &request, &WhileWaiting(flag));
            found.map_err(|error| ServiceError::Uninspected { reason: error.to_string() })
        });
        let inspection = looking.await?;
        self.inspections.keep(id, &inspection);
        Ok(inspection)
    }

    /// Draws what was measured, as an SVG document.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn measurement_figure(&self, id: &str) -> Result<String, ServiceError> {
        self.with_measurement(id, |measurement| curves::draw(&measurement)).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inspection(obstacle: &str) -> Inspection {
        let obstacle = Some(obstacle.to_owned());
        Inspection { doubts: Vec::new(), detectability: None, obstacle }
    }

    #[test]
    fn the_oldest_inspection_makes_room() {
        let inspections = Inspections::default();
        for i in 0..=KEPT {
            inspections.keep(&i.to_string(), &inspection("it stands still"));
        }
        assert_eq!(inspections.known("0"), None);
        assert_eq!(inspections.known("1"), Some(inspection("it stands still")));
        inspections.keep("1", &inspection("it is gone"));
        assert_eq!(inspections.known("1"), Some(inspection("it is gone")));
    }

    #[test]
    fn a_request_that_is_gone_stops_its_computation() {
        let flag = Arc::new(AtomicBool::new(false));
        let watched = WhileWaiting(Arc::clone(&flag));
        assert!(!watched.cancelled());
        drop(Gone(flag));
        assert!(watched.cancelled());
    }
}
