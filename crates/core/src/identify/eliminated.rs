//! Numbers that enter the response linearly and are estimated with every model.
//!
//! - The jump at the end of a single period of a position. An axis that nothing holds moves on while it
//!   oscillates (`measurement::travel`). How far, a single period does not tell exactly, and a jump J at
//!   its end adds jJ/(πk) to every harmonic k: an error of J that is as large as the noise of a sample is
//!   many times the noise of a low harmonic.
//! - Samples of the input that were cut off ([`super::estimated_input`]).
//!
//! Both are eliminated by a projection: residuals and derivatives lose their part along these directions
//! (G. H. Golub, V. Pereyra 1973, doi:10.1137/0710036). Each takes a degree of freedom.

use nalgebra::DMatrix;

use crate::measurement::Complex;

use super::direction::{Direction, take_from};
use super::problem::{Prepared, Problem, Target};

/// What the directions of an input that are left in the data may add to the response, rms, as a share of
/// it: a tenth of the noise of a record of 60 dB.
const LEFT_SHARE: f64 = 1e-4;

/// The directions of all that is not known, given the standard deviation of every target.
pub(super) fn directions(problem: &Problem, sigma: &[Vec<f64>]) -> Vec<Direction> {
    let mut first = 0;
    let mut directions = Vec::new();
    for (e, (experiment, sigma)) in problem.experiments.iter().zip(sigma).enumerate() {
        let count: usize = experiment.targets.iter().map(|t| if t.real { 1 } else { 2 }).sum();
        let own = orthogonal(experiment, sigma);
        directions.extend(own.into_iter().map(|rows| Direction {
            experiment: e,
            first,
            rows,
            kept: 0.0,
        }));
        first += count;
    }
    directions
}

/// The same, one column each over so many rows.
pub(super) fn columns(directions: &[Direction], data: usize) -> DMatrix<f64> {
    let mut columns = DMatrix::zeros(data, directions.len());
    for (i, Direction { first, rows, .. }) in directions.iter().enumerate() {
        columns.view_mut((*first, i), (rows.len(), 1)).copy_from_slice(rows);
    }
    columns
}

/// Values of the targets of an experiment row by row, in units of the noise.
pub(super) fn in_rows(experiment: &Prepared, sigma: &[f64], values: &[Complex]) -> Vec<f64> {
    let mut rows = Vec::new();
    for ((target, sigma), value) in experiment.targets.iter().zip(sigma).zip(values) {
        rows.push(value.re / sigma);
        if !target.real {
            rows.push(value.im / sigma);
        }
    }
    rows
}

/// Orthogonal directions that span what is not known of an experiment, but for what hardly changes its
/// response: Gram-Schmidt orthogonalisation, the largest that remains first.
fn orthogonal(experiment: &Prepared, sigma: &[f64]) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = Vec::new();
    if experiment.unknown_jump {
        let of_order = |order: usize| Complex::new(0.0, 1.0 / order.max(1) as f64);
        let jump: Vec<Complex> = experiment.targets.iter().map(|t| of_order(t.order)).collect();
        found.extend(unit(in_rows(experiment, sigma, &jump)));
    }
    let measured: Vec<Complex> = experiment.targets.iter().map(|target| target.value).collect();
    let measured = in_rows(experiment, sigma, &measured);
    let enough = LEFT_SHARE * LEFT_SHARE * square(&measured);
    let columns = experiment.unknown_input.columns.iter();
    let mut left: Vec<Vec<f64>> =
        columns.map(|column| in_rows(experiment, sigma, column)).collect();
    left.iter_mut().for_each(|rows| found.iter().for_each(|own| take_from(rows, own)));
    while found.len() < measured.len() {
        let sizes: Vec<f64> = left.iter().map(|rows| square(rows)).collect();
        let largest = (0..left.len()).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b]));
        let Some(largest) = largest.filter(|_| sizes.iter().sum::<f64>() > enough) else { break };
        let mut rows = left.swap_remove(largest);
        // Once more: rounding leaves a part along the others.
        found.iter().for_each(|own| take_from(&mut rows, own));
        let Some(rows) = unit(rows) else { continue };
        left.iter_mut().for_each(|other| take_from(other, &rows));
        found.push(rows);
    }
    found
}

fn square(rows: &[f64]) -> f64 {
    rows.iter().map(|row| row * row).sum()
}

fn unit(mut rows: Vec<f64>) -> Option<Vec<f64>> {
    let size = square(&rows).sqrt();
    rows.iter_mut().for_each(|row| *row /= size);
    (size > 0.0 && size.is_finite()).then_some(rows)
}

/// What the unknown numbers that fit best add to each predicted target of an experiment, in scale.
pub(super) fn added(
    directions: &[Direction],
    (index, experiment): (usize, &Prepared),
    sigma: &[f64],
    predicted: &[Complex],
) -> Vec<Complex> {
    let lacking =
        experiment.targets.iter().zip(predicted).map(|(t, predicted)| t.value - predicted);
    let lacking = in_rows(experiment, sigma, &lacking.collect::<Vec<_>>());
    let mut left = lacking.clone();
    for own in directions.iter().filter(|own| own.experiment == index) {
        take_from(&mut left, &own.rows);
    }
    let mut added = lacking.iter().zip(&left).map(|(before, after)| before - after);
    let mut next = || added.next().unwrap_or(0.0);
    let of_target = |(target, sigma): (&Target, &f64)| {
        let re = next();
        Complex::new(re, if target.real { 0.0 } else { next() }) * *sigma
    };
    experiment.targets.iter().zip(sigma).map(of_target).collect()
}

#[cfg(test)]
mod tests {
    use super::super::direction::reduce;
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
        let directions = directions(&problems[0], &weights.sigma);
        let rows = problems.each_ref().map(rows);
        let added: Vec<f64> = rows[1].iter().zip(&rows[0]).map(|(a, b)| a - b).collect();
        let mut left = added.clone();
        reduce(&directions, &mut left);
        let [before, after] = problems.each_ref().map(|problem| problem.response_scale);
        let still: Vec<Complex> = problems[0].experiments[0]
            .targets
            .iter()
            .map(|target| target.value * before / after)
            .collect();
        let size = |of: &[f64]| of.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(size(&added) > 0.0 && size(&left) < 5e-3 * size(&added), "{}", size(&left));
        let experiment = (0, &problems[1].experiments[0]);
        let jump = super::added(&directions, experiment, &weights.sigma[0], &still);
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
