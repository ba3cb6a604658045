//! Ends of intervals by the profile of the sum of squares, where its curvature misleads.
//!
//! The profile of a coordinate is the least sum of squares at each of its values, everything
//! else refitted. A 95 % interval ends where it has risen by (t·s)², t the quantile and s the
//! scale of the noise (Venzon and Moolgavkar 1988, doi:10.2307/2347496); were the sum quadratic,
//! that would be t deviations away. It is not where a response is far from linear in a
//! coordinate, as in the logarithm of a gap that hardly shows, or has kinks, as where an impact
//! comes or goes.
//!
//! Ends are moved outwards alone: what any point has risen by is the most that the profile can
//! have there, which proves an interval too short, while that one is too long would rest on
//! refits having found the least.

use nalgebra::DVector;

use super::levenberg_marquardt::Linearisation;
use super::objective::Misfit;
use super::parameters::Coordinates;
use super::refine::{self, Patience};
use super::uncertainty::Uncertainty;

/// Share by which the root of the rise may depart from what the curvature promises: with both
/// ends so much too near an interval holds 92 % in place of 95.
const BELIEVED: f64 = 0.1;

/// The same share within which an end is found.
const FOUND: f64 = 0.03;

/// Refits after which the last value tried is the end.
const MOST_REFITS: usize = 6;

/// Longest step from one value to the next, as a factor of the distance.
const LONGEST: f64 = 3.0;

/// A few steps from a start that is nearly right: to a hundredth of the rise.
const PATIENCE: Patience =
    Patience { steps: 8, evaluations: u64::MAX, cost_tolerance: 3e-5, negligible: 0.0 };

/// Share of the rise that a step to the minimum may still gain: of a point that was not refined
/// the profile says nothing.
const SETTLED: f64 = 0.05;

/// A fitted point, and what counts as the end of an interval.
pub(super) struct Profile<'a> {
    misfit: &'a Misfit<'a>,
    point: &'a [f64],
    cost: f64,
    /// Deviations to an end by the curvature.
    quantile: f64,
    /// (t·s)².
    rise: f64,
}

impl<'a> Profile<'a> {
    /// At a minimum, where the noise has this scale; `None` where the point is none.
    pub fn new(
        misfit: &'a Misfit<'a>,
        point: &'a [f64],
        here: &Linearisation,
        uncertainty: &Uncertainty,
        [quantile, scale]: [f64; 2],
    ) -> Option<Self> {
        let gradient = here.jacobian.tr_mul(&here.residuals);
        let to_gain = gradient.dot(&(&uncertainty.covariance * &gradient)) / scale.powi(2);
        let rise = (quantile * scale).powi(2);
        let cost = here.residuals.norm_squared();
        (to_gain <= SETTLED * rise).then_some(Self { misfit, point, cost, quantile, rise })
    }

    /// How far below and above the point the interval of a coordinate reaches; `None` where no
    /// further than the curvature says, or the data does not determine it.
    pub fn reaches(&self, i: usize, uncertainty: &Uncertainty) -> Option<[f64; 2]> {
        let std = uncertainty.covariance[(i, i)].sqrt();
        if !(std > 0.0 && std.is_finite()) {
            return None;
        }
        let to_end = uncertainty.covariance.column(i) * (self.quantile / std);
        let ends = [-1.0, 1.0].map(|side| self.end(i, &(&to_end * side)));
        let linear = to_end[i];
        let reach = |end: Option<f64>| end.unwrap_or(linear);
        ends.iter().any(Option::is_some).then(|| ends.map(reach))
    }

    /// The distance to an end that lies further than `to_end`, where the curvature puts it.
    fn end(&self, i: usize, to_end: &DVector<f64>) -> Option<f64> {
        let Coordinates { lower, upper, .. } = self.misfit.coordinates;
        let side = to_end[i].signum();
        let room = if side > 0.0 { upper[i] - self.point[i] } else { self.point[i] - lower[i] };
        let mut distance = to_end[i].abs();
        if distance >= room {
            return None;
        }
        let mut last: Vec<f64> = self.point.iter().zip(to_end).map(|(p, s)| p + s).collect();
        self.misfit.coordinates.clamp(&mut last);
        let mut root = self.root(self.misfit.cost(&last));
        if root > 1.0 + BELIEVED {
            // Too high for a straight valley: in a bent one the floor is elsewhere.
            (last, root) = self.refit(i, self.point[i] + to_end[i], &last);
        }
        if root >= 1.0 - BELIEVED {
            return None;
        }
        // Distances and roots of the rise there, before and beyond the end.
        let (mut before, mut beyond) = ((distance, root), None);
        for _ in 0..MOST_REFITS {
            let next = between(before, beyond).min(room);
            let share = next / distance;
            let start: Vec<f64> =
                self.point.iter().zip(&last).map(|(p, l)| p + share * (l - p)).collect();
            distance = next;
            let root;
            (last, root) = self.refit(i, self.point[i] + side * distance, &start);
            let found = (root - 1.0).abs() <= FOUND || (root < 1.0 && distance >= room);
            if found || self.misfit.observer.cancelled() {
                break;
            }
            match root > 1.0 {
                true => beyond = Some((distance, root)),
                false => before = (distance, root),
            }
        }
        Some(distance)
    }

