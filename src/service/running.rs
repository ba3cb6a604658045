//! Running jobs: what the worker asks of the service.

use servoscope_core::answers::{Answer, Stage};
use servoscope_core::diagnose::{DiagnoseError, ValidateError};
use servoscope_core::identify::IdentifyError;
use servoscope_core::measurement::formats::ParseError;
use servoscope_core::observer::Observer;

use crate::store::{FileRow, StoreError};

use super::measurements::sources;
use super::{JobRequest, Service};

/// The files that a job works on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct JobFiles {
    measured: Vec<FileRow>,
    /// Of the second measurement, where there is one.
    second: Option<Vec<FileRow>>,
}

/// Why running a job gave no result.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The computation was asked to stop.
    #[error("cancelled")]
    Cancelled,
    /// The stored files cannot be read, by this version at least.
    #[error("reading the measurement: {0}")]
    Measurement(#[from] ParseError),
    /// The request stored with the job cannot be read, by this version at least.
    #[error("reading the request: {0}")]
    Request(serde_json::Error),
    /// The computation gave no answer.
    #[error(transparent)]
    Unanswered(IdentifyError),
    /// The second measurement cannot be used.
    #[error("the validation measurement cannot be used: {0}")]
    Validation(ValidateError),
    /// The second measurement is gone.
    #[error("the validation measurement was deleted before the job began")]
    Deleted,
    /// The result cannot be written as JSON.
    #[error("writing the result: {0}")]
    Result(serde_json::Error),
}

impl Service {
    /// The files that a job works on.
    ///
    /// # Errors
    /// When the database does not answer.
    pub(crate) async fn job_files(
        &self,
        measurement_id: &str,
        request: &str,
    ) -> Result<JobFiles, StoreError> {
        // A request that cannot be read is an error of the job: see `run`.
        let request = serde_json::from_str::<JobRequest>(request).ok();
        let second = request.and_then(|request| request.validation_measurement_id);
        Ok(JobFiles {
            measured: self.store.measurement_files(&self.reach, measurement_id).await?,
            second: match second {
                Some(id) => Some(self.store.measurement_files(&self.reach, &id).await?),
                None => None,
            },
        })
    }

    /// Computes a job's result, JSON, on the calling thread.
    ///
    /// # Errors
    /// See [`RunError`].
    pub(crate) fn run(
        &self,
        files: &JobFiles,
        request: &str,
        observer: &dyn Observer,
    ) -> Result<String, RunError> {
        let request: JobRequest = serde_json::from_str(request).map_err(RunError::Request)?;
        if files.second.as_ref().is_some_and(Vec::is_empty) {
            return Err(RunError::Deleted);
        }
        let measurement = self.numerics.read(&sources(&files.measured))?;
        let second = files.second.as_ref().map(|files| self.numerics.read(&sources(files)));
        let second = second.transpose()?;
        let answer = self.numerics.answer(
            request.kind,
            &measurement,
            second.as_ref(),
            &request.identify(),
            observer,
        )?;
        self.metrics.evaluated(request.kind.name(), evaluations(&answer));
        serde_json::to_string(&answer).map_err(RunError::Result)
    }
}

impl From<DiagnoseError> for RunError {
    fn from(error: DiagnoseError) -> Self {
        match error {
            DiagnoseError::Identify(IdentifyError::Cancelled) => RunError::Cancelled,
            DiagnoseError::Identify(error) => RunError::Unanswered(error),
            DiagnoseError::Validation(error) => RunError::Validation(error),
        }
    }
}

/// Simulations of the whole measurement that an answer took.
fn evaluations(answer: &Answer) -> u64 {
    let models = [Some(answer.base()), answer.extended()];
    Stage::evaluations_of(models.into_iter().flatten().flat_map(|model| &model.stages))
}
