//! Whether rows that were left out form regions.
//!
//! What a model lacks varies smoothly with the frequency, so that the rows that speak most against a
//! wrong model are neighbours, and depart from it in the same direction. Rows that are wrong by
//! themselves are spread over the measurement. So neighbours that depart alike are counted, and
//! compared with what rows drawn at random would give.

use std::collections::{BTreeMap, BTreeSet};

use statrs::distribution::{Discrete, DiscreteCDF, Poisson};

use crate::answers::{Diagnosis, FaultKind, MeasurementFault};
use crate::measurement::{Complex, Measurement};

use super::isolated::{compared, each};
use super::mending;

/// Two rows depart alike if the cosine of the angle between their residuals exceeds this; of random
/// directions, one pair in four does.
const ALIKE: f64 = std::f64::consts::FRAC_1_SQRT_2;
const ALIKE_BY_CHANCE: f64 = 0.25;

/// Probability below which so many neighbours are no chance.
const LEVEL: f64 = 1e-3;

/// Rows of one magnitude and harmonic by ascending frequency: what is left of each, in deviations, and
/// whether it was left out.
type Series = Vec<(Complex, bool)>;

/// Whether the rows that these faults leave out are neighbours that depart alike more often than chance
/// would have it: then they are no outliers, but something that the model of the answer lacks.
pub(super) fn form_regions(
    answer: &Diagnosis,
    measurement: &Measurement,
    faults: &[MeasurementFault],
) -> bool {
    let rows = faults.iter().flat_map(|fault| &fault.left_out);
    let out: BTreeSet<(usize, usize)> =
        rows.filter(|row| row.repeat.is_none()).map(|row| (row.experiment, row.harmonic)).collect();
    let others: Vec<MeasurementFault> =
        faults.iter().filter(|fault| fault.fault != FaultKind::BadRows).cloned().collect();
    let Ok(mended) = mending::mended(measurement, &others) else { return false };
    let Some(comparison) = compared(answer, &mended.measurement) else { return false };
    let mut series: BTreeMap<(u64, usize), Series> = BTreeMap::new();
    let mut rows: Vec<_> = each(&comparison).collect();
    rows.sort_by(|((_, one), _), ((_, other), _)| one.total_cmp(other));
    for ((magnitude, _), row) in rows {
        let is_out = out.contains(&(row.experiment, row.order));
        let own = series.entry((magnitude.to_bits(), row.order)).or_default();
        own.push((row.left, is_out));
    }
    is_no_chance(&series.into_values().collect::<Vec<_>>())
}

/// The same of rows by series of neighbours.
fn is_no_chance(series: &[Series]) -> bool {
    let all = series.iter().map(Vec::len).sum::<usize>() as f64;
    let out = series.iter().flatten().filter(|(_, is_out)| *is_out).count() as f64;
    let pairs = || series.iter().flat_map(|rows| rows.windows(2));
    let depart_alike = |pair: &&[(Complex, bool)]| {
        let [(one, one_out), (other, other_out)] = **pair else { return false };
        let along = (one * other.conj()).re;
        one_out && other_out && along > ALIKE * one.norm() * other.norm()
    };
    let found = pairs().filter(depart_alike).count() as u64;
    // Every row is as likely to be left out as any other.
    let both_out = out * (out - 1.0) / (all * (all - 1.0));
    let expected = ALIKE_BY_CHANCE * both_out * pairs().count() as f64;
    found > 0
        && Poisson::new(expected).is_ok_and(|chance| chance.pmf(found) + chance.sf(found) < LEVEL)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three series of sixteen rows, of which those at some places are left out, and depart by `left`.
    fn rows(out: &[(usize, usize)], left: impl Fn(usize) -> Complex) -> Vec<Series> {
        let row = |place: (usize, usize)| match out.contains(&place) {
            true => (left(place.1), true),
            false => (Complex::new(0.3, -0.4), false),
        };
        (0..3).map(|of| (0..16).map(|place| row((of, place))).collect()).collect()
    }

    #[test]
    fn neighbours_that_depart_alike_form_regions_and_rows_far_apart_do_not() {
        let alike = |_| Complex::new(5.0, 1.0);
        assert!(is_no_chance(&rows(&[(1, 3), (1, 4), (1, 5), (1, 6), (2, 4)], alike)));
        assert!(!is_no_chance(&rows(&[(0, 3), (1, 4), (1, 9), (2, 4)], alike)));
        assert!(!is_no_chance(&rows(&[(1, 3), (1, 4)], alike)), "a single pair may be chance");
        assert!(!is_no_chance(&rows(&[], alike)));
    }

    #[test]
    fn neighbours_that_depart_in_different_directions_form_no_region() {
        let turning = |place: usize| Complex::from_polar(5.0, 2.0 * place as f64);
        assert!(!is_no_chance(&rows(&[(1, 3), (1, 4), (1, 5), (1, 6), (2, 4)], turning)));
    }
}
