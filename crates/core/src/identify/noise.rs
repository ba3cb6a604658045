//! The standard deviation of each datum.
//!
//! Standard deviations come from the upload or from the scatter of repeats or periods. Where
//! nothing states them, their ratios follow from the scatter of what a model leaves
//! (`estimated_noise`).
//!
//! A variance estimated from few repeats is itself uncertain, and using each by itself as a weight
//! inflates every test statistic. Variances are therefore pooled if a test does not reject that
//! they are equal. Otherwise they are shrunk towards a law of the size of the response, or towards
//! those of their neighbours, by as much as their spread allows (Smyth 2004,
//! doi:10.2202/1544-6115.1027).
//!
//! If the input scatters too, the relevant deviation is that of the response less the model's
//! response to the deviation of the input, including shifted switching times: σ² = σ_Y² +
//! |∂Y/∂U|²·σ_U² − 2 Re(conj(∂Y/∂U)·σ_UY), summed over all lines.

use rayon::prelude::*;

use crate::answers::{IdentifyOptions, NoiseSource, Weighting};
use crate::effects::ActiveEffect;
use crate::measurement::{Complex, Experiment, Measurement};
use crate::plant::Plant;
use crate::simulate;

use super::estimated_noise::EstimatedLaw;
use super::local_scatter::LocalScatter;
use super::problem::{Prepared, Problem};
use super::variance_law::VarianceLaw;
use super::variance_shrinkage::{Cell, law_of, weighting_variances};

/// Relative deviation that rounding of the mean leaves between repeats that are copies of each
/// other.
const COPY_ROUNDING: f64 = 1e-13;

/// Weights whose standard deviations differ by less than this (rms of their logarithms) are the
/// same: each part of a law is estimated from some hundred data to about a tenth.
const SAME_WEIGHTS: f64 = 0.1;

/// Standard deviation of every target, in scale.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    /// Standard deviation of re and of im each, by experiment and target.
    pub sigma: Vec<Vec<f64>>,
    /// Where the standard deviations come from.
    pub source: NoiseSource,
    /// Degrees of freedom of the estimated noise scale; infinite if the scale is given.
    pub scale_dof: f64,
    /// Whether they depend on the model, which they do if the input scatters, or if they are
    /// estimated from what the model leaves.
    pub depend_on_model: bool,
    /// The law from which they follow, if they are estimated from what a model leaves.
    pub law: Option<EstimatedLaw>,
    /// The law towards which the variances of repeats were shrunk.
    pub scatter_law: Option<VarianceLaw>,
    /// The variances they were estimated from; empty if they were not estimated.
    pub scatter: Vec<Vec<Cell>>,
}

impl Weights {
    /// Whether these weigh the data alike: the ratios of their standard deviations differ by no
    /// more than the law can be estimated to.
    pub fn resemble(&self, others: &Self) -> bool {
        let pairs = || self.sigma.iter().flatten().zip(others.sigma.iter().flatten());
        let count = pairs().count().max(1) as f64;
        let square = |(own, other): (&f64, &f64)| (own / other).ln().powi(2);
        (pairs().map(square).sum::<f64>() / count).sqrt() <= SAME_WEIGHTS
    }

    /// Whether the size of the noise is known.
    pub fn known(&self) -> bool {
        self.source != NoiseSource::Estimated
    }
}

/// A model in scale, on which weights depend.
#[derive(Clone, Copy)]
pub(super) struct Beside<'a> {
    /// Its plant.
    pub plant: &'a Plant,
    /// Its effects.
    pub effects: &'a [ActiveEffect],
}

