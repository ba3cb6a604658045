//! A numeric core that does at once what a test wants.

use std::time::Duration;

use servoscope_core::answers::{
    Answer, Comparison, ConvergenceRow, Diagnosis, Identification, Plan, PlanRequest, Progress,
    Validation,
};
use servoscope_core::diagnose::{DiagnoseError, PlanError, ValidateError};
use servoscope_core::identify::{IdentifyError, IdentifyRequest};
use servoscope_core::measurement::formats::{ParseError, Source};
use servoscope_core::measurement::{Complex, Experiment, Harmonic, Measurement, Metadata};
use servoscope_core::observer::Observer;

use super::Numerics;

/// Seed of a request that succeeds at once.
pub(crate) const SUCCEED: u64 = 1;
/// Seed of a request that computes until it is cancelled.
pub(crate) const RUN_UNTIL_CANCELLED: u64 = 2;
/// Seed of a request that panics.
pub(crate) const PANIC: u64 = 3;
/// Seed of a request whose data cannot be fitted.
pub(crate) const UNUSABLE: u64 = 4;

/// Seed of a request whose result cannot be tried on any measurement.
pub(crate) const INCOMPARABLE: u64 = 5;

/// Reads anything but what begins with `bad`; the seed says what happens then.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Scripted;

impl Numerics for Scripted {
    fn read(&self, sources: &[Source<'_>]) -> Result<Measurement, ParseError> {
        if let Some(bad) = sources.iter().find(|source| source.bytes.starts_with(b"bad")) {
            return Err(ParseError {
                file: bad.name.to_owned(),
                line: Some(3),
                column: Some("gain".into()),
                reason: "`x` is not a number".into(),
                lacks: Vec::new(),
            });
        }
        let experiment = |magnitude: f64, omega_rad_s: f64| Experiment {
            magnitude,
            omega_rad_s,
            input: vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)],
            input_mean_measured: false,
            mean_velocity: 0.0,
            rounding_std: 0.0,
            open_samples: None,
            bad_samples: None,
            clipping: None,
            range: None,
            unknown_input: Vec::new(),
            response: vec![Harmonic { order: 1, value: Complex::new(0.5, -0.5), std: None }],
            run: None,
            repeats: Vec::new(),
            from_record: false,
        };
        let metadata = Metadata {
            machine: Some("press 4".into()),
            axis: Some("x".into()),
            labels: [("site".to_owned(), "north".to_owned())].into(),
            ..Metadata::default()
        };
        let experiments = vec![experiment(1.0, 2.0), experiment(3.0, 20.0)];
        let notes = vec!["column `colour` is unknown and was not used".to_owned()];
        Ok(Measurement::new(metadata, experiments, notes, "00ff".into()).expect("it is valid"))
    }

    fn identify(
        &self,
        _measurement: &Measurement,
        request: &IdentifyRequest,
        observer: &dyn Observer,
    ) -> Result<Identification, IdentifyError> {
        let stage = "colony".to_owned();
        observer.progress(Progress {
            stage: "searching".to_owned(),
            done: 1,
            total: 2,
            fraction: 0.5,
            remaining_s: Some(12.5),
        });
        observer.row(ConvergenceRow {
            stage,
            cycle: 1,
            evaluations: 20,
            best: 0.125,
            mean: None,
            elapsed_s: observer.elapsed_s(),
        });
        match request.options.seed {
            RUN_UNTIL_CANCELLED => {
                while !observer.cancelled() {
                    std::thread::sleep(Duration::from_millis(1));
                }
                Err(IdentifyError::Cancelled)
            }
            PANIC => panic!("scripted panic"),
            UNUSABLE => Err(IdentifyError::Unusable { reason: "one frequency only".into() }),
            seed => {
                Ok(Identification { seed, ..servoscope_core::answers::sample::identification() })
            }
        }
    }

    fn compare(
        &self,
        _measurement: &Measurement,
        _answer: &Identification,
    ) -> Result<Comparison, IdentifyError> {
        Ok(servoscope_core::answers::sample::comparison())
    }

    fn diagnose(
        &self,
        measurement: &Measurement,
        second: Option<&Measurement>,
        request: &IdentifyRequest,
        observer: &dyn Observer,
    ) -> Result<Diagnosis, DiagnoseError> {
        let base = self.identify(measurement, request, observer)?;
        let validation = second.map(|_| servoscope_core::answers::sample::validation());
        Ok(Diagnosis { base, validation, ..servoscope_core::answers::sample::diagnosis() })
    }

    fn plan(&self, _request: &PlanRequest, _observer: &dyn Observer) -> Result<Plan, PlanError> {
        Ok(servoscope_core::answers::sample::plan())
    }

    fn validate(
        &self,
        answer: &Answer,
        _measurement: &Measurement,
        _observer: &dyn Observer,
    ) -> Result<Validation, ValidateError> {
        match answer.base().seed {
            INCOMPARABLE => Err(ValidateError::Unusable { reason: "no fc_minus".into() }),
            _ => Ok(servoscope_core::answers::sample::validation()),
        }
    }
}
