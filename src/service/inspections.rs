//! Measurements looked at before anything is computed of them.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use servoscope_core::answers::{Inspection, Plan};
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::observer::Observer;

use super::kept::Kept;
use super::measurements::sources;
use super::{Measured, Service, ServiceError, curves};

/// Inspections that are kept: a page that is opened again answers at once.
const INSPECTIONS: usize = 64;
/// Plans that are kept: a page asks for a plan, its figure and its excitation one after the other.
const PLANS: usize = 16;

/// What was computed while a request waited, and may be asked for again.
pub(super) struct Asked {
    inspections: Kept<Inspection>,
    pub(super) plans: Kept<Arc<Plan>>,
}

impl Default for Asked {
    fn default() -> Self {
        Self { inspections: Kept::new(INSPECTIONS), plans: Kept::new(PLANS) }
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
    /// where it cannot be inspected; [`ServiceError::TooCostly`]; [`ServiceError::Busy`].
    pub async fn inspection(&self, id: &str) -> Result<Inspection, ServiceError> {
        let Measured { row, .. } = self.measurement(id).await?;
        self.check_inspection(&row)?;
        if let Some(known) = self.asked.inspections.get(&row.sha256) {
            return Ok(known);
        }
        let flag = Arc::new(AtomicBool::new(false));
        let _gone = Gone(Arc::clone(&flag));
        let place = self.places.long.take(&self.reach.owner).await?;
        // Whoever had the place before may have looked at the same.
        if let Some(known) = self.asked.inspections.get(&row.sha256) {
            return Ok(known);
        }
        let files = self.files_of(id).await?;
        let numerics = Arc::clone(&self.numerics);
        let looking = place.compute(move || {
            let measurement = numerics.read(&sources(&files))?;
            let request = IdentifyRequest::default();
            let found = numerics.inspect(&measurement, &request, &WhileWaiting(flag));
            found.map_err(|error| ServiceError::Uninspected { reason: error.to_string() })
        });
        let inspection = looking.await?;
        self.asked.inspections.keep(&row.sha256, inspection.clone());
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

    #[test]
    fn a_request_that_is_gone_stops_its_computation() {
        let flag = Arc::new(AtomicBool::new(false));
        let watched = WhileWaiting(Arc::clone(&flag));
        assert!(!watched.cancelled());
        drop(Gone(flag));
        assert!(watched.cancelled());
    }
}
