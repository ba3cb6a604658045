//! Models fitted without the rows that they predict worst (least trimmed squares).
//!
//! Several wrong rows together pull a fit so far that right ones stand out beside it. So each fit leaves
//! out the tenth of the rows that the one before predicts worst, until these are the same
//! (concentration steps: P. J. Rousseeuw, K. Van Driessen 2006, doi:10.1007/s10618-005-0024-4).

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::diagnose::residuals::residual::Residuals;
use crate::diagnose::selection::models::{Key, Models};
use crate::identify::{DatumChange, FitAccuracy, FitSession, Intervals, Model};
use crate::measurement::Complex;

use super::mending::LEFT_OUT;
use super::scan::LARGEST_SHARE;

/// Most models that are fitted so: those that leave least of all rows.
const MOST_MODELS: usize = 4;

/// Most fits of a model, if the rows that are left out still change.
const MOST_FITS: usize = 10;

/// A harmonic of an experiment.
type Row = (usize, usize);

/// The models of one effect at most that leave least, fitted without the rows that they predict worst.
pub(super) fn fitted(
    session: &FitSession<'_>,
    models: &Models,
    wanted: impl Fn(&Key) -> bool,
) -> Vec<(Key, Model)> {
    let is_tried = |key: &&Key| key.len() <= 1 && wanted(key);
    let mut tried: Vec<(&Key, &Model)> = models.all().filter(|(key, _)| is_tried(key)).collect();
    tried.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    tried.truncate(MOST_MODELS);
    let fit = |(key, model): (&Key, &Model)| Some((key.clone(), concentrated(session, model)?));
    tried.into_par_iter().filter_map(fit).collect()
}

/// The model fitted without the rows that it predicts worst.
fn concentrated(session: &FitSession<'_>, model: &Model) -> Option<Model> {
    let mut model = model.clone();
    let mut left_out = BTreeSet::new();
    for _ in 0..MOST_FITS {
        let worst = worst(session, &model)?;
        if worst == left_out {
            break;
        }
        left_out = worst;
        model = without(session, &left_out).refine(&model, FitAccuracy::Settle);
    }
    Some(model)
}

/// The tenth of the rows that a model predicts worst.
fn worst(session: &FitSession<'_>, model: &Model) -> Option<BTreeSet<Row>> {
    let residuals = Residuals::of(&session.judge(model, Intervals::Curvature).ok()?);
    let cells = residuals.layout.cells.iter();
    let size = |row: usize| residuals.values[row].powi(2);
    let mut rows: Vec<(f64, Row)> = cells
        .map(|cell| (cell.each_row().map(size).sum(), (cell.experiment, cell.order)))
        .collect();
    rows.sort_by(|a, b| b.0.total_cmp(&a.0));
    rows.truncate((LARGEST_SHARE * rows.len() as f64) as usize);
    Some(rows.into_iter().map(|(_, row)| row).collect())
}

/// A session in which these rows do not count.
fn without<'a>(session: &FitSession<'a>, rows: &BTreeSet<Row>) -> FitSession<'a> {
    session.changed(|experiment, order| {
        let deviation = if rows.contains(&(experiment, order)) { LEFT_OUT } else { 1.0 };
        DatumChange { factor: Complex::new(1.0, 0.0), deviation }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::selection::evidence::NoiseScale;
    use crate::diagnose::tests::{exact, noisy, request};
    use crate::machines::draw::NoiseStatement;
    use crate::measurement::{Measurement, Metadata};
    use crate::observer::Silent;

    /// A row is clearly wrong if it is off by more than so many standard deviations.
    const CLEARLY: f64 = 10.0;

    // Eight rows are clearly wrong, fewer than are left out.
    #[test]
    fn a_trimmed_fit_leaves_out_every_row_that_is_clearly_wrong_and_a_fit_of_all_rows_hides_some() {
        let mut experiments = noisy(&exact(), NoiseStatement::Std, 4).experiments().to_vec();
        let mut wrong = BTreeSet::new();
        for (index, experiment) in experiments.iter_mut().enumerate() {
            for harmonic in experiment.response.iter_mut() {
                if (index + harmonic.order) % 11 == 0 {
                    let off = 0.3 * harmonic.value;
                    harmonic.value += off;
                    let is_clear = off.norm() > CLEARLY * harmonic.std.unwrap();
                    wrong.extend(is_clear.then_some((index, harmonic.order)));
                }
            }
        }
        let spoilt =
            Measurement::new(Metadata::default(), experiments, Vec::new(), String::new()).unwrap();
        let request = request();
        let session = &FitSession::new(&spoilt, &request, &Silent).unwrap();
        let models = &Models::new(session.base().clone(), NoiseScale::of(session));
        let found = fitted(session, models, |_| true);
        let hidden = |model: &Model| wrong.difference(&worst(session, model).unwrap()).count();
        assert_eq!((wrong.len(), hidden(&found[0].1)), (8, 0));
        assert!(hidden(session.base()) > 0);
    }
}
