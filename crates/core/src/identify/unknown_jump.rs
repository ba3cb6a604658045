//! The jump at the end of a single period of a position.
//!
//! An axis that nothing holds moves on while it oscillates (`measurement::travel`). How far, a single
//! period does not tell exactly, and a jump J at its end adds jJ/(πk) to every harmonic k: an error of
//! J that is as large as the noise of a sample is many times the noise of a low harmonic. So J is
//! estimated with every model. It enters linearly, and is eliminated by a projection: residuals and
//! derivatives lose their part along its direction (G. H. Golub, V. Pereyra 1973,
//! doi:10.1137/0710036).

use nalgebra::DMatrix;

use crate::measurement::Complex;

use super::noise::Weights;
use super::problem::{Prepared, Problem};

/// The direction of the jump of one experiment, as a unit vector in units of the noise.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Direction {
    /// The first row of the experiment.
    first: usize,
    /// One component for each of its rows.
    rows: Vec<f64>,
}

/// The directions of all jumps that are not known, for these weights.
pub(super) fn directions(problem: &Problem, weights: &Weights) -> Vec<Direction> {
    let mut first = 0;
    let mut directions = Vec::new();
    for (experiment, sigma) in problem.experiments.iter().zip(&weights.sigma) {
        let count: usize = experiment.targets.iter().map(|t| if t.real { 1 } else { 2 }).sum();
        if experiment.unknown_jump
            && let Some(rows) = unit(experiment, sigma)
        {
            directions.push(Direction { first, rows });
        }
        first += count;
    }
    directions
}

/// The same, one column each over all rows.
pub(super) fn columns(problem: &Problem, weights: &Weights) -> DMatrix<f64> {
    let directions = directions(problem, weights);
    let mut columns = DMatrix::zeros(problem.data(), directions.len());
    for (i, Direction { first, rows }) in directions.iter().enumerate() {
        columns.view_mut((*first, i), (rows.len(), 1)).copy_from_slice(rows);
    }
    columns
}

fn unit(experiment: &Prepared, sigma: &[f64]) -> Option<Vec<f64>> {
    let mut rows = Vec::new();
    for (target, sigma) in experiment.targets.iter().zip(sigma) {
        rows.push(0.0);
        if !target.real {
            rows.push(1.0 / (target.order as f64 * sigma));
        }
    }
    let size = rows.iter().map(|row| row * row).sum::<f64>().sqrt();
    rows.iter_mut().for_each(|row| *row /= size);
    (size > 0.0 && size.is_finite()).then_some(rows)
}

/// Takes from a vector over all rows what lies along these directions.
pub(super) fn eliminate(directions: &[Direction], vector: &mut [f64]) {
    for Direction { first, rows } in directions {
        let own = &mut vector[*first..first + rows.len()];
        let along: f64 = own.iter().zip(rows).map(|(value, row)| value * row).sum();
        own.iter_mut().zip(rows).for_each(|(value, row)| *value -= along * row);
    }
}

