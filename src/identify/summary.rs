//! From a fitted point to the answer: parameters by name, in units, with
//! intervals.

use indexmap::IndexMap;
use nalgebra::DMatrix;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor, Normal, StudentsT};

use crate::answers::{Correlations, Fit, ParameterEstimate, TransferFunction};
use crate::measurement::{Measurement, ResponseKind};
use crate::plant::{Actuator, Plant};

use super::abc_ann::Fitted;
use super::objective::Misfit;
use super::parameters::{CONSTANT, Coordinate};
use super::problem::Problem;
use super::refine;
use super::uncertainty::{Uncertainty, unit};

/// Probability below which a residual is more than noise.
const LEVEL: f64 = 0.01;

/// Parameters of a plant by name, in its units.
pub(super) fn values(plant: &Plant) -> IndexMap<String, f64> {
    let mut values = IndexMap::new();
    let mut insert = |name: &str, value: f64| {
        values.insert(name.to_owned(), value);
    };
    insert("pole", -plant.viscous_rate_rad_s);
    insert("constant", plant.constant);
    insert("dc_gain", plant.constant / plant.viscous_rate_rad_s);
    insert("fc_plus", plant.friction.fc_plus);
    insert("fc_minus", plant.friction.fc_minus);
    match plant.actuator {
        Actuator::Direct => {}
        Actuator::FirstOrder { corner_rad_s } => insert("actuator_pole", -corner_rad_s),
        Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
            insert("natural_frequency", natural_frequency_rad_s);
            insert("damping_ratio", damping_ratio);
        }
    }
    values
}

/// Everything an answer says of a fitted point.
pub(super) struct Summary {
    /// Estimates by name.
    pub parameters: IndexMap<String, ParameterEstimate>,
    /// Correlations of what is identifiable.
    pub correlations: Correlations,
    /// How well it fits.
    pub fit: Fit,
    /// The linear block.
    pub transfer_function: TransferFunction,
}

/// Summarises a fitted point.
pub(super) fn summarise(
    measurement: &Measurement,
    problem: &Problem,
    fitted: &Fitted,
    misfit: &Misfit<'_>,
) -> Option<Summary> {
    let here = misfit.linearise(&fitted.point).ok()?;
    let held = refine::held(misfit, &fitted.point, &here);
    let fitted_count = held.iter().filter(|held| !**held).count();
    let dof = problem.data() as i64 - fitted_count as i64;
    let fit = goodness(problem, fitted, misfit, dof)?;
    let known = fitted.weights.known();
    let residual_scale = (fitted.cost / dof.max(1) as f64).sqrt();
    let scale = if known { fit.uncertainty_scale } else { residual_scale };
    let uncertainty = Uncertainty::new(&here, &held, scale);
    let quantile = quantile95(if known { fitted.weights.scale_dof } else { dof as f64 });
    let plant = problem.in_units(&fitted.coordinates.plant(&fitted.point));
    let units = Units::of(measurement);
    let estimates = Estimates { fitted, problem, uncertainty: &uncertainty, held: &held, quantile };
    let parameters = estimates.all(&plant, &units);
    Some(Summary {
        correlations: estimates.correlations(),
        parameters,
        fit,
        transfer_function: transfer_function(&plant),
    })
}

fn quantile95(dof: f64) -> f64 {
    let normal = Normal::standard().inverse_cdf(0.975);
    match StudentsT::new(0.0, 1.0, dof) {
        Ok(t) if (1.0..1e4).contains(&dof) => t.inverse_cdf(0.975),
        _ => normal,
    }
}

