//! Standard deviations and correlations from the Jacobian, and which parameters the data does not
//! determine.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use crate::effects;
use crate::singular_values::SingularValues;

use super::levenberg_marquardt::Linearisation;
use super::parameters::{Coordinate, Coordinates};

/// A direction is undetermined if its singular value is below this share of the largest one: its
/// effect on the response is lost in rounding.
const RANK_TOLERANCE: f64 = 1e-9;

/// A logarithm with a standard deviation above this counts as not identified: its 95 % interval
/// would span more than a factor of 50.
pub(super) const LARGEST_LOG_STD: f64 = 1.0;

/// Covariance of the coordinates, and which of them the data determines.
#[derive(Debug, Clone)]
pub(super) struct Uncertainty {
    /// Covariance; 0 in rows and columns of coordinates that are held. Undetermined directions are
    /// left out of it.
    pub covariance: DMatrix<f64>,
    /// Orthonormal directions that the data does not determine, as columns.
    undetermined: DMatrix<f64>,
}

impl Uncertainty {
    /// From the linearisation at the refined point, by [`with_prior`] where coordinates have a
    /// prior. Coordinates that are `held` at a bound are
    /// treated as known. Standard deviations are multiplied by `scale`; where it is infinite,
    /// because nothing tells the size of the noise, no direction counts as determined.
    pub fn new(here: &Linearisation, held: &[bool], scale: f64) -> Self {
        let all = held.len();
        let free: Vec<usize> = (0..all).filter(|i| !held[*i]).collect();
        let mut covariance = DMatrix::zeros(all, all);
        let mut undetermined = Vec::new();
        let slim = here.jacobian.select_columns(&free);
        let finite = slim.iter().all(|value| value.is_finite());
        if !free.is_empty() && finite {
            // With fewer data than parameters there are directions that no datum depends on; their
            // singular values are 0.
            let svd = SingularValues::of(slim);
            let determined = if scale.is_infinite() { 0 } else { svd.rank(RANK_TOLERANCE) };
            for (s, singular) in svd.values.iter().enumerate() {
                let along = svd.right.column(s);
                if s >= determined {
                    let mut direction = vec![0.0; all];
                    for (f, i) in free.iter().enumerate() {
                        direction[*i] = along[f];
                    }
                    undetermined.push(direction);
                    continue;
                }
                let variance = (scale / singular).powi(2);
                for (f, i) in free.iter().enumerate() {
                    for (g, j) in free.iter().enumerate() {
                        covariance[(*i, *j)] += variance * along[f] * along[g];
                    }
                }
            }
        }
        let undetermined = DMatrix::from_fn(all, undetermined.len(), |i, d| undetermined[d][i]);
        Self { covariance, undetermined }
    }

    /// Standard deviation of a linear combination of coordinates; `None` where the data does not
    /// determine it, or where it exceeds `largest`.
    pub fn std(&self, combination: &[f64], largest: f64) -> Option<f64> {
        let row = nalgebra::RowDVector::from_row_slice(combination);
        let size = row.norm();
        let lost = (&row * &self.undetermined).norm() > 1e-3 * size;
        let std = (&row * &self.covariance * row.transpose())[(0, 0)].max(0.0).sqrt();
        (!lost && std.is_finite() && std <= largest).then_some(std)
    }

    /// Correlation matrix of the coordinates in `which`.
    pub fn correlations(&self, which: &[usize]) -> Vec<Vec<f64>> {
        let c = &self.covariance;
        let of = |i: usize, j: usize| match c[(i, i)] * c[(j, j)] {
            product if i == j || product <= 0.0 => f64::from(u8::from(i == j)),
            product => (c[(i, j)] / product.sqrt()).clamp(-1.0, 1.0),
        };
        which.iter().map(|i| which.iter().map(|j| of(*i, *j)).collect()).collect()
    }
}

/// Largest standard deviation with which a coordinate still counts as identified. For a level it is
/// that of a uniform distribution over the range between the bounds, for an angle over a full turn.
/// For a logarithm it is [`LARGEST_LOG_STD`]: its range covers everything that could show,
/// which is far more than is useful.
pub(super) fn largest_std(coordinates: &Coordinates, i: usize) -> f64 {
    let of_uniform = |width: f64| width / 12.0_f64.sqrt();
    let scale = match coordinates.list[i] {
        Coordinate::FcPlus | Coordinate::FcMinus | Coordinate::FcMean | Coordinate::FcSplit => {
            effects::Coordinate::Linear
        }
        Coordinate::OfEffect { effect, parameter } => {
            coordinates.effects[effect].parameters()[parameter].coordinate
        }
        _ => effects::Coordinate::Logarithmic,
    };
    match scale {
        effects::Coordinate::Linear => of_uniform(coordinates.upper[i] - coordinates.lower[i]),
        effects::Coordinate::Angle => of_uniform(TAU),
        effects::Coordinate::Logarithmic => LARGEST_LOG_STD,
    }
}

/// The linearisation with one row more for a coordinate that has a prior, so that a direction which
/// the data do not determine is as uncertain as the prior says, and not more. `scale` is that of
/// the noise in the residuals.
pub(super) fn with_prior(
    here: &Linearisation,
    coordinates: &Coordinates,
    scale: f64,
) -> Linearisation {
    let mut with = here.clone();
    let split = coordinates.list.iter().position(|c| *c == Coordinate::FcSplit);
    if let Some(i) = split.filter(|_| scale.is_finite()) {
        let rows = with.residuals.len();
        with.residuals = with.residuals.push(0.0);
        with.jacobian = with.jacobian.insert_row(rows, 0.0);
        with.jacobian[(rows, i)] = scale / largest_std(coordinates, i);
    }
    with
}

