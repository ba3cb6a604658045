//! Models fitted without one magnitude of the input.
//!
//! Where one level was measured with a gain far from the others', a fit of all levels is so wrong that
//! its linearisation does not tell which, and may have lost the friction. A search over the others is
//! right, and against what it finds the level stands out.

use crate::diagnose::residuals::layout::Layout;
use crate::diagnose::selection::models::{Key, Models};
use crate::identify::{DatumChange, FitAccuracy, FitSession, Model};
use crate::measurement::Complex;

use super::candidates;
use super::mending::LEFT_OUT;

/// Fewest levels: of two, neither is more likely to be the right one.
const FEWEST_LEVELS: usize = 3;

/// The base model and those of one effect, fitted to all levels but the one without which the base
/// model leaves least, with their cost there.
pub(super) fn fitted(
    session: &FitSession<'_>,
    models: &Models,
    layout: &Layout,
    wanted: impl Fn(&Key) -> bool,
) -> Vec<(Key, Model)> {
    let levels = candidates::levels(layout);
    if levels.len() < FEWEST_LEVELS {
        return Vec::new();
    }
    let left_out = levels.into_iter().filter_map(|level| {
        let rest = without(session, level);
        let base = rest.searched_anew().ok()?;
        Some((rest, base))
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
