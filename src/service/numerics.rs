//! The numeric core as the service sees it.

use std::borrow::Cow;

use servoscope_core::answers::{
    Answer, Comparison, Diagnosis, Identification, Inspection, JobKind, MeasurementFault, Plan,
    PlanRequest, Validation,
};
use servoscope_core::diagnose::{self, DiagnoseError, PlanError, ValidateError};
use servoscope_core::identify::{self, IdentifyError, IdentifyRequest};
use servoscope_core::measurement::formats::{self, ParseError, Source};
use servoscope_core::measurement::{InvalidMeasurement, Measurement};
use servoscope_core::observer::Observer;

/// Everything the service asks of the numeric core: a seam, so that queue,
/// cancellation and failure can be tested without minutes of computation.
pub trait Numerics: Send + Sync + 'static {
    /// Reads one or several files that together form one measurement.
    ///
    /// # Errors
    /// The first thing that is wrong.
    fn read(&self, sources: &[Source<'_>]) -> Result<Measurement, ParseError>;

    /// Fits the base model to a measurement.
    ///
    /// # Errors
    /// See [`IdentifyError`].
    fn identify(
        &self,
        measurement: &Measurement,
        request: &IdentifyRequest,
        observer: &dyn Observer,
    ) -> Result<Identification, IdentifyError>;

    /// Simulates an identified model on a measurement's own excitations.
    ///
    /// # Errors
    /// See [`IdentifyError`].
    fn compare(
        &self,
        measurement: &Measurement,
        answer: &Identification,
    ) -> Result<Comparison, IdentifyError>;

    /// Fits the base model, says where it is wrong, names the effects it lacks and
    /// extends it with them; what that gains is measured on `second`, if there is one.
    ///
    /// # Errors
    /// See [`DiagnoseError`].
    fn diagnose(
        &self,
        measurement: &Measurement,
        second: Option<&Measurement>,
        request: &IdentifyRequest,
        observer: &dyn Observer,
    ) -> Result<Diagnosis, DiagnoseError>;

    /// Looks at a measurement before it is diagnosed: what looks wrong with it, and which effects
    /// it can show at which size.
    ///
    /// # Errors
    /// See [`DiagnoseError`].
    fn inspect(
        &self,
        measurement: &Measurement,
        request: &IdentifyRequest,
        observer: &dyn Observer,
    ) -> Result<Inspection, DiagnoseError> {
        diagnose::inspect(measurement, request, observer)
    }

    /// Plans experiments before anything is measured.
    ///
    /// # Errors
    /// See [`PlanError`].
    fn plan(&self, request: &PlanRequest, observer: &dyn Observer) -> Result<Plan, PlanError> {
        diagnose::plan(request, observer)
    }

    /// Tries the models of an answer on another measurement.
    ///
    /// # Errors
    /// See [`ValidateError`].
    fn validate(
        &self,
        answer: &Answer,
        measurement: &Measurement,
        observer: &dyn Observer,
    ) -> Result<Validation, ValidateError>;

    /// The measurement as an answer understands it: without the faults that it found, but with every
    /// row.
    ///
    /// # Errors
    /// If nothing is left of it.
    fn understood<'m>(
        &self,
        measurement: &'m Measurement,
        faults: &[MeasurementFault],
    ) -> Result<Cow<'m, Measurement>, InvalidMeasurement> {
        diagnose::as_understood(measurement, faults)
    }

    /// Answers a question of either kind.
    ///
    /// # Errors
    /// See [`DiagnoseError`].
    fn answer(
        &self,
        kind: JobKind,
        measurement: &Measurement,
        second: Option<&Measurement>,
        request: &IdentifyRequest,
        observer: &dyn Observer,
    ) -> Result<Answer, DiagnoseError> {
        Ok(match kind {
            JobKind::Identify => self.identify(measurement, request, observer)?.into(),
            JobKind::Diagnose => self.diagnose(measurement, second, request, observer)?.into(),
        })
    }
}

/// The numeric core of this crate.
#[derive(Debug, Clone, Copy, Default)]
pub struct BuiltIn;

impl Numerics for BuiltIn {
    fn read(&self, sources: &[Source<'_>]) -> Result<Measurement, ParseError> {
        formats::read(sources)
    }

    fn identify(
        &self,
        measurement: &Measurement,
        request: &IdentifyRequest,
        observer: &dyn Observer,
    ) -> Result<Identification, IdentifyError> {
        identify::identify(measurement, request, observer)
    }

    fn compare(
        &self,
        measurement: &Measurement,
        answer: &Identification,
    ) -> Result<Comparison, IdentifyError> {
        identify::compare(measurement, answer)
    }

    fn diagnose(
        &self,
        measurement: &Measurement,
        second: Option<&Measurement>,
        request: &IdentifyRequest,
        observer: &dyn Observer,
    ) -> Result<Diagnosis, DiagnoseError> {
        match second {
            Some(second) => diagnose::diagnose_validated(measurement, second, request, observer),
            None => diagnose::diagnose(measurement, request, observer),
        }
    }

    fn validate(
        &self,
        answer: &Answer,
        measurement: &Measurement,
        observer: &dyn Observer,
    ) -> Result<Validation, ValidateError> {
        diagnose::validate(answer, measurement, observer)
    }
}
