//! Chooses the order of the actuator by Schwarz's Bayesian information criterion (BIC).

use crate::answers::{OrderCandidate, OrderChoice};

use crate::observer::Observer;

use super::noise::Weights;
use super::objective::Misfit;
use super::parameters::Coordinate;
use super::pipeline::Fitted;
use super::problem::{Problem, Target};
use super::refine;

/// Misfit below this share of the largest response is rounding in the upload and no reason for
/// another pole.
const UPLOAD_ROUNDING: f64 = 1e-6;

/// Share of the misfit that each parameter must remove if the misfit is the model's error and not
/// noise (tuned). Such residuals are not independent, so statistical significance is cheap, and
/// only a useful improvement counts.
const USEFUL_SHARE: f64 = 0.05;

/// Chooses among fits of several orders, given in ascending order.
///
/// The criterion is Schwarz's (1978, doi:10.1214/aos/1176344136), with N data:
/// - noise known, and some model explains the data: χ² + ln N for every parameter;
/// - noise unknown: N·ln(cost/N) + ln N for every parameter;
/// - noise known, but no model explains the data: N·ln(cost/N), and every parameter must remove
///   [`USEFUL_SHARE`] of the misfit.
///
/// At equal criterion the lower order is chosen.
pub(super) fn choose(problem: &Problem, fits: &[Fitted], observer: &dyn Observer) -> OrderChoice {
    let data = problem.data() as f64;
    let costs = comparable_costs(problem, fits, observer);
    let best_cost = costs.iter().copied().fold(f64::INFINITY, f64::min);
    let known = fits.iter().all(|fit| fit.weights.known());
    // The χ² of pure noise has mean N and standard deviation √(2N).
    let explained = known && best_cost < data + 4.0 * (2.0 * data).sqrt();
    let penalty = if known && !explained { USEFUL_SHARE * data } else { data.ln() };
    let rounding = if known { 0.0 } else { rounding(problem, &fits[0].weights) };
    let candidates: Vec<OrderCandidate> = fits
        .iter()
        .zip(costs)
        .map(|(fit, cost)| {
            let parameters = fit.coordinates.len();
            let misfit = if explained { cost } else { data * ((cost + rounding) / data).ln() };
            OrderCandidate {
                actuator_order: fit.order,
                chi2: cost,
                parameters,
                criterion: misfit + penalty * parameters as f64,
            }
        })
        .collect();
    let chosen = candidates
        .iter()
        .zip(fits)
        .filter(|(_, fit)| actuator_is_seen(fit))
        .map(|(candidate, _)| candidate)
        .reduce(|best, next| if next.criterion < best.criterion { next } else { best })
        .unwrap_or(&candidates[0]);
    let explanation = explain(chosen, &candidates, explained);
    OrderChoice { actuator_order: chosen.actuator_order, explanation, candidates }
}

/// Whether the rate of the actuator is below its upper bound. An actuator at the bound is as good
/// as none, even if it lowers the misfit a little.
fn actuator_is_seen(fit: &Fitted) -> bool {
    let coordinates = &fit.coordinates;
    (0..coordinates.len()).all(|i| {
        let is_rate =
            matches!(coordinates.list[i], Coordinate::ActuatorRate | Coordinate::NaturalFrequency);
        !is_rate || fit.point[i] < coordinates.upper[i]
    })
}

/// The cost that rounding leaves.
fn rounding(problem: &Problem, weights: &Weights) -> f64 {
    let experiments = problem.experiments.iter().zip(&weights.sigma);
    let of_datum = |(target, sigma): (&Target, &f64)| {
        (if target.real { 1.0 } else { 2.0 }) * (UPLOAD_ROUNDING / sigma).powi(2)
    };
    experiments.flat_map(|(e, sigma)| e.targets.iter().zip(sigma)).map(of_datum).sum()
}

/// Costs under equal weights. If weights depend on the model, every fit has its own; all fits are
/// then refined with the weights of the best one.
fn comparable_costs(problem: &Problem, fits: &[Fitted], observer: &dyn Observer) -> Vec<f64> {
    let best = fits.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
    let differ = |best: &&Fitted| fits.iter().any(|fit| fit.weights.sigma != best.weights.sigma);
    let Some(best) = best.filter(differ) else {
        return fits.iter().map(|fit| fit.cost).collect();
    };
    fits.iter()
        .map(|fit| {
            let coordinates = &fit.coordinates;
            let misfit = Misfit::new(problem, coordinates, &best.weights, observer);
            refine::refine(&misfit, &fit.point, refine::THOROUGH, &mut |_, _, _| {}).cost
        })
        .collect()
}

