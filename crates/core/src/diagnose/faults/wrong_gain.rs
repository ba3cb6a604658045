//! Another gain of one level or experiment, or another delay of one record, looked for before any effect
//! is tried.

use crate::answers::FaultKind;
use crate::diagnose::doubt::{Halt, Suspicion};
use crate::diagnose::selection::evidence::NoiseScale;
use crate::diagnose::selection::models::Models;
use crate::identify::{FitSession, Intervals};

use super::of_records;
use super::readings;
use super::suspects::{Suspected, Suspects};

/// Another gain of one level of a table, or another gain or delay of one experiment of a record, that,
/// beside the base model, leaves only noise. No effect of a machine does the same to every frequency and
/// harmonic of one level, so none is tried before. For measurements that are so far from the noise that they are weighed by the
/// response first: with these weights no fault is looked for.
pub(in crate::diagnose) fn alone(session: &FitSession<'_>, seed: u64) -> Option<Halt> {
    let as_measured = readings::as_measured(session)?;
    let base = session.judge(session.base(), Intervals::Curvature).ok()?;
    let models = Models::new(session.base().clone(), NoiseScale::of(session));
    let (base, models) = (&base, &models);
    let suspects = Suspects { session, base, models, combined: false, seed, lead_s: 0.0 };
    let (found, wanted): (_, &[FaultKind]) = match session.has_cosines_alone() {
        true => (suspects.beside_the_base_model()?, &[FaultKind::LevelGain]),
        false => (
            of_records::another_run_beside_the_base_model(&suspects)?,
            &[FaultKind::RunGain, FaultKind::RunPhase],
        ),
    };
    let Suspected { faults, .. } = found;
    let is_wanted = matches!(faults.as_slice(), [fault] if wanted.contains(&fault.fault));
    is_wanted.then(|| Halt::Faults(Box::new(Suspicion { faults, as_measured })))
}