/// The weights of a problem. `model` says how the scatter of the input acts on the response;
/// without it the measured ratio of response to input is used. Where nothing is stated, what the
/// model leaves tells how the noise depends on the size of the response; without a model, all
/// weights are equal.
pub(super) fn weights(
    measurement: &Measurement,
    problem: &Problem,
    options: &IdentifyOptions,
    model: Option<Beside<'_>>,
) -> Weights {
    let experiments = measurement.experiments();
    let uniform = |sigma: f64, source| Weights {
        sigma: problem.experiments.iter().map(|e| vec![sigma; e.targets.len()]).collect(),
        source,
        scale_dof: f64::INFINITY,
        depend_on_model: false,
        law: None,
        scatter_law: None,
        scatter: Vec::new(),
    };
    if options.weights == Weighting::Response {
        return uniform(1.0, NoiseSource::Estimated);
    }
    if experiments.iter().any(|e| !e.repeats.is_empty()) && scatters(experiments) {
        return from_scatter(experiments, problem, model.map(|model| model.plant));
    }
    let given: Vec<f64> =
        experiments.iter().flat_map(|e| &e.response).filter_map(|h| h.std).collect();
    if !given.is_empty() {
        // A datum without its own standard deviation gets the rms of the given ones.
        let usual = (given.iter().map(|s| s * s).sum::<f64>() / given.len() as f64).sqrt();
        let mut weights = uniform(usual / problem.response_scale, NoiseSource::Given);
        for (e, experiment) in experiments.iter().enumerate() {
            for (t, target) in problem.experiments[e].targets.iter().enumerate() {
                let own = experiment.response.iter().find(|h| h.order == target.order);
                if let Some(std) = own.and_then(|h| h.std) {
                    weights.sigma[e][t] = std / problem.response_scale;
                }
            }
        }
        return weights;
    }
    match options.noise_std {
        Some(std) => uniform(std / problem.response_scale, NoiseSource::Given),
        None => {
            let law =
                model.and_then(|beside| EstimatedLaw::of(problem, beside.plant, beside.effects));
            let equal = uniform(1.0, NoiseSource::Estimated);
            Weights {
                sigma: match &law {
                    Some(law) if !law.is_of_one_size() => law.sigma(problem),
                    _ => equal.sigma.clone(),
                },
                depend_on_model: !LocalScatter::of(problem).is_empty(),
                law,
                ..equal
            }
        }
    }
}

/// Whether repeats differ by more than rounding. Copies say nothing about the noise.
fn scatters(experiments: &[Experiment]) -> bool {
    let power = |values: &[Complex]| values.iter().map(Complex::norm_sqr).sum::<f64>();
    experiments.iter().any(|e| {
        let response: f64 = e.response.iter().map(|h| h.value.norm_sqr()).sum();
        let rounding = COPY_ROUNDING * COPY_ROUNDING;
        e.repeats.iter().any(|repeat| {
            power(&repeat.response) > rounding * response
                || power(&repeat.input) > rounding * power(&e.input)
        })
    })
}

/// The weights from the scatter of repeats or periods about their mean.
fn from_scatter(experiments: &[Experiment], problem: &Problem, model: Option<&Plant>) -> Weights {
    let from_record = experiments.iter().any(|e| e.from_record);
    let input_scatters = experiments
        .iter()
        .any(|e| e.repeats.iter().any(|r| r.input.iter().any(|u| u.norm() > 0.0)));
    let rows: Vec<Vec<Cell>> = experiments
        .par_iter()
        .zip(&problem.experiments)
        .enumerate()
        .map(|(index, (experiment, prepared))| {
            cells(index, experiment, prepared, problem, model.filter(|_| input_scatters))
        })
        .collect();
    let scale_dof = rows.iter().flatten().map(|cell| cell.dof).sum();
    let scatter_law = law_of(&rows);
    let moderated = weighting_variances(&rows, scatter_law);
    let sigma = moderated
        .into_iter()
        .zip(experiments)
        .map(|(variances, experiment)| {
            let repeats = experiment.repeats.len().max(1) as f64;
            let rounding = experiment.rounding_std / problem.response_scale;
            variances.into_iter().map(|v| (v / repeats + rounding * rounding).sqrt()).collect()
        })
        .collect();
    Weights {
        sigma,
        source: if from_record { NoiseSource::Periods } else { NoiseSource::Repeats },
        scale_dof,
        depend_on_model: input_scatters,
        law: None,
        scatter_law,
        scatter: rows,
    }
}

