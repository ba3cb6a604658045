//! The standard deviation of each datum.
//!
//! Standard deviations come from the upload or from the scatter of repeats or periods (`scatter`).
//! Where nothing states them, their ratios follow from the scatter of what a model leaves
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

mod input_spectrum;
mod measured_input;
mod scatter;
mod weights;

use crate::answers::{IdentifyOptions, NoiseSource, Weighting};
use crate::effects::ActiveEffect;
use crate::measurement::Measurement;
use crate::plant::Plant;

use super::estimated_noise::EstimatedLaw;
use super::local_scatter::LocalScatter;
use super::problem::Problem;
use scatter::{from_scatter, scatters};
pub(super) use weights::Weights;

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
    deviations(measurement, problem, options, model).eliminating(problem)
}

/// The same without what is eliminated.
fn deviations(
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
        eliminated: Vec::new(),
        correlations: Vec::new(),
        noisier: Vec::new(),
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
