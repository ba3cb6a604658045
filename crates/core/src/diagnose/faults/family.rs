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
use super::projection::Outside;

/// Number of draws of noise.
const DRAWS: u64 = 600;

/// Family-wise error rate: probability that any fault is named in a sound measurement.
const LEVEL: f64 = 0.003;

/// The limits of all kinds of fault.
pub(super) struct Family {
    limits: BTreeMap<FaultKind, f64>,
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
        let level = LEVEL / (kinds.len() + 1) as f64;
        let limit = |kind: FaultKind| {
            let gains = draws.iter().filter_map(|(largest, _)| largest.get(&kind).copied());
            (kind, NullDistribution::new(gains.collect()).limit(level))
        };
        let sizes = draws.iter().map(|(_, size)| *size).collect();
        Self {
            limits: kinds.into_iter().map(limit).collect(),
            size: NullDistribution::new(sizes).limit(level),
        }
    }

    /// By how much a fault must lower χ²; infinite for one that cannot show.
    pub fn limit(&self, kind: FaultKind) -> f64 {
        self.limits.get(&kind).copied().unwrap_or(f64::INFINITY)
    }
}
