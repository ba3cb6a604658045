//! Forward selection of faults beside one fitted model.

use nalgebra::{DMatrix, DVector};

use crate::answers::{FaultKind, MeasurementFault, NoiseSource};
use crate::identify::ModelFit;
use crate::measurement::Complex;

use crate::diagnose::residuals::residual::Residuals;
use crate::diagnose::residuals::subspace::Subspace;

use super::candidates;
use super::candidates::Candidate;
use super::convention::{self, Convention};
use super::family::Family;
use super::fault;
use super::noise_size;
use super::projection::{Outside, dense};
use super::suspects::misfit;

/// Largest share of rows that may be left out.
pub(super) const LARGEST_SHARE: f64 = 0.1;

/// A fault that explains less than this share of what the first one explains is far smaller.
pub(super) const FAR_SMALLER: f64 = 0.05;

/// Prior probability that a row does not belong: one in a hundred, or the share that was found.
const LEAST_SHARE_OF_ROWS: f64 = 0.01;

/// Faults beside a model.
#[derive(Debug, Clone, Default)]
pub(super) struct Found {
    /// The faults, each with what it costs: −2 ln of its prior probability, and of the volume of its
    /// parameters.
    pub faults: Vec<(MeasurementFault, f64)>,
    /// A stated standard deviation that is wrong by a factor, if it is.
    pub std_factor: Option<MeasurementFault>,
    /// −2 ln likelihood with them, up to a constant that all models of a measurement share, and the
    /// cost of `std_factor`.
    pub misfit: f64,
}

/// The residuals of a model, and what is left of them beside the faults found so far.
pub(super) struct Scan<'a> {
    fit: &'a ModelFit,
    residuals: Residuals,
    fitted: Subspace,
    left: DVector<f64>,
    /// Whether the noise has the size that is stated.
    size_known: bool,
    /// Degrees of freedom of the base model, of which all misfits are counted.
    dof: f64,
    /// Rows that are left out already, and whether another convention of the amplitudes is mended.
    rows_before: usize,
    has_convention: bool,
    /// Σr² before, in units of the residuals; and the same as a cost.
    begin: [f64; 2],
}

impl<'a> Scan<'a> {
    /// A scan beside a fitted model of this cost; `size_known` says whether its noise has the size
    /// that the measurement states.
    pub fn new(fit: &'a ModelFit, cost: f64, dof: f64, size_known: bool) -> Self {
        let residuals = with_data_of_fit(Residuals::of(fit));
        let left = residuals.fitted.complement(&residuals.values);
        let begin = [left.norm_squared().max(f64::MIN_POSITIVE), cost];
        let fitted = residuals.fitted.clone();
        let (rows_before, has_convention) = (0, false);
        Self { fit, residuals, fitted, left, size_known, dof, rows_before, has_convention, begin }
    }

    /// The same where these faults are mended already.
    pub fn beside(self, known: &[MeasurementFault]) -> Self {
        let rows_before = known.iter().map(|fault| fault.left_out.len()).sum();
        let is_convention =
            |fault: &MeasurementFault| fault.fault == FaultKind::AmplitudeConvention;
        Self { rows_before, has_convention: known.iter().any(is_convention), ..self }
    }

    /// The candidates of this measurement.
    pub fn candidates(&self) -> Vec<Candidate> {
        candidates::all(&self.residuals.layout)
    }

    fn is_given(&self) -> bool {
        self.fit.identification.noise == NoiseSource::Given
    }

    /// −2 ln likelihood where this Σr² is left.
    fn misfit(&self, left: f64, size_known: bool) -> f64 {
        misfit(left / self.begin[0] * self.begin[1], self.dof, size_known)
    }

    /// Adds the fault that is most likely as long as there is one that is more than chance. Faults far
    /// smaller than the first are left to another scan after a refit, because what is left beside a
    /// large fault is known to first order only.
    pub fn select(mut self, candidates: &[Candidate], family: &Family) -> Found {
        let mut found = Found::default();
        let most = (LARGEST_SHARE * self.residuals.layout.cells.len() as f64) as usize;
        let mut chosen: Vec<usize> = Vec::new();
        let (mut first, mut size_price) = (0.0, 0.0);
        let mut rows = self.rows_before;
        for _ in 0..most.saturating_sub(self.rows_before).max(1) {
            let now = self.misfit(self.left.norm_squared(), self.size_known);
            let size = self.size_gain(now, family);
            let best = candidates
                .iter()
                .enumerate()
                .filter(|(index, _)| !chosen.contains(index))
                .filter_map(|(index, candidate)| {
                    let (net, outside) = self.net_gain(now, candidate, family, rows)?;
                    Some((net, index, outside))
                })
                .max_by(|a, b| a.0.total_cmp(&b.0));
            let is_first = |net: &f64| {
                let others = [size, best.as_ref().map(|best| best.0)];
                others.into_iter().flatten().all(|other| *net > other)
            };
            if chosen.is_empty()
                && let Some((_, read)) =
                    self.convention(now, family).filter(|(net, _)| is_first(net))
            {
                // It changes what all other candidates would explain.
                found.faults.push((fault::read_as_peak(read.factor), convention::PRICE));
                self.left = read.left;
                self.fitted = read.fitted;
                break;
            }
            match (size, best) {
                (Some(size), best) if best.as_ref().is_none_or(|best| size > best.0) => {
                    self.size_known = false;
                    size_price = noise_size::price(self.dof);
                }
                (_, Some((_, index, outside))) => {
                    let gain = outside.best(&self.left).0;
                    if gain < FAR_SMALLER * first {
                        break;
                    }
                    first = gain.max(first);
                    chosen.push(index);
                    let candidate = &candidates[index];
                    let price = self.price(candidate, &outside, gain, rows);
                    rows += usize::from(candidate.kind == FaultKind::BadRows);
                    found.faults.push((self.take(candidate, &outside), price));
                }
                _ => break,
            }
        }
        if size_price > 0.0 {
            found.std_factor =
                noise_size::factor(self.left.norm_squared(), self.dof_left(), family.size);
            self.size_known = found.std_factor.is_none();
        }
        found.misfit = self.misfit(self.left.norm_squared(), self.size_known)
            + if self.size_known { 0.0 } else { size_price };
        found
    }

