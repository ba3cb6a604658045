//! Another gain of one level, looked for before any effect is tried.

use crate::answers::{FaultKind, MeasurementFault};
use crate::diagnose::doubt::{Halt, Suspicion};
use crate::diagnose::selection::evidence::NoiseScale;
use crate::diagnose::selection::models::Models;
use crate::identify::{FitSession, Intervals};

use super::readings;
use super::suspects::{Suspected, Suspects};

/// Another gain of one level that, beside the base model, leaves only noise. No effect of a machine
/// does the same to every frequency and harmonic of one level, so none is tried before. For tables
/// that are so far from the noise that they are weighed by the response first: with these weights no
/// fault is looked for.
pub(in crate::diagnose) fn alone(session: &FitSession<'_>, seed: u64) -> Option<Halt> {
    if !session.has_cosines_alone() {
        return None;
    }
    let as_measured = readings::as_measured(session)?;
    let base = session.judge(session.base(), Intervals::Curvature).ok()?;
    let models = Models::new(session.base().clone(), NoiseScale::of(session));
    let suspects = Suspects { session, base: &base, models: &models, combined: false, seed };
    let Suspected { faults, .. } = suspects.beside_the_base_model()?;
    let is_gain = |fault: &MeasurementFault| fault.fault == FaultKind::LevelGain;
    (faults.len() == 1 && faults.iter().all(is_gain))
        .then(|| Halt::Faults(Box::new(Suspicion { faults, as_measured })))
}
