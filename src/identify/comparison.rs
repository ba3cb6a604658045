//! A measurement beside what an identified model makes of it.

use crate::answers::{
    ComparedExperiment, ComparedHarmonic, Comparison, Identification, NoiseSource, Unanswered,
};
use crate::measurement::{Complex, Experiment, Measurement, ResponseKind};
use crate::plant::{Actuator, Friction, Plant};
use crate::simulate;

use super::IdentifyError;
use super::noise;
use super::problem::{Prepared, Problem};

/// Simulates an identified model on the measurement's own excitations.
///
/// Deviations are those of the fit; where the noise is unknown, they are the
/// root mean square of the residual's real components.
///
/// # Errors
/// [`IdentifyError::Unusable`] where the measurement cannot be fitted at all,
/// or the answer does not say its parameters.
pub fn compare(
    measurement: &Measurement,
    answer: &Identification,
) -> Result<Comparison, IdentifyError> {
    let problem = Problem::new(measurement)?;
    let plant = plant(answer).ok_or_else(|| IdentifyError::Unusable {
        reason: "the result does not give every parameter of the model".into(),
    })?;
    let metadata = measurement.metadata();
    let model = in_scale(&problem, &plant);
    let noise_std = answer.provenance.options.noise_std;
    let weights = noise::weights(measurement, &problem, noise_std, Some(&model));
    let mut comparison = Comparison {
        input_unit: metadata.input.unit.clone(),
        response_unit: metadata.response.unit.clone(),
        response_quantity: match metadata.response_kind {
            ResponseKind::Velocity => "velocity",
            ResponseKind::Position => "position",
            ResponseKind::Acceleration => "acceleration",
        }
        .to_owned(),
        std_estimated: answer.noise == NoiseSource::Estimated,
        experiments: Vec::new(),
        unanswered: Vec::new(),
    };
    for (index, (experiment, prepared)) in
        measurement.experiments().iter().zip(&problem.experiments).enumerate()
    {
        match simulate::respond(&model, &[], &prepared.excitation, prepared.highest) {
            Ok(velocity) => {
                let deviations = &weights.sigma[index];
                let harmonics = harmonics(&problem, experiment, prepared, &velocity, deviations);
                comparison.experiments.push(ComparedExperiment {
                    experiment: index,
                    magnitude: experiment.magnitude,
                    omega_rad_s: experiment.omega_rad_s,
                    run: experiment.run,
                    harmonics,
                });
            }
            Err(error) => comparison
                .unanswered
                .push(Unanswered { experiment: index, reason: error.to_string() }),
        }
    }
    if comparison.std_estimated {
        estimate_deviations(&mut comparison.experiments);
    }
    Ok(comparison)
}

fn harmonics(
    problem: &Problem,
    experiment: &Experiment,
    prepared: &Prepared,
    velocity: &[Complex],
    deviations: &[f64],
) -> Vec<ComparedHarmonic> {
    let pair = |z: Complex| [z.re, z.im];
    let data = prepared.targets.iter().zip(deviations).filter(|(target, _)| !target.constraint);
    data.map(|(target, deviation)| {
        let simulated = velocity[target.order] * target.per_velocity;
        ComparedHarmonic {
            order: target.order,
            input: experiment.input.get(target.order).copied().map_or([0.0; 2], pair),
            measured: pair(target.value * problem.response_scale),
            simulated: pair(simulated * problem.response_scale),
            std: deviation * problem.response_scale,
        }
    })
    .collect()
}

fn estimate_deviations(experiments: &mut [ComparedExperiment]) {
    let (mut squares, mut count) = (0.0, 0.0);
    for harmonic in experiments.iter().flat_map(|e| &e.harmonics) {
        let [re, im] = [0, 1].map(|i| harmonic.measured[i] - harmonic.simulated[i]);
        squares += re * re + if harmonic.order == 0 { 0.0 } else { im * im };
        count += if harmonic.order == 0 { 1.0 } else { 2.0 };
    }
    let std = if count > 0.0 { f64::sqrt(squares / count) } else { 0.0 };
    experiments.iter_mut().flat_map(|e| &mut e.harmonics).for_each(|h| h.std = std);
}

