//! How much any effect of the library lowers χ² where none is missing.
//!
//! Noise is drawn as the fit of the anchor leaves it, and of each draw what
//! every effect would take up: the part of the noise in the directions in which
//! the effect would show. An effect with p parameters, refitted, follows the
//! noise in p directions around the best place; so each probe stands together
//! with its p − 1 nearest. The smallest p-value of a draw, over all effects, is
//! what an effect must fall below (Westfall and Young 1993, ISBN
//! 978-0-471-55761-6): right whatever parameters the null hypothesis leaves
//! unidentified (Davies 1987, doi:10.1093/biomet/74.1.33), with deviations given,
//! estimated or unknown.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::effects::Effect;
use crate::identify::NoiseLaw;

use super::anchor::Anchor;
use super::null::Null;
use super::probes::Probe;
use super::subspace::Subspace;

/// Draws of noise.
const DRAWS: u64 = 600;

/// Probability that an effect is named where none is missing.
const LEVEL: f64 = 0.003;

/// Cosine above which two probes show the same.
const SAME: f64 = 0.9999;

/// Null distributions of what every effect of a family takes up.
pub(super) struct Family {
    members: Vec<(&'static str, Null)>,
    limit: f64,
}

impl Family {
    /// Of these effects with their probes at an anchor.
    pub fn new(
        anchor: &Anchor,
        law: &NoiseLaw,
        scale_known: bool,
        probed: &[(&'static dyn Effect, Vec<Probe>)],
        seed: u64,
    ) -> Self {
        let seen: Vec<(&'static str, Vec<Subspace>)> = probed
            .iter()
            .map(|(effect, probes)| (effect.id(), spans(probes, effect.parameters().len())))
            .filter(|(_, spans)| !spans.is_empty())
            .collect();
        let drawn: Vec<Vec<f64>> = (0..DRAWS)
            .into_par_iter()
            .map(|draw| {
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream((1 << 32) + draw);
                let mut left = anchor.fitted.complement(&law.draw(&mut rng));
                if !scale_known {
                    left *= (anchor.dof() / left.norm_squared()).sqrt();
                }
                let most = |spans: &Vec<Subspace>| {
                    spans.iter().map(|span| span.energy(&left)).fold(0.0, f64::max)
                };
                seen.iter().map(|(_, spans)| most(spans)).collect()
            })
            .collect();
        let members: Vec<(&'static str, Null)> = seen
            .iter()
            .enumerate()
            .map(|(i, (id, _))| (*id, Null::new(drawn.iter().map(|values| values[i]).collect())))
            .collect();
        let smallest = |values: &Vec<f64>| {
            let p_values = members.iter().zip(values).map(|((_, null), value)| null.p_value(*value));
            // As a statistic that is large where something is wrong.
            -p_values.fold(1.0, f64::min).ln()
        };
        let limit = (-Null::new(drawn.iter().map(smallest).collect()).limit(LEVEL)).exp();
        Self { members, limit }
    }

    /// By how much an effect must lower χ² to be more than chance; infinite for
    /// one that does not show.
    pub fn limit(&self, id: &str) -> f64 {
        let member = self.members.iter().find(|(member, _)| *member == id);
        member.map_or(f64::INFINITY, |(_, null)| null.limit(self.limit))
    }
}

/// The spans of each probe with its nearest.
fn spans(probes: &[Probe], parameters: usize) -> Vec<Subspace> {
    let units: Vec<DVector<f64>> = probes.iter().map(|probe| probe.direction.normalize()).collect();
    let mut different: Vec<&DVector<f64>> = Vec::new();
    for unit in &units {
        if different.iter().all(|other| unit.dot(other).abs() < SAME) {
            different.push(unit);
        }
    }
    let cosine = |a: &DVector<f64>, b: &DVector<f64>| a.dot(b).abs();
    different
        .iter()
        .map(|unit| {
            let mut nearest = different.clone();
            nearest.sort_by(|a, b| cosine(b, unit).total_cmp(&cosine(a, unit)));
            nearest.truncate(parameters);
            let columns: Vec<DVector<f64>> = nearest.into_iter().cloned().collect();
            Subspace::of(&DMatrix::from_columns(&columns))
        })
        .collect()
}