fn goodness(problem: &Problem, fitted: &Fitted, misfit: &Misfit<'_>, dof: i64) -> Option<Fit> {
    let predicted = misfit.predict(&fitted.point).ok()?;
    let (mut left, mut size, mut count) = (0.0, 0.0, 0);
    for (e, experiment) in problem.experiments.iter().enumerate() {
        for (t, target) in experiment.targets.iter().enumerate().filter(|(_, t)| !t.constraint) {
            left += (predicted[e][t] - target.value).norm_sqr();
            size += target.value.norm_sqr();
            count += 1;
        }
    }
    let known = fitted.weights.known();
    let chi2 = known.then_some(fitted.cost);
    let p_value = chi2.filter(|_| dof > 0).and_then(|chi2| {
        let scale_dof = fitted.weights.scale_dof;
        if scale_dof.is_finite() {
            // The scale of the noise is itself estimated: a ratio of variances.
            let ratio = FisherSnedecor::new(dof as f64, scale_dof).ok()?;
            Some(ratio.sf(chi2 / dof as f64))
        } else {
            Some(ChiSquared::new(dof as f64).ok()?.sf(chi2))
        }
    });
    let adequate = p_value.map(|p| p >= LEVEL);
    let chi2_per_dof = chi2.filter(|_| dof > 0).map(|chi2| chi2 / dof as f64);
    let uncertainty_scale = match (adequate, chi2_per_dof) {
        (Some(false), Some(ratio)) => ratio.max(1.0).sqrt(),
        _ => 1.0,
    };
    Some(Fit {
        chi2,
        dof,
        chi2_per_dof,
        nrmse: (left / size).sqrt(),
        rms_residual: (left / f64::from(count)).sqrt() * problem.response_scale,
        p_value,
        adequate,
        uncertainty_scale,
    })
}

/// Units of the parameters, made of those of the upload.
struct Units {
    input: String,
    velocity: String,
}

impl Units {
    fn of(measurement: &Measurement) -> Self {
        let metadata = measurement.metadata();
        let or =
            |unit: &str, name: &str| if unit.is_empty() { name.into() } else { unit.to_owned() };
        let response = or(&metadata.response.unit, "response");
        let velocity = match metadata.response_kind {
            ResponseKind::Velocity => response,
            ResponseKind::Position => format!("{response}/s"),
            ResponseKind::Acceleration => format!("{response}·s"),
        };
        Self { input: or(&metadata.input.unit, "input"), velocity }
    }
}

struct Estimates<'a> {
    fitted: &'a Fitted,
    problem: &'a Problem,
    uncertainty: &'a Uncertainty,
    held: &'a [bool],
    quantile: f64,
}