    /// What remains of the gains and phases that were found, however little: [`Self::select`] adds
    /// only what is more than chance, which leaves their sizes up to some standard deviations off.
    pub fn remainders(
        mut self,
        candidates: &[Candidate],
        known: &[MeasurementFault],
    ) -> Vec<MeasurementFault> {
        let is_known = |candidate: &&Candidate| {
            use FaultKind::{LevelGain, LevelPhase, RunGain, RunPhase};
            let place = (candidate.kind, candidate.level(), candidate.run());
            matches!(candidate.kind, LevelGain | LevelPhase | RunGain | RunPhase)
                && known.iter().any(|fault| fault::place(fault) == place)
        };
        let remainder = |candidate: &Candidate| {
            let outside = Outside::of(candidate, &self.fitted)?;
            Some(self.take(candidate, &outside))
        };
        candidates.iter().filter(is_known).filter_map(remainder).collect()
    }

    /// What a wrong size of the noise would explain, less what it costs.
    fn size_gain(&self, now: f64, family: &Family) -> Option<f64> {
        if !self.size_known || !self.is_given() {
            return None;
        }
        let left = self.left.norm_squared();
        let gain = now - self.misfit(left, false) - noise_size::price(self.dof);
        let is_wrong = noise_size::factor(left, self.dof_left(), family.size).is_some();
        (is_wrong && gain > 0.0).then_some(gain)
    }

    /// Another convention of the amplitudes, if none is mended yet and it explains more than chance, with
    /// what it explains less what it costs.
    fn convention(&self, now: f64, family: &Family) -> Option<(f64, Convention)> {
        if self.has_convention {
            return None;
        }
        let read = convention::best(&self.residuals.layout.cells, &self.fitted, &self.left)?;
        let left = self.left.norm_squared();
        let net = now - self.misfit(left - read.gain, self.size_known) - convention::PRICE;
        let is_more = read.gain > family.convention_limit() * self.scale();
        (is_more && net > 0.0).then_some((net, read))
    }

    fn net_gain(
        &self,
        now: f64,
        candidate: &Candidate,
        family: &Family,
        rows: usize,
    ) -> Option<(f64, Outside)> {
        let outside = Outside::of(candidate, &self.fitted)?;
        let left = self.left.norm_squared();
        let gain = outside.best(&self.left).0;
        let scale = self.scale();
        let limit = match candidate.kind {
            FaultKind::BadRows => family.row_limit(rows),
            kind => family.limit(kind),
        };
        if gain <= limit * scale {
            return None;
        }
        if matches!(candidate.kind, FaultKind::RunGain | FaultKind::RunPhase)
            && !outside.is_shared(&(&self.left / scale.sqrt()), &|row| self.cell_of(row))
        {
            return None;
        }
        let price = self.price(candidate, &outside, gain, rows);
        let net = now - self.misfit(left - gain, self.size_known) - price;
        (net > 0.0).then_some((net, outside))
    }

    /// Variance of the noise in units of the residuals.
    fn scale(&self) -> f64 {
        if self.size_known { 1.0 } else { self.left.norm_squared() / self.dof_left() }
    }

    /// Degrees of freedom that are left.
    fn dof_left(&self) -> f64 {
        (self.left.len() - self.fitted.dimension()).max(1) as f64
    }

    /// The first row of the datum to which a row belongs.
    fn cell_of(&self, row: usize) -> usize {
        let cells = &self.residuals.layout.cells;
        let next = cells.partition_point(|cell| cell.rows.0 <= row);
        cells[next.saturating_sub(1)].rows.0
    }

    /// What a fault costs that lowers Σr² by `gain`, where so many rows are left out already.
    fn price(&self, candidate: &Candidate, outside: &Outside, gain: f64, rows: usize) -> f64 {
        let all = self.residuals.layout.cells.len().max(1) as f64;
        let share = ((1.0 + rows as f64) / all).max(LEAST_SHARE_OF_ROWS);
        let odds = match candidate.kind {
            FaultKind::BadRows => -2.0 * share.ln(),
            _ => candidate.price,
        };
        odds + outside.volume(gain / self.scale())
    }

    /// Adds a fault: what it explains is taken from the residuals.
    fn take(&mut self, candidate: &Candidate, outside: &Outside) -> MeasurementFault {
        let (_, values) = outside.best(&self.left);
        let rows = self.left.len();
        let columns: Vec<DVector<f64>> =
            candidate.columns.iter().map(|column| dense(column, rows)).collect();
        self.fitted = self.fitted.with(&DMatrix::from_columns(&columns));
        self.left = self.fitted.complement(&self.left);
        let scale = self.scale().sqrt();
        let deviation = scale * outside.deviations()[0];
        fault::found(candidate, &self.residuals.layout.cells, &values, [deviation, scale])
    }
}

/// The residuals with what they are of as measured values: where faults are mended that were found
/// before, not what was measured.
fn with_data_of_fit(mut residuals: Residuals) -> Residuals {
    let Residuals { layout, values, .. } = &mut residuals;
    for cell in &mut layout.cells {
        let (re, im) = (values[cell.rows.0], cell.rows.1.map_or(0.0, |row| values[row]));
        cell.measured = cell.simulated + cell.std * Complex::new(re, im);
    }
    residuals
}
