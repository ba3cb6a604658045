//! The trend of the variances: along the lines of a record; over magnitudes, harmonics and
//! experiments in a table.

use super::cell::{Cell, pooled};
use super::prior_dof::LogScatter;

/// A record needs this many lines for its noise to be smoothed along frequency (tuned).
const FEWEST_LINES: usize = 24;

/// Degrees of freedom over which the noise of a record is smoothed: a neighbourhood has as many
/// lines as that takes (tuned).
const NEIGHBOURHOOD_DOF: f64 = 60.0;

/// The prior variance of each cell, from its neighbours: the lines nearby in a record; cells of the
/// same magnitude, harmonic or experiment in a table.
pub(super) fn trend(rows: &[Vec<Cell>], flat: &[Cell]) -> Vec<f64> {
    let follows_frequency = |row: &Vec<Cell>| {
        row.len() >= FEWEST_LINES && row.iter().all(|cell| cell.from_record && cell.dof > 0.0)
    };
    let mut prior = match rows.iter().all(follows_frequency) {
        true => vec![0.0; flat.len()],
        false => additive(flat),
    };
    let mut start = 0;
    for row in rows {
        let cells = &flat[start..start + row.len()];
        if follows_frequency(row) {
            for (i, variance) in prior[start..start + row.len()].iter_mut().enumerate() {
                let reach = (0.5 * NEIGHBOURHOOD_DOF / cells[i].dof).ceil() as usize;
                let near = &cells[i.saturating_sub(reach)..(i + reach + 1).min(cells.len())];
                *variance = from_neighbours(near, cells[i].by_input).unwrap_or(*variance);
            }
        }
        start += row.len();
    }
    prior
}

/// Steps of Fisher scoring with which the rest of the variances is estimated beside what noise of the
/// input makes of them.
const STEPS: usize = 8;

/// A variance of which noise of the input makes a known part, the rest being that of its neighbours: the
/// maximum of the likelihood of normal noise, by Fisher scoring.
fn from_neighbours(near: &[Cell], by_input: f64) -> Option<f64> {
    let mut rest = pooled(near)?;
    if near.iter().all(|cell| cell.by_input == 0.0) {
        return Some(rest);
    }
    for _ in 0..STEPS {
        let (mut sum, mut weights) = (0.0, 0.0);
        for cell in near {
            let weight = cell.dof / (cell.by_input + rest).powi(2);
            sum += weight * (cell.variance - cell.by_input);
            weights += weight;
        }
        let next = sum / weights;
        rest = if next.is_finite() { next.max(0.0) } else { rest };
    }
    Some(by_input + rest)
}

/// Fits the additive model ln σ² = magnitude effect + harmonic effect + experiment effect, by
/// repeatedly removing group means (backfitting).
fn additive(cells: &[Cell]) -> Vec<f64> {
    let keys: [fn(&Cell) -> u64; 3] =
        [|cell| cell.magnitude.to_bits(), |cell| cell.order as u64, |cell| cell.experiment as u64];
    let groupings = keys.map(|key| groups(cells, key));
    let log = |cell: &Cell| cell.variance.ln() - LogScatter::of(cell.dof).mean;
    let mut left: Vec<f64> =
        cells.iter().map(|cell| if cell.dof > 0.0 { log(cell) } else { 0.0 }).collect();
    let mut fitted = vec![0.0; cells.len()];
    for _ in 0..20 {
        for (count, group_of) in &groupings {
            let mut sums = vec![(0.0, 0.0); *count];
            for ((cell, rest), group) in cells.iter().zip(&left).zip(group_of) {
                if cell.dof > 0.0 {
                    sums[*group].0 += rest * cell.dof;
                    sums[*group].1 += cell.dof;
                }
            }
            for (i, group) in group_of.iter().enumerate() {
                let (sum, dof) = sums[*group];
                if dof > 0.0 {
                    fitted[i] += sum / dof;
                    left[i] -= sum / dof;
                }
            }
        }
    }
    fitted.into_iter().map(f64::exp).collect()
}

/// Number of groups of cells with the same key, and the group of every cell.
fn groups(cells: &[Cell], key: fn(&Cell) -> u64) -> (usize, Vec<usize>) {
    let mut known = std::collections::BTreeMap::<u64, usize>::new();
    let mut group_of = Vec::with_capacity(cells.len());
    for cell in cells {
        let next = known.len();
        group_of.push(*known.entry(key(cell)).or_insert(next));
    }
    (known.len(), group_of)
}
