//! Greedy search for the largest departures: the region that stands out most is described and
//! removed, then the next is sought in what remains.

use nalgebra::DVector;

use crate::answers::Pattern;

use super::groups::Sizes;
use super::layout::{Cell, Layout};
use super::regions::{Region, Regions};
use super::residual::Residuals;
use super::sentence;
use super::sentence::{Change, Departure};
use super::statistics::log_magnitude;
use super::subspace::Subspace;

/// Largest number of patterns reported.
const MOST_PATTERNS: usize = 5;

/// Share of the excess χ² that a further pattern must hold to be reported. Tuned.
const LEAST_SHARE: f64 = 0.03;

/// Share of the excess χ² that a drift of the parameters must explain to be reported. Tuned.
const DRIFT_SHARE: f64 = 0.6;

/// Largest excess that a reported drift leaves, as a share of the least that parameters varying
/// with magnitude or frequency leave. Tuned.
const DRIFT_REMAINDER_RATIO: f64 = 0.5;

/// Lower quartile of χ² with one degree of freedom.
const LOWER_QUARTILE: f64 = 0.101_531;

/// The residuals that no pattern explains yet.
struct Unexplained {
    /// In standard deviations of the noise; 0 in explained rows.
    values: DVector<f64>,
    /// 1 − leverage; 0 in explained rows.
    freedom: Vec<f64>,
    /// Excess χ² before any pattern is removed.
    whole: f64,
}

impl Unexplained {
    fn of(residuals: &Residuals) -> Self {
        let mut values = residuals.values.clone();
        let freedom = residuals.freedom.clone();
        if !residuals.scale_known {
            values /= noise_deviation(&values);
        }
        let whole = (values.norm_squared() - freedom.iter().sum::<f64>()).max(f64::MIN_POSITIVE);
        Self { values, freedom, whole }
    }

    fn share(&self, sum: f64, dof: f64) -> f64 {
        ((sum - dof) / self.whole).clamp(0.0, 1.0)
    }
}

/// Standard deviation of unknown noise, from the lower quartile of the squared residuals, which a
/// departure hardly affects.
fn noise_deviation(values: &DVector<f64>) -> f64 {
    let mut squares: Vec<f64> = values.iter().map(|value| value * value).collect();
    squares.sort_by(f64::total_cmp);
    let quartile = squares.get(squares.len() / 4).copied().unwrap_or(1.0);
    let largest = squares.last().copied().unwrap_or(1.0);
    (quartile / LOWER_QUARTILE).max(1e-12 * largest).max(f64::MIN_POSITIVE).sqrt()
}

/// Finds the patterns of residuals that are not noise, the most conspicuous first.
///
/// A drift of the parameters in the course of the acquisition is looked for first. Then, again and
/// again, the region whose excess stands out most is reported and removed, until its share is small
/// or its score is within `limit`, which noise may reach. The first is reported in any case.
pub(crate) fn find(residuals: &Residuals, regions: &Regions, limit: f64) -> Vec<Pattern> {
    let mut left = Unexplained::of(residuals);
    let mut patterns: Vec<Pattern> = drift(residuals, &mut left).into_iter().collect();
    while patterns.len() < MOST_PATTERNS {
        let squares = |row: usize| left.values[row] * left.values[row];
        let found = regions.most_conspicuous(|row| left.freedom[row], squares);
        let Some((region, _)) = found.filter(|(_, score)| *score > 0.0) else { break };
        let inside = residuals.layout.cells.iter().filter(|cell| region.holds(cell));
        let (taken, before): (Vec<&Cell>, Vec<&Cell>) =
            inside.partition(|cell| left.freedom[cell.rows.0] > 0.0);
        let rows: Vec<usize> = taken.iter().flat_map(|cell| cell.each_row()).collect();
        let sum: f64 = rows.iter().map(|row| squares(*row)).sum();
        let dof: f64 = rows.iter().map(|row| left.freedom[*row]).sum();
        let share = left.share(sum, dof);
        let worth = share >= LEAST_SHARE && Regions::score_of(dof, sum - dof) > limit;
        if !patterns.is_empty() && !worth {
            break;
        }
        patterns.extend(describe(residuals, &region, &taken, share, !before.is_empty()));
        for row in rows {
            left.values[row] = 0.0;
            left.freedom[row] = 0.0;
        }
    }
    patterns
}

/// Describes the departure of `cells` in `region`, which `overlaps` with an earlier pattern.
fn describe(
    residuals: &Residuals,
    region: &Region,
    cells: &[&Cell],
    share: f64,
    overlaps: bool,
) -> Option<Pattern> {
    let sizes = Sizes::of(residuals, cells)?;
    let layout = &residuals.layout;
    let (low, high) =
        (layout.magnitudes[region.magnitudes.0], layout.magnitudes[region.magnitudes.1]);
    let every = |(first, last): (usize, usize), count: usize| first == 0 && last + 1 == count;
    let magnitudes =
        (!every(region.magnitudes, layout.magnitudes.len())).then_some([low[0], high[1]]);
    let bands = (layout.bands[region.bands.0], layout.bands[region.bands.1]);
    let frequencies =
        (!every(region.bands, layout.bands.len())).then_some([bands.0[0], bands.1[1]]);
    let departure = Departure {
        relative_size: relative_size(cells, &sizes),
        phase_deg: phase_deg(cells, &sizes),
        mean: signed_mean(cells),
        in_sigmas: residuals.scale_known.then_some(sizes.rms_sigmas),
        sizes: &sizes,
    };
    Some(Pattern {
        magnitudes,
        frequencies_hz: frequencies,
        harmonics: region.harmonics.clone(),
        runs: None,
        count: cells.len(),
        rms_sigmas: sizes.rms_sigmas,
        rms_response: sizes.rms_left,
        relative_size: departure.relative_size,
        phase_deg: departure.phase_deg,
        share,
        sentence: match sentence::of_region(layout, region, &departure) {
            sentence if overlaps => format!("apart from that, {sentence}"),
            sentence => sentence,
        },
    })
}