impl Estimates<'_> {
    fn all(&self, plant: &Plant, units: &Units) -> IndexMap<String, ParameterEstimate> {
        let Units { input, velocity } = units;
        let mut parameters = IndexMap::new();
        let mut insert = |name: &str, estimate: ParameterEstimate| {
            parameters.insert(name.to_owned(), estimate);
        };
        let rate = |value: f64, i: usize| self.logarithmic(value, i, "rad/s");
        let constant = format!("({velocity})/({input}·s)");
        let gain = format!("({velocity})/({input})");
        insert("pole", rate(-plant.viscous_rate_rad_s, 0));
        insert("constant", self.logarithmic(plant.constant, CONSTANT, &constant));
        insert("dc_gain", self.dc_gain(plant, &gain));
        for (i, coordinate) in self.fitted.coordinates.list.iter().enumerate() {
            let friction = plant.friction;
            let level = |value: f64| self.linear(value, i, input);
            match coordinate {
                Coordinate::ViscousRate | Coordinate::Constant => {}
                Coordinate::FcPlus => insert("fc_plus", level(friction.fc_plus)),
                Coordinate::FcMinus => insert("fc_minus", level(friction.fc_minus)),
                Coordinate::FcMean => {
                    let unknown = ParameterEstimate {
                        value: Some(friction.fc_plus),
                        std: None,
                        interval95: None,
                        unit: input.clone(),
                        at_bound: false,
                        identifiable: false,
                    };
                    insert("fc_plus", unknown.clone());
                    insert("fc_minus", unknown);
                    insert("fc_mean", level(friction.fc_plus));
                }
                Coordinate::ActuatorRate => {
                    if let Actuator::FirstOrder { corner_rad_s } = plant.actuator {
                        insert("actuator_pole", rate(-corner_rad_s, i));
                    }
                }
                Coordinate::NaturalFrequency => {
                    if let Actuator::SecondOrder { natural_frequency_rad_s, .. } = plant.actuator {
                        insert("natural_frequency", rate(natural_frequency_rad_s, i));
                    }
                }
                Coordinate::DampingRatio => {
                    if let Actuator::SecondOrder { damping_ratio, .. } = plant.actuator {
                        insert("damping_ratio", self.logarithmic(damping_ratio, i, ""));
                    }
                }
            }
        }
        parameters
    }

    /// A parameter whose logarithm was estimated: its interval is that of the
    /// logarithm, so it never crosses zero.
    fn logarithmic(&self, value: f64, i: usize, unit_text: &str) -> ParameterEstimate {
        let std = self.uncertainty.std(&unit(&self.fitted.coordinates, i));
        self.of_logarithm(value, std, self.held[i], unit_text)
    }

    fn of_logarithm(
        &self,
        value: f64,
        std: Option<f64>,
        at_bound: bool,
        unit_text: &str,
    ) -> ParameterEstimate {
        let std = std.filter(|_| !at_bound);
        let ends = std.map(|std| {
            let factor = (self.quantile * std).exp();
            let (a, b) = (value / factor, value * factor);
            [a.min(b), a.max(b)]
        });
        ParameterEstimate {
            value: Some(value),
            std: std.map(|std| std * value.abs()),
            interval95: ends,
            unit: unit_text.to_owned(),
            at_bound,
            identifiable: std.is_some(),
        }
    }

    fn linear(&self, value: f64, i: usize, unit_text: &str) -> ParameterEstimate {
        let scale = self.problem.scales.input;
        let std = self.uncertainty.std(&unit(&self.fitted.coordinates, i)).map(|std| std * scale);
        let at_bound = self.held[i];
        let std = std.filter(|_| !at_bound);
        ParameterEstimate {
            value: Some(value),
            std,
            interval95: std
                .map(|std| [(value - self.quantile * std).max(0.0), value + self.quantile * std]),
            unit: unit_text.to_owned(),
            at_bound,
            identifiable: std.is_some(),
        }
    }

    fn dc_gain(&self, plant: &Plant, unit_text: &str) -> ParameterEstimate {
        let mut combination = vec![0.0; self.fitted.coordinates.len()];
        combination[0] = -1.0;
        combination[CONSTANT] = 1.0;
        let std = self.uncertainty.std(&combination);
        let value = plant.constant / plant.viscous_rate_rad_s;
        self.of_logarithm(value, std, self.held[0] || self.held[CONSTANT], unit_text)
    }

    fn correlations(&self) -> Correlations {
        let list = &self.fitted.coordinates.list;
        let which: Vec<usize> = (0..list.len())
            .filter(|i| !self.held[*i])
            .filter(|i| self.uncertainty.std(&unit(&self.fitted.coordinates, *i)).is_some())
            .collect();
        let mut matrix = self.uncertainty.correlations(&which);
        // Poles are reported as −a and −p.
        let sign = |i: usize| match list[i] {
            Coordinate::ViscousRate | Coordinate::ActuatorRate => -1.0,
            _ => 1.0,
        };
        let signs =
            DMatrix::from_fn(which.len(), which.len(), |r, c| sign(which[r]) * sign(which[c]));
        for (r, row) in matrix.iter_mut().enumerate() {
            for (c, value) in row.iter_mut().enumerate() {
                *value *= signs[(r, c)];
            }
        }
        let names = which.iter().map(|i| name(list[*i]).to_owned()).collect();
        Correlations { names, matrix }
    }
}

fn name(coordinate: Coordinate) -> &'static str {
    match coordinate {
        Coordinate::ViscousRate => "pole",
        Coordinate::Constant => "constant",
        Coordinate::FcPlus => "fc_plus",
        Coordinate::FcMinus => "fc_minus",
        Coordinate::FcMean => "fc_mean",
        Coordinate::ActuatorRate => "actuator_pole",
        Coordinate::NaturalFrequency => "natural_frequency",
        Coordinate::DampingRatio => "damping_ratio",
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
    use crate::measurement::Complex;

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

    // Student's table: t(0.975) at 10 degrees of freedom; the normal's 1.960.
    #[test]
    fn an_estimated_noise_widens_the_quantile() {
        assert!((quantile95(10.0) - 2.2281).abs() < 1e-4);
        assert!((quantile95(f64::INFINITY) - 1.9600).abs() < 1e-4);
    }
}
