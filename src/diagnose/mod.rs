//! What a base model gets wrong, and where.
//!
//! A base model is fitted; what it leaves is laid out by magnitude, frequency,
//! harmonic and order of acquisition (`layout`), tested for being noise
//! (`statistics`, `whiteness`), and where it is not, the parts in which the
//! simulation departs most are found (`regions`, `patterns`) and said in words
//! (`sentence`); `discrepancy` puts it together.

mod discrepancy;
mod groups;
mod layout;
mod patterns;
mod regions;
mod residual;
mod sentence;
mod statistics;
mod subspace;
mod whiteness;

#[cfg(test)]
mod tests;

use crate::answers::{ConvergenceRow, Diagnosis, Progress, Verdict};
use crate::identify::{self, IdentifyError, IdentifyRequest};
use crate::measurement::Measurement;
use crate::observer::Observer;

/// Share of a diagnosis that is fitting.
const FITTING: f64 = 0.95;

/// Why a diagnosis gave no answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DiagnoseError {
    /// The base model could not be fitted.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
}

impl From<DiagnoseError> for IdentifyError {
    fn from(DiagnoseError::Identify(error): DiagnoseError) -> Self {
        error
    }
}

/// Fits the base model to a measurement and says where it is wrong.
///
/// # Errors
/// See [`DiagnoseError`].
pub fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    let fit = identify::fit_base(measurement, request, &Fitting(observer))?;
    let progress = |done: u64, fraction: f64| {
        observer.progress(Progress { stage: "discrepancy".into(), done, total: 1, fraction });
    };
    progress(0, FITTING);
    let discrepancy = discrepancy::of(&fit, request.options.seed);
    progress(1, 1.0);
    if observer.cancelled() {
        return Err(IdentifyError::Cancelled.into());
    }
    let verdict = if discrepancy.noise_like { Verdict::Adequate } else { Verdict::Unexplained };
    Ok(Diagnosis {
        verdict,
        limitations: discrepancy::limitations(&fit, &discrepancy),
        discrepancy,
        causes: Vec::new(),
        candidates: Vec::new(),
        gain: None,
        provenance: fit.identification.provenance.clone(),
        base: fit.identification,
        extended: None,
        next_experiment: None,
    })
}

/// The observer of the fit, which is not the whole.
struct Fitting<'a>(&'a dyn Observer);

impl Observer for Fitting<'_> {
    fn elapsed_s(&self) -> f64 {
        self.0.elapsed_s()
    }

    fn progress(&self, progress: Progress) {
        self.0.progress(Progress { fraction: FITTING * progress.fraction, ..progress });
    }

    fn row(&self, row: ConvergenceRow) {
        self.0.row(row);
    }

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
