//! Trying a result on another measurement.

use std::sync::Arc;

use servoscope_core::answers::Validation;
use servoscope_core::diagnose::ValidateError;
use servoscope_core::observer::Silent;

use super::measurements::sources;
use super::{Measured, Service, ServiceError};

impl Service {
    /// Simulates the models of a job's result on another measurement. Nothing is
    /// stored: it takes a second at most.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] for the job or the measurement,
    /// [`ServiceError::Request`] where the models cannot be tried on it,
    /// [`ServiceError::TooCostly`]; otherwise as [`Service::result`].
    pub async fn validate(
        &self,
        job_id: &str,
        measurement_id: &str,
    ) -> Result<Validation, ServiceError> {
        let answer = self.answer(job_id).await?;
        let Measured { row, .. } = self.measurement(measurement_id).await?;
        self.check_validation(&row)?;
        let (place, files) = self.place_with_files(measurement_id).await?;
        let numerics = Arc::clone(&self.numerics);
        let trying = place.compute(move || {
            let measurement = numerics.read(&sources(&files))?;
            numerics.validate(&answer, &measurement, &Silent).map_err(refused)
        });
        trying.await
    }
}

fn refused(error: ValidateError) -> ServiceError {
    ServiceError::Request { member: "measurement_id".into(), reason: error.to_string() }
}
