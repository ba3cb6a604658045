//! Compares the response of an identified model with the measured one, harmonic by harmonic.

use rayon::prelude::*;

use crate::answers::{
    ComparedExperiment, ComparedHarmonic, Comparison, Identification, NoiseSource, Unanswered,
};
use crate::effects;
use crate::effects::{ActiveEffect, Effect, Parameter};
use crate::measurement::{Complex, Experiment, Measurement, ResponseKind};
use crate::plant::{Actuator, Friction, Plant};
use crate::simulate::{Counts, NoResponse};

use super::eliminated;
use super::estimated_input;
use super::noise;
use super::noise::{Beside, Weights};
use super::problem::{Prepared, Problem, Scales, Target};
use super::request::IdentifyError;

/// Compares a measurement with the model of a stored answer.
///
/// The model is rebuilt from the reported parameters, and the standard deviations are those of the
/// fit. An experiment for which the model has no response is listed in the result and is not an
/// error.
///
/// # Errors
/// [`IdentifyError::Unusable`] if the answer lacks a parameter of the model, or if the measurement
/// cannot be fitted at all.
pub fn compare(
    measurement: &Measurement,
    answer: &Identification,
) -> Result<Comparison, IdentifyError> {
    let measurement = &*measurement.repeated();
    let left_out: Vec<usize> = answer.fit.unanswered.iter().map(|lost| lost.experiment).collect();
    let whole = Problem::new(measurement)?;
    let mut problem = whole.only(&whole.subset(|e, _| !left_out.contains(&e)));
    let plant = problem.in_scale(&reported_plant(answer)?);
    let effects = reported_effects(answer, problem.scales)?;
    if problem.lacks_inputs() {
        for _ in 0..estimated_input::ROUNDS {
            let weights = weights_of(measurement, &problem, answer)?;
            // An experiment without a response is listed below.
            let _ = problem.estimate_inputs((&plant, &effects), &weights);
        }
    }
    let weights = weights_of(measurement, &problem, answer)?;
    let simulated = simulated(&problem, (&plant, &effects), |_| true);
    Ok(beside(measurement, (&problem, &[]), simulated, &weights, answer.fit.dof))
}

/// The weights of a problem beside the model of a stored answer.
///
/// # Errors
/// [`IdentifyError::Unusable`] if the answer lacks a parameter of the model.
pub(super) fn weights_of(
    measurement: &Measurement,
    problem: &Problem,
    answer: &Identification,
) -> Result<Weights, IdentifyError> {
    let plant = &problem.in_scale(&reported_plant(answer)?);
    let effects = &reported_effects(answer, problem.scales)?;
    let options = &answer.provenance.options;
    Ok(noise::weights(measurement, problem, options, Some(Beside { plant, effects })))
}

/// Indices of experiments, with the simulated value of each target, in scale.
pub(super) type Simulated = Vec<(usize, Result<Vec<Complex>, NoResponse>)>;

/// Simulates the experiments that are `wanted` from rest. Plant and effects are in the problem's units.
pub(super) fn simulated(
    problem: &Problem,
    (plant, effects): (&Plant, &[ActiveEffect]),
    wanted: impl Fn(usize) -> bool,
) -> Simulated {
    let respond = |experiment: &Prepared| {
        let velocity = experiment.respond(Counts::FromRest, plant, effects)?;
        let of = |target: &Target| velocity[target.order] * target.per_velocity;
        Ok(experiment.targets.iter().map(of).collect())
    };
    let all = problem.experiments.iter().enumerate();
    let wanted: Vec<_> = all.filter(|(index, _)| wanted(*index)).collect();
    wanted.into_par_iter().map(|(index, experiment)| (index, respond(experiment))).collect()
}

