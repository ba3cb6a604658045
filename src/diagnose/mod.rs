//! What a base model gets wrong, and where.
//!
//! A base model is fitted; what it leaves is laid out by magnitude, frequency,
//! harmonic and order of acquisition (`layout`), tested for being noise
//! (`statistics`, `whiteness`), and where it is not, the parts in which the
//! simulation departs most are found (`regions`, `patterns`) and said in words
//! (`sentence`); `discrepancy` puts it together.

mod anchor;
mod causes;
mod discrepancy;
mod evidence;
mod family;
mod groups;
mod layout;
mod next_experiment;
mod null;
mod patterns;
mod probes;
mod regions;
mod residual;
mod scan;
mod search;
mod sentence;
mod statistics;
mod subspace;
mod whiteness;

#[cfg(test)]
mod tests;

use crate::answers::{ConvergenceRow, Diagnosis, Discrepancy, Identification, Progress, Verdict};
use crate::identify::{self, Effort, IdentifyError, IdentifyRequest, Model, Workbench};
use crate::measurement::Measurement;
use crate::observer::Observer;

/// Share of the largest component below which a difference between model and data
/// is rounding in the upload and the simulation.
const ROUNDING: f64 = 2e-6;

/// Share of a diagnosis that is fitting.
const FITTING: f64 = 0.95;

use evidence::Yardstick;
use search::Search;

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

/// Fits the base model to a measurement and says where it is wrong, without
/// looking for the cause.
///
/// # Errors
/// See [`DiagnoseError`].
pub fn examine(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<(Identification, Discrepancy), DiagnoseError> {
    let fit = identify::fit_base(measurement, request, observer)?;
    let discrepancy = discrepancy::of(&fit, request.options.seed);
    Ok((fit.identification, discrepancy))
}

/// Fits the base model to a measurement, says where it is wrong, names the
/// effects it lacks and extends it with them.
///
/// # Errors
/// See [`DiagnoseError`].
pub fn diagnose(
    measurement: &Measurement,
    request: &IdentifyRequest,
    observer: &dyn Observer,
) -> Result<Diagnosis, DiagnoseError> {
    let seed = request.options.seed;
    let fitting = Fitting(observer);
    let workbench = Workbench::new(measurement, request, &fitting)?;
    let fit = workbench.judge(workbench.base())?;
    let progress = |done: u64, fraction: f64| {
        observer.progress(Progress { stage: "discrepancy".into(), done, total: 1, fraction });
    };
    progress(0, FITTING);
    let discrepancy = discrepancy::of(&fit, seed);
    progress(1, 1.0);
    let yardstick = Yardstick {
        known: workbench.noise_known(),
        rounding: workbench.rounding(ROUNDING),
        dof: fit.identification.fit.dof.max(1) as f64,
    };
    let mut search = Search::new(&workbench, observer, seed, yardstick);
    let noise_like =
        |model: &Model| workbench.judge(model).is_ok_and(|fit| discrepancy::is_noise(&fit, seed));
    let mut chosen = search.run(&mut |model| noise_like(model));
    let mut explained = discrepancy.noise_like;
    if !chosen.is_empty() {
        explained = noise_like(&search.visited[&chosen].model);
        if !explained && yardstick.known {
            // What remains widens every uncertainty.
            search.yardstick = Yardstick { known: false, ..yardstick };
            chosen = search.best_supported();
        }
    }
    if observer.cancelled() {
        return Err(IdentifyError::Cancelled.into());
    }
    let verdict = match (chosen.is_empty(), explained) {
        (true, true) => Verdict::Adequate,
        (true, false) => Verdict::Unexplained,
        (false, true) => Verdict::Explained,
        (false, false) => Verdict::Improved,
    };
    let extended = match chosen.is_empty() {
        true => None,
        false => {
            let model = workbench.refine(&search.visited[&chosen].model, Effort::Thorough);
            Some(workbench.judge(&model)?.identification)
        }
    };
    let causes = extended
        .as_ref()
        .map(|extended| causes::named(&search, &chosen, extended, explained))
        .unwrap_or_default();
    let next_experiment = causes.iter().find_map(|cause| {
        let (rival, model) = causes::rivals(&search, &chosen, &cause.effect).into_iter().next()?;
        let named = (&search.visited[&chosen].model, cause.effect.as_str());
        next_experiment::between(&workbench, named, (model, rival))
    });
    Ok(Diagnosis {
        verdict,
        limitations: discrepancy::limitations(&fit, &discrepancy),
        discrepancy,
        causes,
        candidates: causes::candidates(&search, &chosen),
        gain: None,
        provenance: fit.identification.provenance.clone(),
        base: fit.identification,
        extended,
        next_experiment,
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
