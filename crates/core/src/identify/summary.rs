//! Summarises a fitted point: estimates, goodness of fit, transfer function.

use indexmap::IndexMap;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

use crate::answers::{Correlations, Fit, ParameterEstimate, TransferFunction};
use crate::measurement::{Complex, Measurement};
use crate::plant::{Actuator, Plant};

use super::corrected::Corrected;
use super::eliminated;
use super::estimates::Estimates;
use super::noise::Weights;
use super::objective::{Evaluation, Misfit};
use super::parameters::Coordinate;
use super::pipeline::Fitted;
use super::problem::Problem;
use super::profile::Profile;
use super::refine;
use super::reported_noise::reported;
use super::search_settings::SearchSettings;
use super::uncertainty::{Uncertainty, with_prior};
use super::units::Units;

/// Significance level of the χ² test of adequacy: with a smaller p-value the residuals are more
/// than noise.
const ADEQUACY_LEVEL: f64 = 0.01;

/// What an answer reports about a fitted point.
pub(super) struct Summary {
    /// Estimates by name.
    pub parameters: IndexMap<String, ParameterEstimate>,
    /// Correlations of the identifiable parameters.
    pub correlations: Correlations,
    /// The goodness of fit.
    pub fit: Fit,
    /// The linear block G(s).
    pub transfer_function: TransferFunction,
}

/// How the ends of the parameters' intervals are determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Intervals {
    /// From the curvature at the fitted point.
    Curvature,
    /// From the curvature, or from the profile of the sum of squares if that reaches further. Takes
    /// two more simulations for each parameter, and some refits.
    Profile,
}

/// Summarises a fitted point, of which this is the evaluation.
pub(super) fn summarise(
    measurement: &Measurement,
    (misfit, coarse): (&Misfit<'_>, Option<Corrected<'_>>),
    (fitted, Evaluation { predicted, here }): (&Fitted, &Evaluation),
    intervals: Intervals,
    search: &SearchSettings,
) -> Summary {
    let problem = misfit.problem;
    let held = refine::held(misfit, &fitted.point, here);
    let fitted_count = held.iter().filter(|held| !**held).count();
    // With fewer data than parameters, no degrees of freedom are left.
    let estimated = fitted_count + fitted.weights.eliminated.len();
    let dof = problem.data().saturating_sub(estimated) as i64;
    let fit = goodness(problem, fitted, predicted, dof);
    let known = fitted.weights.known();
    // Without a degree of freedom the residuals are rounding errors, and say nothing of the noise.
    let residual_scale = if dof > 0 { (fitted.cost / dof as f64).sqrt() } else { f64::INFINITY };
    let scale = if known { fit.uncertainty_scale } else { residual_scale };
    let with_prior = with_prior(here, &fitted.coordinates, scale);
    let uncertainty = Uncertainty::new(&with_prior, &held, scale);
    let released = Uncertainty::new(&with_prior, &vec![false; held.len()], scale);
    let quantile = quantile95(if known { fitted.weights.scale_dof } else { dof as f64 });
    let profile = match intervals {
        Intervals::Curvature => None,
        Intervals::Profile => {
            let (noise, about) = ([quantile, scale], (&fitted.point[..], here));
            Profile::new((misfit, coarse), about, &uncertainty, noise, search)
        }
    };
    let reported = |i: usize| fitted.coordinates.list[i] != Coordinate::FcSplit;
    let reaches = |i| profile.as_ref().filter(|_| reported(i))?.reaches(i, &uncertainty);
    let plant = problem.in_units(&fitted.coordinates.plant(&fitted.point));
    let units = Units::of(measurement);
    let estimates = Estimates {
        fitted,
        problem,
        uncertainty: &uncertainty,
        released: &released,
        held: &held,
        quantile,
        reaches: (0..held.len()).map(reaches).collect(),
    };
    let parameters = estimates.all(&plant, &units);
    Summary {
        correlations: estimates.correlations(),
        parameters,
        fit,
        transfer_function: transfer_function(&plant),
    }
}

/// Two-sided 95 % quantile of Student's t, or of the normal distribution if `dof` is large.
fn quantile95(dof: f64) -> f64 {
    let normal = Normal::standard().inverse_cdf(0.975);
    match StudentsT::new(0.0, 1.0, dof) {
        Ok(t) if (1.0..1e4).contains(&dof) => t.inverse_cdf(0.975),
        _ => normal,
    }
}

