//! Weights from the scatter of repeats or periods about their mean.

use rayon::prelude::*;

use super::measured_input::OfInput;
use super::weights::Weights;
use crate::answers::NoiseSource;
use crate::identify::problem::{Prepared, Problem, Target};
use crate::identify::variance_shrinkage::{Cell, law_of, weighting_variances};
use crate::measurement::{Complex, Experiment, Repeat};
use crate::plant::Plant;
use crate::simulate;

/// Relative deviation that rounding of the mean leaves between repeats that are copies of each
/// other.
const COPY_ROUNDING: f64 = 1e-13;

/// Whether repeats differ by more than rounding. Copies say nothing about the noise.
pub(super) fn scatters(experiments: &[Experiment]) -> bool {
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
pub(super) fn from_scatter(
    experiments: &[Experiment],
    problem: &Problem,
    model: Option<&Plant>,
) -> Weights {
    let from_record = experiments.iter().any(|e| e.from_record);
    let input_scatters = experiments
        .iter()
        .any(|e| e.repeats.iter().any(|r| r.input.iter().any(|u| u.norm() > 0.0)));
    let of_experiments: Vec<(Vec<Cell>, Option<OfInput>)> = experiments
        .par_iter()
        .zip(&problem.experiments)
        .enumerate()
        .map(|(index, (experiment, prepared))| {
            cells(index, experiment, prepared, problem, model.filter(|_| input_scatters))
        })
        .collect();
    let (rows, of_input): (Vec<Vec<Cell>>, Vec<Option<OfInput>>) =
        of_experiments.into_iter().unzip();
    let scale_dof = rows.iter().flatten().map(|cell| cell.dof).sum();
    let scatter_law = law_of(&rows);
    let moderated = weighting_variances(&rows, scatter_law);
    let each = of_input.iter().zip(&problem.experiments).zip(&moderated);
    let correlations = each
        .map(|((of_input, prepared), whole)| Some(of_input.as_ref()?.correlation(prepared, whole)))
        .collect();
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
        eliminated: Vec::new(),
        correlations,
        noisier: Vec::new(),
    }
}

/// The variance of a single repeat, for every target of an experiment, and what noise of the input adds
/// to it.
fn cells(
    index: usize,
    experiment: &Experiment,
    prepared: &Prepared,
    problem: &Problem,
    model: Option<&Plant>,
) -> (Vec<Cell>, Option<OfInput>) {
    let repeats = experiment.repeats.len();
    let explained = explained_by_input(experiment, prepared, problem, model);
    let response_offset = |order: usize| experiment.response.iter().position(|h| h.order == order);
    let own = |target: &Target| {
        if target.constraint { None } else { response_offset(target.order) }
    };
    let places: Vec<Option<usize>> = prepared.targets.iter().map(own).collect();
    let of_repeat = |repeat: &Repeat| -> Vec<Complex> {
        let value = |place: &Option<usize>| {
            place.map_or(Complex::ZERO, |i| repeat.response[i] / problem.response_scale)
        };
        places.iter().map(value).collect()
    };
    let measured: Vec<Vec<Complex>> = experiment.repeats.iter().map(of_repeat).collect();
    let of_input = model.filter(|_| experiment.from_record).and_then(|plant| {
        OfInput::of(experiment, (prepared, problem), plant, [&measured, &explained])
    });
    let cells = prepared
        .targets
        .iter()
        .enumerate()
        .map(|(t, target)| {
            let sum: f64 = (0..repeats)
                .map(|p| {
                    let left = measured[p][t] - explained[p][t];
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
                by_input: of_input.as_ref().map_or(0.0, |of_input| of_input.variances[t]),
                dof,
            }
        })
        .collect();
    (cells, of_input)
}

/// The part of each target's deviation that the deviation of the input causes, by repeat.
pub(super) fn explained_by_input(
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
            let of = |t: &Target| {
                if t.constraint { at(0) * strongest } else { ratio(t.order, t.value) * at(t.order) }
            };
            prepared.targets.iter().map(of).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {

    use super::*;
    use crate::answers::IdentifyOptions;
    use crate::identify::fixtures::{ACTUATORS, axis, joined, multisine};
    use crate::identify::noise::weights;
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