    /// The root of a rise of the cost, in that of an end.
    fn root(&self, cost: f64) -> f64 {
        ((cost - self.cost).max(0.0) / self.rise).sqrt()
    }

    /// The best point with a coordinate held at a value, and the root of the rise there.
    fn refit(&self, i: usize, value: f64, start: &[f64]) -> (Vec<f64>, f64) {
        let mut coordinates = self.misfit.coordinates.clone();
        (coordinates.lower[i], coordinates.upper[i]) = (value, value);
        let misfit = Misfit { coordinates: &coordinates, ..*self.misfit };
        let patience = Patience { negligible: self.rise, ..PATIENCE };
        let refined = refine::refine(&misfit, start, patience, &mut |_, _, _| ());
        (refined.point, self.root(refined.cost))
    }
}

/// The distance to try between one before the end and one beyond it, where there is one: roots
/// of the rise are nearly straight.
fn between((near, low): (f64, f64), beyond: Option<(f64, f64)>) -> f64 {
    match beyond {
        None => near * (1.0 / low).min(LONGEST),
        Some((far, high)) if high.is_finite() => near + (far - near) * (1.0 - low) / (high - low),
        Some((far, _)) => 0.5 * (near + far),
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, stepped_sine};
    use super::super::noise;
    use super::super::parameters::CONSTANT;
    use super::super::problem::Problem;
    use super::*;
    use crate::answers::IdentifyOptions;
    use crate::observer::Silent;

    /// What is said of K where one deviation is `share` of it, and everything else is known or
    /// not.
    fn reaches_of_constant(order: u8, known: bool, share: f64) -> Option<[f64; 2]> {
        let axis = axis(ACTUATORS[usize::from(order)]);
        let measurement = stepped_sine(&axis, 5);
        let problem = Problem::new(&measurement).unwrap();
        let mut coordinates = Coordinates::new(order, false, &problem.prior);
        let point = coordinates.point(&problem.in_scale(&axis));
        let held: Vec<bool> = (0..point.len()).map(|i| known && i != CONSTANT).collect();
        for i in (0..point.len()).filter(|i| held[*i]) {
            (coordinates.lower[i], coordinates.upper[i]) = (point[i], point[i]);
        }
        let weights = noise::weights(&measurement, &problem, &IdentifyOptions::default(), None);
        let misfit = Misfit::new(&problem, &coordinates, &weights, &Silent);
        let here = misfit.linearise(&point).unwrap();
        let unit = Uncertainty::new(&here, &held, 1.0).covariance[(CONSTANT, CONSTANT)];
        let scale = share / unit.sqrt();
        let uncertainty = Uncertainty::new(&here, &held, scale);
        let profile = Profile::new(&misfit, &point, &here, &uncertainty, [2.0, scale]).unwrap();
        profile.reaches(CONSTANT, &uncertainty)
    }

    // The response is proportional to K, so that K's own interval is 1 ± 2 deviations of a
    // quarter; above, the curvature's end 0.5 lies beyond ln 1.5. An end is found to 3 %.
    #[test]
    fn an_end_that_the_curvature_puts_too_near_is_where_the_sum_has_risen() {
        let [below, above] = reaches_of_constant(0, true, 0.25).unwrap();
        assert!((below / 2.0_f64.ln() - 1.0).abs() < 0.05, "{below}");
        assert!((above - 0.5).abs() < 1e-9, "{above}");
    }

    // On the straight path to 0.4, where the curvature puts the end, the sum rises by 1.3 times
    // what it should; refitted there, by a third of it.
    #[test]
    fn in_a_bent_valley_an_end_is_sought_along_the_floor() {
        let [_, above] = reaches_of_constant(1, false, 0.2).unwrap();
        assert!(above > 0.8, "{above}");
    }

    // At two deviations of 0.03 the root falls short by 3 %.
    #[test]
    fn the_curvature_is_believed_where_the_response_is_nearly_linear() {
        assert_eq!(reaches_of_constant(0, true, 0.03), None);
    }

    // Without any response the sum has risen by one deviation of 1, of two that are asked for.
    // K has room down to 1e-6 of the problem's scales.
    #[test]
    fn where_the_sum_never_rises_enough_the_interval_ends_at_the_bound() {
        let [below, _] = reaches_of_constant(0, true, 1.0).unwrap();
        assert!((13.0..15.0).contains(&below), "{below}");
    }

    #[test]
    fn between_two_distances_the_root_is_taken_as_straight() {
        assert_eq!(between((1.0, 0.5), None), 2.0);
        assert_eq!(between((1.0, 0.0), None), 3.0);
        assert_eq!(between((1.0, 0.5), Some((2.0, 1.5))), 1.5);
        assert_eq!(between((1.0, 0.5), Some((2.0, f64::INFINITY))), 1.5);
    }
}