fn explain(chosen: &OrderCandidate, all: &[OrderCandidate], explained: bool) -> String {
    let order = chosen.actuator_order;
    let noun = if explained { "χ²" } else { "misfit" };
    let against = |other: &OrderCandidate| {
        let gain = 100.0 * (1.0 - chosen.chi2 / other.chi2);
        format!("order {} ({gain:.2} % less {noun})", other.actuator_order)
    };
    let lower: Vec<String> = all.iter().filter(|c| c.actuator_order < order).map(against).collect();
    let higher: Vec<String> = all
        .iter()
        .filter(|c| c.actuator_order > order)
        .map(|c| c.actuator_order.to_string())
        .collect();
    let mut sentence = format!("actuator order {order}");
    if !lower.is_empty() {
        sentence += &format!(" explains the data better than {}", lower.join(" and than "));
    }
    if !higher.is_empty() {
        let joint = if lower.is_empty() { " is enough:" } else { ";" };
        sentence += &format!(
            "{joint} order {} would not lower the {noun} enough to justify its parameters",
            higher.join(" or ")
        );
    }
    sentence
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, stepped_sine};
    use super::super::noise::Weights;
    use super::super::parameters::Coordinates;
    use super::*;
    use crate::answers::NoiseSource;

    /// The choice if orders 0, 1 and 2 reach these costs per datum; with `fastest`, their actuators
    /// lie at the upper bound of the rate.
    fn choose_among(fastest: bool, source: NoiseSource, costs: [f64; 3]) -> OrderChoice {
        let problem = Problem::new(&stepped_sine(&axis(ACTUATORS[0]), 7)).unwrap();
        let data = problem.data() as f64;
        let fits: Vec<Fitted> = (0..3)
            .map(|order| {
                let coordinates = Coordinates::new(order, false, &problem.prior);
                let mut point = coordinates.within_search(&vec![0.5; coordinates.len() - 1]);
                if fastest && order > 0 {
                    point[4] = coordinates.upper[4];
                }
                let weights = Weights {
                    sigma: problem.experiments.iter().map(|e| vec![1.0; e.targets.len()]).collect(),
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
                let cost = costs[usize::from(order)] * data;
                Fitted { order, coordinates, point, weights, cost, stages: Vec::new() }
            })
            .collect();
        choose(&problem, &fits, &crate::observer::Silent)
    }

    fn choice(source: NoiseSource, costs: [f64; 3]) -> OrderChoice {
        choose_among(false, source, costs)
    }

    #[test]
    fn an_actuator_at_the_upper_bound_of_its_rate_counts_as_none() {
        assert_eq!(choose_among(true, NoiseSource::Given, [2.0, 1.0, 1.0]).actuator_order, 0);
    }

    // 16 experiments of 15 real data: N = 240, ln N = 5.5, which is 0.023 per datum.
    #[test]
    fn another_parameter_must_lower_chi2_by_the_logarithm_of_the_data() {
        let order = |costs| choice(NoiseSource::Given, costs).actuator_order;
        assert_eq!(order([1.0, 0.99, 0.97]), 0);
        assert_eq!(order([1.0, 0.96, 0.95]), 1);
        assert_eq!(order([1.0, 0.99, 0.94]), 2);
    }

    #[test]
    fn where_no_model_explains_the_data_relative_gains_decide() {
        let order = |costs| choice(NoiseSource::Given, costs).actuator_order;
        assert_eq!(order([1000.0, 999.0, 998.0]), 0);
        assert_eq!(order([1000.0, 900.0, 899.0]), 1);
    }

    #[test]
    fn a_misfit_of_the_size_of_upload_rounding_asks_for_no_pole() {
        let choice = choice(NoiseSource::Estimated, [1e-16, 1e-20, 1e-24]);
        assert_eq!(choice.actuator_order, 0);
        assert!(choice.explanation.starts_with("actuator order 0 is enough"));
        assert_eq!(choice.candidates.len(), 3);
    }

    #[test]
    fn the_explanation_names_the_orders_it_was_compared_with() {
        let text = choice(NoiseSource::Given, [9.0, 1.0, 1.0]).explanation;
        assert!(text.contains("better than order 0 (88.89 % less"), "{text}");
        assert!(text.contains("order 2 would not lower"), "{text}");
    }
}