/// Compares measured responses with simulated ones. The corrections are added to each simulated target
/// of each experiment; without any, nothing is. `dof` are the degrees of freedom of the fit.
pub(super) fn beside(
    measurement: &Measurement,
    (problem, corrections): (&Problem, &[Vec<Complex>]),
    simulated: Simulated,
    weights: &Weights,
    dof: i64,
) -> Comparison {
    let mut experiments = Vec::new();
    let mut unanswered = Vec::new();
    for (index, response) in simulated {
        let (experiment, prepared) =
            (&measurement.experiments()[index], &problem.experiments[index]);
        match response {
            Ok(simulated) => experiments.push(ComparedExperiment {
                experiment: index,
                magnitude: experiment.magnitude,
                omega_rad_s: experiment.omega_rad_s,
                run: experiment.run,
                harmonics: harmonics(
                    experiment,
                    (prepared, corrections.get(index).map_or(&[], Vec::as_slice)),
                    (index, &simulated),
                    weights,
                    problem.response_scale,
                ),
            }),
            Err(error) => {
                unanswered.push(Unanswered {
                    experiment: index,
                    magnitude: Some(experiment.magnitude),
                    omega_rad_s: Some(experiment.omega_rad_s),
                    reason: error.to_string(),
                });
            }
        }
    }
    let metadata = measurement.metadata();
    let mut comparison = Comparison {
        input_unit: metadata.input.unit.clone(),
        response_unit: metadata.response.unit.clone(),
        response_quantity: match metadata.response_kind {
            ResponseKind::Velocity => "velocity",
            ResponseKind::Position => "position",
            ResponseKind::Acceleration => "acceleration",
        }
        .to_owned(),
        std_estimated: weights.source == NoiseSource::Estimated,
        experiments,
        unanswered,
    };
    if comparison.std_estimated {
        estimate_std(&mut comparison, problem.data() as i64 - dof);
    }
    comparison
}

fn harmonics(
    experiment: &Experiment,
    (prepared, corrections): (&Prepared, &[Complex]),
    (index, alone): (usize, &[Complex]),
    weights: &Weights,
    response_scale: f64,
) -> Vec<ComparedHarmonic> {
    let pair = |z: Complex| [z.re, z.im];
    let sigma = &weights.sigma[index];
    let added = eliminated::added(&weights.eliminated, (index, prepared), sigma, alone);
    let targets = prepared.targets.iter().zip(sigma).enumerate();
    targets
        .filter(|(_, (target, _))| !target.constraint)
        .map(|(t, (target, sigma))| {
            let order = target.order;
            let correction = corrections.get(t).copied().unwrap_or(Complex::ZERO);
            let simulated = (alone[t] + added[t] + correction) * response_scale;
            let measured = experiment.harmonic(order).map_or(Complex::ZERO, |h| h.value);
            ComparedHarmonic {
                order,
                input: pair(experiment.input.get(order).copied().unwrap_or(Complex::ZERO)),
                measured: pair(measured),
                simulated: pair(simulated),
                std: sigma * response_scale,
            }
        })
        .collect()
}

/// Scales the standard deviations, of which only the ratios are known, by the residuals per degree
/// of freedom.
fn estimate_std(comparison: &mut Comparison, parameters: i64) {
    let harmonics = || comparison.experiments.iter().flat_map(|e| &e.harmonics);
    let real = |h: &ComparedHarmonic| if h.order == 0 { 1 } else { 2 };
    let data: i64 = harmonics().map(real).sum();
    let squares: f64 = harmonics()
        .map(|h| {
            let left = [h.measured[0] - h.simulated[0], h.measured[1] - h.simulated[1]];
            (left[0] * left[0] + left[1] * left[1]) / (h.std * h.std)
        })
        .sum();
    let scale = (squares / (data - parameters).max(1) as f64).sqrt();
    // Other code divides by these deviations, so they must not be 0 even for a perfect fit.
    let scaled = |std: f64| (scale * std).max(f64::MIN_POSITIVE);
    let experiments = comparison.experiments.iter_mut();
    experiments.flat_map(|e| &mut e.harmonics).for_each(|h| h.std = scaled(h.std));
}