/// The linear combination that is coordinate `i` alone.
pub(super) fn unit(coordinates: &Coordinates, i: usize) -> Vec<f64> {
    (0..coordinates.len()).map(|j| f64::from(u8::from(i == j))).collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::super::fixtures::{ACTUATORS, axis, stepped_sine};
    use super::super::problem::Problem;
    use super::*;

    fn here(rows: usize, columns: usize, jacobian: &[f64]) -> Linearisation {
        Linearisation {
            residuals: DVector::zeros(rows),
            jacobian: DMatrix::from_row_slice(rows, columns, jacobian),
        }
    }

    // For J = [[2, 1], [0, 1], [2, 0]], (JᵀJ)⁻¹ is [[2, −2], [−2, 8]]/12.
    #[test]
    fn deviations_and_correlations_are_those_of_the_normal_equations() {
        let here = here(3, 2, &[20.0, 10.0, 0.0, 10.0, 20.0, 0.0]);
        let uncertainty = Uncertainty::new(&here, &[false, false], 2.0);
        let close = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found}");
        close(uncertainty.std(&[1.0, 0.0], 1.0).unwrap(), 0.2 * (2.0_f64 / 12.0).sqrt());
        close(uncertainty.std(&[0.0, 1.0], 1.0).unwrap(), 0.2 * (8.0_f64 / 12.0).sqrt());
        close(uncertainty.std(&[1.0, 1.0], 1.0).unwrap(), 0.2 * (6.0_f64 / 12.0).sqrt());
        close(uncertainty.correlations(&[0, 1])[0][1], -0.5);
    }

    #[test]
    fn a_held_coordinate_is_treated_as_known() {
        let here = here(3, 2, &[20.0, 10.0, 0.0, 10.0, 20.0, 0.0]);
        let uncertainty = Uncertainty::new(&here, &[false, true], 1.0);
        assert!((uncertainty.std(&[1.0, 0.0], 1.0).unwrap() - 800.0_f64.powf(-0.5)).abs() < 1e-12);
        assert_eq!(uncertainty.std(&[0.0, 1.0], 1.0), Some(0.0));
    }

    #[test]
    fn a_direction_that_the_data_does_not_determine_has_no_standard_deviation() {
        // Only the sum of the first two matters, and the third.
        let here = here(3, 3, &[5.0, 5.0, 0.0, 0.0, 0.0, 5.0, 5.0, 5.0, 1.0]);
        let uncertainty = Uncertainty::new(&here, &[false; 3], 1.0);
        assert_eq!(uncertainty.std(&[1.0, 0.0, 0.0], 1.0), None);
        assert_eq!(uncertainty.std(&[1.0, -1.0, 0.0], 1.0), None);
        assert!(uncertainty.std(&[1.0, 1.0, 0.0], 1.0).is_some());
        assert!(uncertainty.std(&[0.0, 0.0, 1.0], 1.0).is_some());
    }

    #[test]
    fn fewer_data_than_parameters_determine_none_of_those_that_they_mix() {
        let uncertainty = Uncertainty::new(&here(1, 2, &[3.0, 4.0]), &[false; 2], 1.0);
        assert_eq!(uncertainty.std(&[1.0, 0.0], 1e3), None);
        assert!((uncertainty.std(&[3.0, 4.0], 1e3).unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn noise_of_unknown_size_leaves_nothing_determined() {
        let here = here(2, 2, &[20.0, 10.0, 0.0, 10.0]);
        let uncertainty = Uncertainty::new(&here, &[false; 2], f64::INFINITY);
        assert_eq!(uncertainty.std(&[1.0, 0.0], f64::INFINITY), None);
    }

    // A friction level lies between 0 and 1.05 times the largest input, the amplitude of cogging
    // between −1 and 1 times it, a phase anywhere on a turn.
    #[test]
    fn a_level_or_a_phase_is_identified_where_it_is_known_better_than_from_its_range_alone() {
        let measurement = stepped_sine(&axis(ACTUATORS[0]), 3);
        let problem = Problem::new(&measurement).unwrap();
        let base = Coordinates::new(0, false, &problem.prior);
        let scope = problem.scope(&problem.in_scale(&axis(ACTUATORS[0])));
        let coordinates = base.with_effect(effects::find("cogging").unwrap(), &scope);
        let largest: Vec<f64> =
            (0..coordinates.len()).map(|i| largest_std(&coordinates, i)).collect();
        let level = 1.05 * problem.prior.largest_level / 12.0_f64.sqrt();
        let [amplitude, phase] = [2.0, TAU].map(|width| width / 12.0_f64.sqrt());
        assert_eq!(largest, [1.0, 1.0, level, level, amplitude, 1.0, phase]);
    }

    // 1/0.9 = 1.11.
    #[test]
    fn what_is_known_no_better_than_to_the_largest_deviation_is_not_identified() {
        let uncertainty = Uncertainty::new(&here(1, 1, &[0.9]), &[false], 1.0);
        assert_eq!(uncertainty.std(&[1.0], LARGEST_LOG_STD), None);
        assert!(uncertainty.std(&[1.0], 1.2).is_some());
    }
}