/// The goodness of fit of these predictions. All standard deviations are later
/// multiplied by `uncertainty_scale`: √(χ²/dof) if the model is not adequate, else 1.
fn goodness(problem: &Problem, fitted: &Fitted, predicted: &[Vec<Complex>], dof: i64) -> Fit {
    let (mut left, mut size, mut simulated, mut count) = (0.0, 0.0, 0.0, 0);
    for (e, experiment) in problem.experiments.iter().enumerate() {
        let Weights { sigma, eliminated, .. } = &fitted.weights;
        let added = eliminated::added(eliminated, (e, experiment), &sigma[e], &predicted[e]);
        for (t, target) in experiment.targets.iter().enumerate().filter(|(_, t)| !t.constraint) {
            left += (predicted[e][t] + added[t] - target.value).norm_sqr();
            size += target.value.norm_sqr();
            simulated += predicted[e][t].norm_sqr();
            count += 1;
        }
    }
    let known = fitted.weights.known();
    let chi2 = known.then_some(fitted.cost);
    let p_value = chi2.filter(|_| dof > 0).and_then(|chi2| {
        let scale_dof = fitted.weights.scale_dof;
        if scale_dof.is_finite() {
            // The scale of the noise is itself estimated, so χ² per degree of freedom is a ratio of
            // variances with an F distribution.
            let ratio = FisherSnedecor::new(dof as f64, scale_dof).ok()?;
            Some(ratio.sf(chi2 / dof as f64))
        } else {
            Some(ChiSquared::new(dof as f64).ok()?.sf(chi2))
        }
    });
    // A model whose residuals are larger than its response explains nothing, however large the
    // noise.
    let adequate = p_value.map(|p| p >= ADEQUACY_LEVEL && left <= simulated);
    let chi2_per_dof = chi2.filter(|_| dof > 0).map(|chi2| chi2 / dof as f64);
    let uncertainty_scale = match (adequate, chi2_per_dof) {
        (Some(false), Some(ratio)) => ratio.max(1.0).sqrt(),
        _ => 1.0,
    };
    Fit {
        chi2,
        dof,
        chi2_per_dof,
        nrmse: (left / size).sqrt(),
        rms_residual: (left / f64::from(count)).sqrt() * problem.response_scale,
        p_value,
        adequate,
        uncertainty_scale,
        unanswered: Vec::new(),
        noise_law: reported(&fitted.weights, problem),
    }
}

/// G(s) = A(s)·K/(s + a) as polynomials and poles.
fn transfer_function(plant: &Plant) -> TransferFunction {
    let (a, k) = (plant.viscous_rate_rad_s, plant.constant);
    let (numerator, denominator, mut poles) = match plant.actuator {
        Actuator::Direct => (k, vec![1.0, a], vec![]),
        Actuator::FirstOrder { corner_rad_s: p } => {
            (k * p, vec![1.0, a + p, a * p], vec![[-p, 0.0]])
        }
        Actuator::SecondOrder { natural_frequency_rad_s: wn, damping_ratio: zeta } => {
            let (real, discriminant) = (-zeta * wn, zeta * zeta - 1.0);
            let root = wn * discriminant.abs().sqrt();
            let poles = if discriminant < 0.0 {
                vec![[real, root], [real, -root]]
            } else {
                vec![[real + root, 0.0], [real - root, 0.0]]
            };
            let linear = 2.0 * zeta * wn;
            let square = wn * wn;
            let denominator = vec![1.0, linear + a, square + a * linear, a * square];
            (k * square, denominator, poles)
        }
    };
    poles.insert(0, [-a, 0.0]);
    TransferFunction { numerator: vec![numerator], denominator, poles, dc_gain: k / a }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis};
    use super::*;

    #[test]
    fn the_transfer_function_is_actuator_times_mechanics() {
        for actuator in ACTUATORS {
            let plant = axis(actuator);
            let TransferFunction { numerator, denominator, poles, dc_gain } =
                transfer_function(&plant);
            let s = Complex::new(0.0, 17.0);
            let polynomial = |coefficients: &[f64]| {
                coefficients.iter().fold(Complex::new(0.0, 0.0), |sum, c| sum * s + c)
            };
            let wanted = actuator.response(17.0) * plant.mechanics_response(17.0);
            let found = polynomial(&numerator) / polynomial(&denominator);
            assert!((found - wanted).norm() < 1e-14, "{found} {wanted}");
            let product: Complex =
                poles.iter().map(|[re, im]| s - Complex::new(*re, *im)).product();
            assert!((product / polynomial(&denominator) - 1.0).norm() < 1e-14);
            assert!((dc_gain - numerator[0] / denominator[denominator.len() - 1]).abs() < 1e-14);
        }
    }

    #[test]
    fn an_overdamped_actuator_has_two_real_poles() {
        let actuator = Actuator::SecondOrder { natural_frequency_rad_s: 6.0, damping_ratio: 1.25 };
        let poles = transfer_function(&axis(actuator)).poles;
        assert_eq!(poles, [[-10.0, 0.0], [-3.0, 0.0], [-12.0, 0.0]]);
    }

    // Student's t(0.975) at 10 degrees of freedom is 2.2281; the normal quantile is 1.960.
    #[test]
    fn an_estimated_noise_widens_the_quantile() {
        assert!((quantile95(10.0) - 2.2281).abs() < 1e-4);
        assert!((quantile95(f64::INFINITY) - 1.9600).abs() < 1e-4);
    }
}
