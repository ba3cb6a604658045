//! Models fitted without one magnitude of the input.
//!
//! Where one level was measured with a gain far from the others', a fit of all levels is so wrong that
//! its linearisation does not tell which. A fit of the others is right, and against it the level
//! stands out.

use crate::answers::{FaultKind, MeasurementFault};
use crate::diagnose::doubt::{Halt, Suspicion};
use crate::diagnose::selection::evidence::NoiseScale;
use crate::diagnose::selection::models::{Key, Models};
use crate::identify::{DatumChange, FitAccuracy, FitSession, Intervals, Model};
use crate::measurement::Complex;

use super::candidates;
use super::mending::LEFT_OUT;
use super::readings;
use super::suspects::{Suspected, Suspects};

/// Fewest levels: of two, neither is more likely to be the right one.
const FEWEST_LEVELS: usize = 3;

/// Another gain of one level that, beside the base model, leaves only noise. No effect of a machine
/// does the same to every frequency and harmonic of one level, so none is tried before.
pub(in crate::diagnose) fn wrong_gain(session: &FitSession<'_>, seed: u64) -> Option<Halt> {
    if !session.has_cosines_alone() {
        return None;
    }
    let base = session.judge(session.base(), Intervals::Curvature).ok()?;
    let models = Models::new(session.base().clone(), NoiseScale::of(session));
    let suspects = Suspects { session, base: &base, models: &models, combined: false, seed };
    let Suspected { faults, .. } = suspects.beside_one_level_out(|_| true)?;
    let is_gain = |fault: &MeasurementFault| fault.fault == FaultKind::LevelGain;
    let alone = faults.len() == 1 && faults.iter().all(is_gain);
    let as_measured = readings::as_measured(session)?;
    alone.then(|| Halt::Faults(Box::new(Suspicion { faults, as_measured })))
}

/// The base model and those of one effect, fitted to all levels but the one without which the base
/// model leaves least, with their cost there.
pub(super) fn fitted(suspects: &Suspects<'_>, wanted: impl Fn(&Key) -> bool) -> Vec<(Key, Model)> {
    let Suspects { session, models, .. } = *suspects;
    let levels = candidates::levels(&suspects.layout());
    if levels.len() < FEWEST_LEVELS {
        return Vec::new();
    }
    let left_out = levels.into_iter().map(|level| {
        let rest = without(session, level);
        let base = rest.refine(session.base(), FitAccuracy::Settle);
        (rest, base)
    });
    let Some((rest, base)) = left_out.min_by(|a, b| a.1.cost.total_cmp(&b.1.cost)) else {
        return Vec::new();
    };
    let alone = models.all().filter(|(key, _)| key.len() == 1 && wanted(key));
    let with_effect =
        alone.map(|(key, model)| (key.clone(), rest.refine(model, FitAccuracy::Glance)));
    std::iter::once((Key::new(), base)).chain(with_effect).collect()
}

/// A session in which one level does not count.
fn without<'a>(session: &FitSession<'a>, level: f64) -> FitSession<'a> {
    let experiments = session.measurement().experiments();
    session.changed(|experiment, _| {
        let leave_out = experiments[experiment].magnitude == level;
        let deviation = if leave_out { LEFT_OUT } else { 1.0 };
        DatumChange { factor: Complex::new(1.0, 0.0), deviation }
    })
}