/// The variance of a single repeat, for every target of an experiment.
fn cells(
    index: usize,
    experiment: &Experiment,
    prepared: &Prepared,
    problem: &Problem,
    model: Option<&Plant>,
) -> Vec<Cell> {
    let repeats = experiment.repeats.len();
    let explained = explained_by_input(experiment, prepared, problem, model);
    let response_offset = |order: usize| experiment.response.iter().position(|h| h.order == order);
    prepared
        .targets
        .iter()
        .enumerate()
        .map(|(t, target)| {
            let own = if target.constraint { None } else { response_offset(target.order) };
            let sum: f64 = (0..repeats)
                .map(|p| {
                    let measured = own.map_or(Complex::new(0.0, 0.0), |i| {
                        experiment.repeats[p].response[i] / problem.response_scale
                    });
                    let left = measured - explained[p][t];
                    if target.real { left.re * left.re } else { left.norm_sqr() }
                })
                .sum();
            let components = if target.real { 1.0 } else { 2.0 };
            let dof = components * repeats.saturating_sub(1) as f64;
            Cell {
                experiment: index,
                order: target.order,
                magnitude: experiment.magnitude,
                size: if target.constraint { 0.0 } else { target.value.norm() },
                from_record: experiment.from_record,
                variance: if dof > 0.0 { sum / dof } else { 0.0 },
                dof,
            }
        })
        .collect()
}

/// The part of each target's deviation that the deviation of the input causes, by repeat.
fn explained_by_input(
    experiment: &Experiment,
    prepared: &Prepared,
    problem: &Problem,
    model: Option<&Plant>,
) -> Vec<Vec<Complex>> {
    let zero = Complex::new(0.0, 0.0);
    let input = |p: usize| -> Vec<Complex> {
        experiment.repeats[p].input.iter().map(|u| u / problem.scales.input).collect()
    };
    let repeats = experiment.repeats.len();
    if let Some(plant) = model {
        let deviations: Vec<Vec<Complex>> = (0..repeats).map(input).collect();
        let rows: Vec<&[Complex]> = deviations.iter().map(Vec::as_slice).collect();
        let moved = simulate::respond_to_deviations(
            plant,
            &[],
            &prepared.excitation,
            prepared.highest,
            &rows,
        );
        if let Ok(moved) = moved {
            return moved
                .iter()
                .map(|velocity| {
                    prepared.targets.iter().map(|t| velocity[t.order] * t.per_velocity).collect()
                })
                .collect();
        }
    }
    let lines = prepared.excitation.input();
    let largest = lines.iter().skip(1).map(|u| u.norm()).fold(0.0, f64::max);
    let ratio = |order: usize, value: Complex| match lines.get(order) {
        Some(u) if order > 0 && u.norm() > 0.01 * largest => value / u,
        _ => zero,
    };
    let strongest =
        prepared.targets.iter().map(|t| ratio(t.order, t.value / t.per_velocity).norm());
    let strongest = strongest.fold(0.0, f64::max);
    (0..repeats)
        .map(|p| {
            let input = input(p);
            let at = |order: usize| input.get(order).copied().unwrap_or(zero);
            let of = |t: &super::problem::Target| {
                if t.constraint { at(0) * strongest } else { ratio(t.order, t.value) * at(t.order) }
            };
            prepared.targets.iter().map(of).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, joined, multisine};
    use super::*;
    use crate::measurement::Repeat;

    #[test]
    fn rounding_that_repeats_adds_to_the_scatter_of_periods() {
        let of = |rounding_std: f64| {
            let mut experiments = multisine(&axis(ACTUATORS[0])).experiments().to_vec();
            let e = &mut experiments[0];
            let deviation = |sign: f64| Repeat {
                input: Vec::new(),
                response: vec![Complex::new(sign * 3e-3, sign * 3e-3); e.response.len()],
            };
            e.repeats = vec![deviation(1.0), deviation(-1.0)];
            (e.from_record, e.rounding_std) = (true, rounding_std);
            let measurement = joined(experiments);
            let problem = Problem::new(&measurement).unwrap();
            let weights = weights(&measurement, &problem, &IdentifyOptions::default(), None);
            weights.sigma[0][5] * problem.response_scale
        };
        let (scatter, both) = (of(0.0), of(4e-3));
        // Of two repeats at ± 3e-3 the mean has a standard error of 3e-3.
        assert!((scatter / 3e-3 - 1.0).abs() < 1e-9, "{scatter}");
        assert!((both / 5e-3 - 1.0).abs() < 1e-9, "{both}");
    }
}