/// Whether the simulated response is large enough to state the departure relative to it.
fn is_simulated(sizes: &Sizes) -> bool {
    sizes.rms_simulated > 0.2 * sizes.rms_left.max(sizes.rms_measured)
}

/// Mean of |Y|/|Ŷ| − 1, weighted with |Ŷ|: Σ|Y|/Σ|Ŷ| − 1.
fn relative_size(cells: &[&Cell], sizes: &Sizes) -> Option<f64> {
    let simulated: f64 = cells.iter().map(|cell| cell.simulated.norm()).sum();
    let measured: f64 = cells.iter().map(|cell| cell.measured.norm()).sum();
    is_simulated(sizes).then(|| measured / simulated - 1.0)
}

/// Mean phase by which the measurement leads; only for cells of one harmonic other than the mean.
fn phase_deg(cells: &[&Cell], sizes: &Sizes) -> Option<f64> {
    let turning = cells.iter().all(|cell| cell.order > 0);
    let one = cells.windows(2).all(|pair| pair[0].harmonic == pair[1].harmonic);
    let sum: crate::measurement::Complex =
        cells.iter().map(|cell| cell.measured * cell.simulated.conj()).sum();
    (turning && one && is_simulated(sizes)).then(|| sum.arg().to_degrees())
}

/// Mean of measured less simulated; only where all cells are of harmonic 0.
fn signed_mean(cells: &[&Cell]) -> Option<f64> {
    let all = cells.iter().all(|cell| cell.order == 0);
    let sum: f64 = cells.iter().map(|cell| (cell.measured - cell.simulated).re).sum();
    all.then(|| sum / cells.len().max(1) as f64)
}

/// The pattern that the parameters drift in the course of the acquisition, if that explains most of
/// the excess, and better than parameters that vary with magnitude or frequency, which the order of
/// acquisition often follows.
fn drift(residuals: &Residuals, left: &mut Unexplained) -> Option<Pattern> {
    let layout = &residuals.layout;
    let runs = || layout.cells.iter().filter_map(|cell| cell.run);
    if runs().count() < layout.cells.len() {
        return None;
    }
    let run = |cell: &Cell| cell.run.unwrap_or(0.0);
    let space = residuals.varying(&[&run]);
    let (sum, dof) = (space.energy(&left.values), space.dimension() as f64);
    let share = left.share(sum, dof);
    let rest = left.whole * (1.0 - share);
    if share < DRIFT_SHARE || rest > DRIFT_REMAINDER_RATIO * excess_left_by_rivals(residuals, left)
    {
        return None;
    }
    let ends = classes_of_runs(layout);
    let change = Change { start: offset(layout, &ends[0]), end: offset(layout, &ends[1]) };
    let cells: Vec<&Cell> = layout.cells.iter().collect();
    let sizes = Sizes::of(residuals, &cells)?;
    remove(left, &space);
    Some(Pattern {
        magnitudes: None,
        frequencies_hz: None,
        harmonics: Vec::new(),
        runs: Some([
            runs().fold(f64::INFINITY, f64::min),
            runs().fold(f64::NEG_INFINITY, f64::max),
        ]),
        count: cells.len(),
        rms_sigmas: sizes.rms_sigmas,
        rms_response: sizes.rms_left,
        relative_size: Some(change.end - change.start),
        phase_deg: None,
        share,
        sentence: sentence::of_drift(&change),
    })
}

/// The least excess left by parameters that vary with magnitude or with frequency.
fn excess_left_by_rivals(residuals: &Residuals, left: &Unexplained) -> f64 {
    let magnitude = log_magnitude(residuals);
    let frequency = |cell: &Cell| cell.frequency_hz.max(f64::MIN_POSITIVE).ln();
    let levels: [&dyn Fn(&Cell) -> f64; 2] = [&magnitude, &frequency];
    let left_by = |level: &dyn Fn(&Cell) -> f64| {
        let space = residuals.varying(&[level]);
        left.whole - (space.energy(&left.values) - space.dimension() as f64)
    };
    levels.into_iter().map(left_by).fold(left.whole, f64::min)
}

/// Removes the part of the residuals in a subspace.
fn remove(left: &mut Unexplained, space: &Subspace) {
    left.values = space.complement(&left.values);
    for (freedom, leverage) in left.freedom.iter_mut().zip(space.leverages()) {
        *freedom = (*freedom - leverage).max(0.0);
    }
}

/// First and last third of the runs.
fn classes_of_runs(layout: &Layout) -> [super::layout::Span; 2] {
    let thirds = super::layout::classes(layout.cells.iter().filter_map(|cell| cell.run), 3);
    [thirds[0], thirds[thirds.len() - 1]]
}

/// Mean excess of the measured over the simulated fundamental, as a share, in a span of runs.
fn offset(layout: &Layout, [first, last]: &super::layout::Span) -> f64 {
    let (mut excess, mut size) = (0.0, 0.0);
    let within = |cell: &&Cell| cell.run.is_some_and(|run| (*first..=*last).contains(&run));
    let fundamental = |cell: &&Cell| layout.many_lines || cell.harmonic == 1;
    for cell in layout.cells.iter().filter(within).filter(fundamental) {
        let simulated = cell.simulated.norm();
        if simulated > 0.0 {
            excess += ((cell.measured - cell.simulated) * cell.simulated.conj()).re / simulated;
            size += simulated;
        }
    }
    if size > 0.0 { excess / size } else { 0.0 }
}