/// The plant that an answer reports, in units of the upload.
pub(super) fn reported_plant(answer: &Identification) -> Result<Plant, IdentifyError> {
    let value = |name: &str| {
        let estimate = answer.parameters.get(name);
        estimate.and_then(|estimate| estimate.value).ok_or_else(|| IdentifyError::Unusable {
            reason: format!("the answer to compare with has no value of {name}"),
        })
    };
    let actuator = if answer.parameters.contains_key("natural_frequency") {
        Actuator::SecondOrder {
            natural_frequency_rad_s: value("natural_frequency")?,
            damping_ratio: value("damping_ratio")?,
        }
    } else if answer.parameters.contains_key("actuator_pole") {
        Actuator::FirstOrder { corner_rad_s: -value("actuator_pole")? }
    } else {
        Actuator::Direct
    };
    Ok(Plant {
        viscous_rate_rad_s: -value("pole")?,
        constant: value("constant")?,
        actuator,
        friction: Friction::coulomb(value("fc_plus")?, value("fc_minus")?),
    })
}

/// The effects that an answer reports, converted to these units.
pub(super) fn reported_effects(
    answer: &Identification,
    Scales { omega, input, velocity }: Scales,
) -> Result<Vec<ActiveEffect>, IdentifyError> {
    let effects = answer.parameters.keys().filter_map(|key| effects::find_parameter(key));
    let mut effects: Vec<&dyn Effect> = effects.map(|(effect, _)| effect).collect();
    effects.dedup_by_key(|effect| effect.id());
    let mut reported = Vec::new();
    for effect in effects {
        let value = |parameter: &Parameter| {
            let name = effect.key(parameter);
            let value = answer.parameters.get(&name).and_then(|estimate| estimate.value);
            let scale = parameter.dimension.factor(input, velocity, 1.0 / omega);
            value.map(|value| value / scale).ok_or_else(|| IdentifyError::Unusable {
                reason: format!("the answer to compare with has no value of {name}"),
            })
        };
        let values = effect.parameters().iter().map(value).collect::<Result<_, _>>()?;
        reported.extend(ActiveEffect::new(effect, values).ok());
    }
    let together: Vec<_> = reported.iter().map(ActiveEffect::effect).collect();
    let unusable = |error: effects::SameSlot| IdentifyError::Unusable { reason: error.to_string() };
    effects::check_slots(&together).map_err(unusable)?;
    Ok(reported)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::{IdentifyOptions, PlantRequest};
    use crate::identify::fixtures::{ACTUATORS, axis, stepped_sine};
    use crate::identify::model_fit::fit_base;
    use crate::identify::request::IdentifyRequest;
    use crate::observer::Silent;

    fn request(order: u8) -> IdentifyRequest {
        let mut options = IdentifyOptions::default();
        options.network.enabled = false;
        options.colony.enabled = false;
        let plant = Some(PlantRequest { actuator_order: order });
        IdentifyRequest { plant, options, ..IdentifyRequest::default() }
    }

    // The plant is converted to reported parameters and back. A few operations round by 1e-15
    // relative, which a response may amplify ten times.
    #[test]
    fn a_comparison_from_a_stored_answer_equals_that_of_the_fit() {
        for actuator in ACTUATORS {
            let measurement = stepped_sine(&axis(actuator), 3);
            let fit = fit_base(&measurement, &request(actuator.order()), &Silent).unwrap();
            let stored = serde_json::to_string(&fit.identification).unwrap();
            let stored: Identification = serde_json::from_str(&stored).unwrap();
            let comparison = compare(&measurement, &stored).unwrap();
            assert!(comparison.std_estimated && comparison.unanswered.is_empty());
            let pairs = comparison.experiments.iter().zip(&fit.comparison.experiments);
            for (a, b) in pairs.flat_map(|(a, b)| a.harmonics.iter().zip(&b.harmonics)) {
                assert_eq!((a.order, a.measured, a.input), (b.order, b.measured, b.input));
                assert!((a.simulated[0] - b.simulated[0]).abs() < 1e-13);
                assert!((a.simulated[1] - b.simulated[1]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn an_answer_without_a_parameter_of_the_model_is_refused_by_its_name() {
        let measurement = stepped_sine(&axis(ACTUATORS[0]), 3);
        let mut answer = fit_base(&measurement, &request(0), &Silent).unwrap().identification;
        answer.parameters.shift_remove("fc_minus");
        assert!(compare(&measurement, &answer).unwrap_err().to_string().contains("fc_minus"));
    }
}
