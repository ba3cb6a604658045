//! The last stage: least squares from every start, and the weights that belong to its result.

use super::{Run, StageResults, no_response};
use crate::identify::minima::different_minima;
use crate::identify::noise::Weights;
use crate::identify::objective::Misfit;
use crate::identify::parameters::Coordinates;
use crate::identify::refine::{self, Patience, Refined};
use crate::identify::request::IdentifyError;
use crate::identify::saturated;

/// Most rounds of refinement in which weights that depend on the model are recomputed.
const MOST_REWEIGHTINGS: usize = 6;

/// If no coordinate moves by more than this in a round, the weights have converged.
const CONVERGED_CHANGE: f64 = 1e-6;

/// The start beside the best of many actuators is followed if it leads to less than this share of the
/// cost of all others: less than a third of the residual. Any resonance serves some lines of a record that
/// no base model explains, and the best of them depends on what is missing.
const FAR_LESS: f64 = 0.1;

/// How far every start is refined, on the coarse problem if there is one.
const ROUGH: Patience = Patience { cost_tolerance: 1e-5, ..refine::THOROUGH };

impl Run<'_> {
    /// Refines every start roughly, then those that lead to different minima about as low as the
    /// lowest one, then the best again until its weights have converged.
    pub(super) fn refinement(
        &self,
        coordinates: &Coordinates,
        weights: &mut Weights,
        found: &mut StageResults,
    ) -> Result<Vec<f64>, IdentifyError> {
        found.starts.extend(self.start_of_lower(coordinates));
        let begun = self.history.begin("refinement", found.starts.len() as u64);
        let (mut evaluations, mut steps) = (0, 0);
        let mut descend = |problem, weights: &Weights, start: &[f64], patience, bar: f64| {
            let misfit = Misfit { problem, ..self.misfit(coordinates, weights) };
            let mut on_step = |_, used: u64, cost: f64| {
                begun.row(steps, evaluations + used, cost.min(bar), None);
                steps += 1;
            };
            let refined = refine::refine(&misfit, start, patience, &mut on_step);
            evaluations += refined.evaluations;
            self.history.check_cancelled().map(|()| refined)
        };
        let mut rough: Vec<Refined> = Vec::new();
        for (done, start) in found.starts.iter().enumerate() {
            begun.progress(done as u64);
            let problem = self.coarse.unwrap_or(self.problem);
            let bar = rough.iter().map(|refined| refined.cost).fold(f64::INFINITY, f64::min);
            rough.push(descend(problem, weights, start, ROUGH, bar)?);
        }
        if let Some(start) = &found.beside_actuators {
            let problem = self.coarse.unwrap_or(self.problem);
            let bar = rough.iter().map(|refined| refined.cost).fold(f64::INFINITY, f64::min);
            let refined = descend(problem, weights, start, ROUGH, bar)?;
            if refined.cost < FAR_LESS * bar {
                rough.push(refined);
            }
        }
        let mut best: Option<Refined> = None;
        for start in different_minima(rough) {
            let bar = best.as_ref().map_or(f64::INFINITY, |refined| refined.cost);
            // The damping that the fit has by then.
            let patience = Patience { damping: start.damping, ..refine::THOROUGH };
            let refined = descend(self.problem, weights, &start.point, patience, bar)?;
            if refined.cost < bar {
                best = Some(refined);
            }
        }
        let mut best = best.ok_or_else(no_response)?;
        let mut rng = self.stream(3);
        for _ in 0..saturated::STARTS {
            let misfit = self.misfit(coordinates, weights);
            if !saturated::misses(&misfit, best.cost) {
                break;
            }
            let start = saturated::start(&misfit, &mut rng);
            let refined = descend(self.problem, weights, &start, refine::THOROUGH, best.cost)?;
            if refined.cost < best.cost {
                best = refined;
            }
        }
        for _ in 0..MOST_REWEIGHTINGS {
            if !weights.depend_on_model {
                break;
            }
            *weights = self.weights(Some(&coordinates.plant(&best.point)));
            let patience = Patience { damping: best.damping, ..refine::THOROUGH };
            let refined = descend(self.problem, weights, &best.point, patience, f64::INFINITY)?;
            let moved = refined.point.iter().zip(&best.point).map(|(a, b)| (a - b).abs());
            let converged = moved.fold(0.0, f64::max) < CONVERGED_CHANGE;
            best = refined;
            if converged {
                break;
            }
        }
        begun.progress(found.starts.len() as u64);
        let plant = self.problem.in_units(&coordinates.plant(&best.point));
        found.stages.push(begun.end(evaluations, best.cost, &plant, best.stop));
        Ok(best.point)
    }
}
