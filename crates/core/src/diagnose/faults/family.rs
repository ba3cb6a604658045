//! By how much a fault of the measurement must lower χ² to be more than chance.
//!
//! Noise is drawn and projected as the fit leaves it, as for effects
//! (`selection::familywise_threshold`). For each kind of fault the largest decrease of χ² by any
//! candidate of that kind has a null distribution. The kinds share one error rate equally
//! (Bonferroni's inequality).

use std::collections::BTreeMap;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::answers::FaultKind;
use crate::identify::ModelFit;

use crate::diagnose::residuals::null_distribution::NullDistribution;
use crate::diagnose::residuals::residual::Residuals;

use super::candidates::Candidate;
use super::convention;
use super::projection::Outside;

/// Number of draws of noise.
const DRAWS: u64 = 600;

/// Family-wise error rate: probability that any fault is named in a sound measurement.
const LEVEL: f64 = 0.003;

/// Largest share of rows that belong among those that are left out once one certainly does not.
const FALSE_ROWS: f64 = 0.05;

/// The limits of all kinds of fault.
pub(super) struct Family {
    limits: BTreeMap<FaultKind, f64>,
    /// Probability with which chance reaches the limit of one kind.
    level: f64,
    /// The same for the size of the noise: largest |Σr²/ν − 1|.
    pub size: f64,
}

impl Family {
    /// The limits beside a fitted model.
    pub fn of(fit: &ModelFit, candidates: &[Candidate], seed: u64) -> Self {
        let residuals = Residuals::of(fit);
        let outside: Vec<(FaultKind, Outside)> = candidates
            .iter()
            .filter_map(|candidate| {
                Some((candidate.kind, Outside::of(candidate, &residuals.fitted)?))
            })
            .collect();
        let draws: Vec<(BTreeMap<FaultKind, f64>, f64)> = (0..DRAWS)
            .into_par_iter()
            .map(|draw| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream((2 << 32) + draw);
                let noise = residuals.law.draw(&mut rng);
                let left = residuals.left_of(&noise);
                let mut largest = BTreeMap::new();
                for (kind, outside) in &outside {
                    let gain = outside.best(&left).0;
                    let known = largest.entry(*kind).or_insert(gain);
                    *known = gain.max(*known);
                }
                let size = residuals.fitted.complement(&noise).norm_squared() / residuals.dof();
                (largest, (size - 1.0).abs())
            })
            .collect();
        let mut kinds: Vec<FaultKind> = outside.iter().map(|(kind, _)| *kind).collect();
        kinds.sort_unstable();
        kinds.dedup();
        // The convention of the amplitudes and the size of the noise are kinds, too.
        let level = LEVEL / (kinds.len() + 2) as f64;
        let limit = |kind: FaultKind| {
            let gains = draws.iter().filter_map(|(largest, _)| largest.get(&kind).copied());
            (kind, NullDistribution::new(gains.collect()).limit(level))
        };
        let sizes = draws.iter().map(|(_, size)| *size).collect();
        Self {
            level,
            limits: kinds.into_iter().map(limit).collect(),
            size: NullDistribution::new(sizes).limit(level),
        }
    }

    /// By how much a fault must lower χ²; infinite for one that cannot show.
    pub fn limit(&self, kind: FaultKind) -> f64 {
        self.limits.get(&kind).copied().unwrap_or(f64::INFINITY)
    }

    /// By how much another convention of the amplitudes must lower χ².
    pub fn convention_limit(&self) -> f64 {
        convention::limit(self.level)
    }

    /// By how much a row must lower χ² where so many are left out already. The first is judged by the
    /// family-wise error rate. It says that rows are wrong, and of the rest those are wrong, too, among
    /// which the expected share of false ones is small (Y. Benjamini, Y. Hochberg 1995,
    /// doi:10.1111/j.2517-6161.1995.tb02031.x): the probability of each may be larger by the ratio of
    /// the two rates and by the number of rows. That of a decrease x by the two parts of a row is
    /// exp(−x/2).
    pub fn row_limit(&self, left_out: usize) -> f64 {
        let more = match left_out {
            0 => 1.0,
            _ => (1.0 + left_out as f64) * FALSE_ROWS / self.level,
        };
        self.limit(FaultKind::BadRows) - 2.0 * more.ln()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // exp(−x/2) is the probability of a decrease beyond x: with the first limit α/m, with the next
    // ones 0.05·k/m.
    #[test]
    fn the_first_row_is_judged_by_all_and_the_next_by_their_share_of_false_ones() {
        let (rows, level) = (400.0_f64, 3e-4_f64);
        let limit = -2.0 * (level / rows).ln();
        let family = Family { limits: [(FaultKind::BadRows, limit)].into(), level, size: 0.0 };
        let probability = |left_out: usize| (-0.5 * family.row_limit(left_out)).exp();
        assert!((probability(0) / (level / rows) - 1.0).abs() < 1e-9);
        for k in [2, 10, 40] {
            assert!((probability(k - 1) / (0.05 * k as f64 / rows) - 1.0).abs() < 1e-9);
        }
    }
}