/// What the jump that fits best adds to each predicted target of an experiment, in scale: nothing where
/// it is known.
pub(super) fn added(experiment: &Prepared, sigma: &[f64], predicted: &[Complex]) -> Vec<Complex> {
    let of_order = |order: usize| 1.0 / order.max(1) as f64;
    let (mut along, mut size) = (0.0, 0.0);
    for ((target, sigma), predicted) in experiment.targets.iter().zip(sigma).zip(predicted) {
        if experiment.unknown_jump && !target.real {
            let row = of_order(target.order) / sigma;
            along += row * (target.value - predicted).im / sigma;
            size += row * row;
        }
    }
    let jump = if size > 0.0 { along / size } else { 0.0 };
    let added = |real: bool, order: usize| if real { 0.0 } else { jump * of_order(order) };
    experiment.targets.iter().map(|t| Complex::new(0.0, added(t.real, t.order))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::model_fit::fit_base;
    use super::super::noise::weights;
    use super::super::request::IdentifyRequest;
    use super::*;
    use crate::answers::{IdentifyOptions, PlantRequest};
    use crate::machines::records::{PeriodicMotion, RecordNoise, Sampling, multisine};
    use crate::measurement::{Experiment, Measurement, Metadata, ResponseKind};
    use crate::observer::Silent;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    const SAMPLES: usize = 4096;

    /// So many periods of a position of 40 lines.
    fn recorded(periods: usize) -> Experiment {
        let rng = &mut ChaCha8Rng::seed_from_u64(1);
        let (omega_rad_s, input) = (2.0, multisine(40, 2.0, rng));
        let velocity = |k: usize| 3.0 / Complex::new(1.0, 0.2 * k as f64);
        let response = input.iter().enumerate().map(|(k, line)| velocity(k) * line).collect();
        let motion = PeriodicMotion { omega_rad_s, input, response, mean_velocity: 0.0 };
        let noise = RecordNoise { input: 0.0, response: 1e-9, step: 0.0 };
        let sampling = Sampling { samples: SAMPLES, periods };
        let motion = motion.converted_to_position();
        motion.recorded(ResponseKind::Position, &noise, sampling, 0.0, rng).unwrap()
    }

    fn measurement(experiment: Experiment) -> Measurement {
        let metadata = Metadata { response_kind: ResponseKind::Position, ..Metadata::default() };
        Measurement::new(metadata, vec![experiment], Vec::new(), String::new()).unwrap()
    }

    /// The measured values row by row, response units.
    fn rows(problem: &Problem) -> Vec<f64> {
        let targets = problem.experiments.iter().flat_map(|e| &e.targets);
        let parts = targets
            .flat_map(|t| if t.real { vec![t.value.re] } else { vec![t.value.re, t.value.im] });
        parts.map(|part| part * problem.response_scale).collect()
    }

    // The harmonics of a ramp of N samples from 0 to 1 are −1/N + j·cot(πk/N)/N. Of 4096, the first
    // part and the difference from 1/(πk) are some 1e-3 of the whole.
    #[test]
    fn what_a_jump_adds_to_the_lines_of_a_single_period_is_eliminated() {
        let still = recorded(1);
        let mut moving = still.clone();
        for harmonic in &mut moving.response {
            let x = std::f64::consts::PI * harmonic.order as f64 / SAMPLES as f64;
            harmonic.value += 1e-4 * Complex::new(-1.0, 1.0 / x.tan()) / SAMPLES as f64;
        }
        let [still, moving] = [still, moving].map(measurement);
        let problems = [&still, &moving].map(|measurement| Problem::new(measurement).unwrap());
        let weights = weights(&still, &problems[0], &IdentifyOptions::default(), None);
        let directions = directions(&problems[0], &weights);
        let rows = problems.each_ref().map(rows);
        let added: Vec<f64> = rows[1].iter().zip(&rows[0]).map(|(a, b)| a - b).collect();
        let mut left = added.clone();
        eliminate(&directions, &mut left);
        let [before, after] = problems.each_ref().map(|problem| problem.response_scale);
        let still: Vec<Complex> = problems[0].experiments[0]
            .targets
            .iter()
            .map(|target| target.value * before / after)
            .collect();
        let size = |of: &[f64]| of.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(size(&added) > 0.0 && size(&left) < 5e-3 * size(&added), "{}", size(&left));
        let jump = super::added(&problems[1].experiments[0], &weights.sigma[0], &still);
        let expected = 1e-4 / std::f64::consts::PI / after;
        assert!((jump[1].im - expected).abs() < 5e-3 * expected, "{} {expected}", jump[1].im);
    }

    #[test]
    fn a_jump_that_is_estimated_takes_a_degree_of_freedom() {
        let plant = Some(PlantRequest { actuator_order: 0 });
        let request = IdentifyRequest { plant, ..IdentifyRequest::default() };
        for (periods, jumps) in [(1, 1), (4, 0)] {
            let fit = fit_base(&measurement(recorded(periods)), &request, &Silent).unwrap();
            let estimated = fit.residuals.len() as i64 - fit.identification.fit.dof;
            assert_eq!(
                (fit.eliminated.ncols(), estimated),
                (jumps, (fit.jacobian.ncols() + jumps) as i64)
            );
            // Rounding of a sum of 80 products.
            assert!(fit.eliminated.tr_mul(&fit.residuals).amax() < 1e-9 * fit.residuals.norm());
        }
    }

    #[test]
    fn several_periods_tell_how_far_a_position_moves_on() {
        let problem = Problem::new(&measurement(recorded(4))).unwrap();
        assert!(!problem.experiments[0].unknown_jump);
    }
}