/// The plant of an answer. What the data does not determine is taken from where
/// the last stage ended.
fn plant(answer: &Identification) -> Option<Plant> {
    let order = answer.order_choice.as_ref().map(|choice| choice.actuator_order);
    let suffix = order.map(|order| format!(" (order {order})")).unwrap_or_default();
    let last = answer.stages.iter().rev().find(|stage| stage.name.ends_with(&suffix));
    let value = |name: &str| {
        let estimate = answer.parameters.get(name).and_then(|estimate| estimate.value);
        estimate.or_else(|| last.and_then(|stage| stage.parameters.get(name).copied()))
    };
    let level = |name: &str| {
        let mean = answer.parameters.get("fc_mean").and_then(|estimate| estimate.value);
        answer.parameters.get(name).and_then(|estimate| estimate.value).or(mean).or(value(name))
    };
    let actuator = match (value("actuator_pole"), value("natural_frequency")) {
        (Some(pole), _) => Actuator::FirstOrder { corner_rad_s: -pole },
        (None, Some(natural_frequency_rad_s)) => Actuator::SecondOrder {
            natural_frequency_rad_s,
            damping_ratio: value("damping_ratio")?,
        },
        (None, None) => Actuator::Direct,
    };
    Some(Plant {
        viscous_rate_rad_s: -value("pole")?,
        constant: value("constant")?,
        actuator,
        friction: Friction::coulomb(level("fc_plus")?, level("fc_minus")?),
    })
}

/// A plant in units of the upload as a plant in scale.
fn in_scale(problem: &Problem, plant: &Plant) -> Plant {
    let scales = problem.scales;
    Plant {
        viscous_rate_rad_s: plant.viscous_rate_rad_s / scales.omega,
        constant: plant.constant * scales.input / (scales.velocity * scales.omega),
        actuator: match plant.actuator {
            Actuator::Direct => Actuator::Direct,
            Actuator::FirstOrder { corner_rad_s } => {
                Actuator::FirstOrder { corner_rad_s: corner_rad_s / scales.omega }
            }
            Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
                Actuator::SecondOrder {
                    natural_frequency_rad_s: natural_frequency_rad_s / scales.omega,
                    damping_ratio,
                }
            }
        },
        friction: Friction::coulomb(
            plant.friction.fc_plus / scales.input,
            plant.friction.fc_minus / scales.input,
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, stepped_sine};
    use super::super::{IdentifyRequest, identify};
    use super::*;
    use crate::answers::PlantRequest;
    use crate::observer::Silent;

    #[test]
    fn an_identified_model_is_compared_as_it_was_fitted() {
        let measurement = stepped_sine(&axis(ACTUATORS[1]), 3);
        let plant = Some(PlantRequest { actuator_order: 1 });
        let request = IdentifyRequest { plant, ..IdentifyRequest::default() };
        let answer = identify(&measurement, &request, &Silent).unwrap();
        let comparison = compare(&measurement, &answer).unwrap();
        assert_eq!(comparison.experiments.len(), measurement.experiments().len());
        assert!(comparison.std_estimated && comparison.unanswered.is_empty());
        let (mut left, mut size) = (0.0, 0.0);
        for harmonic in comparison.experiments.iter().flat_map(|e| &e.harmonics) {
            for i in 0..2 {
                left += (harmonic.measured[i] - harmonic.simulated[i]).powi(2);
                size += harmonic.measured[i].powi(2);
            }
        }
        // The same residual by another way: digits that cancel in data without noise.
        let difference = (left / size).sqrt() - answer.fit.nrmse;
        assert!(difference.abs() < 1e-12, "{difference}");
    }
}
