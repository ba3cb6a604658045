//! Profile likelihood intervals, where the curvature at the fitted point misleads.
//!
//! The profile of a coordinate is the least sum of squares at each of its values, with everything
//! else refitted. A 95 % interval ends where the profile has risen by (t·s)², with t the quantile
//! and s the scale of the noise (Venzon and Moolgavkar 1988, doi:10.2307/2347496). If the sum of
//! squares were quadratic, that would be t standard deviations away. It is elsewhere if the
//! response is far from linear in a coordinate (the logarithm of a gap that hardly shows) or has
//! kinks (where an impact appears or vanishes).
//!
//! Ends are only moved outwards. The sum of squares at any point is an upper bound of the profile
//! there, so a low sum proves that an interval is too short. To prove it too long, every refit
//! would have to find the true minimum.

use nalgebra::DVector;

use super::corrected::Corrected;
use super::levenberg_marquardt::{self, LeastSquares, Linearisation};
use super::objective::Misfit;
use super::parameters::Coordinates;
use super::refine::{self, Patience};
use super::search_settings::SearchSettings;
use super::uncertainty::Uncertainty;

/// The curvature's end is kept if the root of the rise (see `Profile::root`) there lies within this
/// of 1. If both ends are too near by this share, an interval covers 92 % instead of 95 %.
const CURVATURE_TOLERANCE: f64 = 0.1;

/// A refitted end is accepted if the root of the rise there lies within this of 1.
const END_TOLERANCE: f64 = 0.03;

/// Profiles are computed only if a Gauss–Newton step from the fitted point would lower the cost by
/// at most this share of the rise: a profile needs a point that is a minimum.
const LARGEST_GAIN_LEFT: f64 = 0.05;

/// The profile of the sum of squares about a fitted point.
pub(super) struct Profile<'a> {
    objective: Corrected<'a>,
    /// The misfit that `objective` stands for, if it is on a coarse problem.
    fine: Option<Misfit<'a>>,
    point: &'a [f64],
    cost: f64,
    /// t: standard deviations from the point to an end, by the curvature.
    quantile: f64,
    /// (t·s)²: the rise of the sum of squares at an end.
    rise: f64,
    search: &'a SearchSettings,
}

impl<'a> Profile<'a> {
    /// The profile of a misfit about a minimum, with the quantile t and the scale s of the noise; `None` if
    /// the point is not a minimum. With a coarse misfit and its correction there, that is profiled, and
    /// ends are verified by the other.
    pub fn new(
        (misfit, coarse): (&Misfit<'a>, Option<Corrected<'a>>),
        (point, here): (&'a [f64], &Linearisation),
        uncertainty: &Uncertainty,
        [quantile, scale]: [f64; 2],
        search: &'a SearchSettings,
    ) -> Option<Self> {
        let gradient = here.jacobian.tr_mul(&here.residuals);
        let predicted_gain = gradient.dot(&(&uncertainty.covariance * &gradient)) / scale.powi(2);
        let rise = (quantile * scale).powi(2);
        let cost = here.residuals.norm_squared();
        let fine = coarse.map(|_| *misfit);
        let objective = coarse.unwrap_or(Corrected { misfit: *misfit, correction: None });
        let this = Self { objective, fine, point, cost, quantile, rise, search };
        (predicted_gain <= LARGEST_GAIN_LEFT * rise).then_some(this)
    }

    /// How far below and above the point the interval of a coordinate reaches. `None` if the
    /// curvature's interval is long enough, or if the data does not determine the coordinate.
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

    /// The distance to the end of an interval, if it lies further out than `to_end`, the step to
    /// the curvature's end; else `None`.
    fn end(&self, i: usize, to_end: &DVector<f64>) -> Option<f64> {
        let Coordinates { lower, upper, .. } = self.objective.misfit.coordinates;
        let side = to_end[i].signum();
        let room = if side > 0.0 { upper[i] - self.point[i] } else { self.point[i] - lower[i] };
        let mut distance = to_end[i].abs();
        if distance >= room {
            return None;
        }
        let mut last: Vec<f64> = self.point.iter().zip(to_end).map(|(p, s)| p + s).collect();
        self.objective.clamp(&mut last);
        let mut root = self.root(self.objective.cost(&last));
        if root > 1.0 + CURVATURE_TOLERANCE {
            // The cost rises faster than the quadratic predicts along the straight line. In a
            // curved valley the minimum at this value lies off the line, so refit.
            (last, root) = self.refit(i, self.point[i] + to_end[i], &last);
        }
        if root >= 1.0 - CURVATURE_TOLERANCE {
            return None;
        }
        // (distance, root of the rise) of the last trial before the end, and of the last one beyond
        // it.
        let (mut before, mut beyond) = ((distance, root), None);
        for _ in 0..self.search.interval_refits {
            let most = self.search.interval_extrapolation;
            let next = next_distance(before, beyond, most).min(room);
            let share = next / distance;
            let start: Vec<f64> =
                self.point.iter().zip(&last).map(|(p, l)| p + share * (l - p)).collect();
            distance = next;
            let root;
            (last, root) = self.refit(i, self.point[i] + side * distance, &start);
            let found = (root - 1.0).abs() <= END_TOLERANCE || (root < 1.0 && distance >= room);
            if found || self.objective.cancelled() {
                if !self.is_verified(&last, root) {
                    return self.on_fine_problem().end(i, to_end);
                }
                break;
            }
            match root > 1.0 {
                true => beyond = Some((distance, root)),
                false => before = (distance, root),
            }
        }
        Some(distance)
    }

    /// Whether the root of the rise at a point is that of the misfit that is profiled on a coarse problem.
    fn is_verified(&self, point: &[f64], root: f64) -> bool {
        let fine = self.fine.map(|misfit| self.root(misfit.cost(point)));
        fine.is_none_or(|fine| (fine - root).abs() <= CURVATURE_TOLERANCE)
    }

    /// The same profile, of the misfit itself.
    fn on_fine_problem(&self) -> Self {
        let misfit = self.fine.unwrap_or(self.objective.misfit);
        Self { objective: Corrected { misfit, correction: None }, fine: None, ..*self }
    }

    /// The root of the rise: √((cost − cost at the minimum)/rise), which is 1 at the end of an
    /// interval.
    fn root(&self, cost: f64) -> f64 {
        ((cost - self.cost).max(0.0) / self.rise).sqrt()
    }

    /// Refits all coordinates but `i`, which is held at `value`; returns the point and the root of
    /// the rise there.
    fn refit(&self, i: usize, value: f64, start: &[f64]) -> (Vec<f64>, f64) {
        let Corrected { misfit, correction } = self.objective;
        let mut coordinates = misfit.coordinates.clone();
        (coordinates.lower[i], coordinates.upper[i]) = (value, value);
        let motions = misfit.new_motions();
        let misfit = Misfit { coordinates: &coordinates, motions: motions.as_deref(), ..misfit };
        let patience = Patience {
            cost_tolerance: self.search.settle_tolerance,
            negligible: self.rise,
            ..refine::THOROUGH
        };
        let objective = Corrected { misfit, correction };
        let none = &mut |_, _, _| ();
        let refined = levenberg_marquardt::minimise(&objective, start, patience, none);
        (refined.point, self.root(refined.cost))
    }
}

/// The distance to try next, given (distance, root of the rise) before the end and, once there is
/// one, beyond it. Interpolates linearly: the root is nearly proportional to the distance. Until
/// there is one beyond, the next distance is at most `most` times the one before.
fn next_distance((near, low): (f64, f64), beyond: Option<(f64, f64)>, most: f64) -> f64 {
    match beyond {
        None => near * (1.0 / low).min(most),
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

    /// The reaches of K with a noise scale that makes one standard deviation of ln K equal to
    /// `share`. If `known`, all other coordinates are held.
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
        let search = SearchSettings::default();
        let profile =
            Profile::new((&misfit, None), (&point, &here), &uncertainty, [2.0, scale], &search)
                .unwrap();
        profile.reaches(CONSTANT, &uncertainty)
    }

    // The response is proportional to K, so at two standard deviations of a quarter the interval of
    // K itself is 1 ± 0.5. In ln K its lower end is ln 2 away. Above, the curvature's end 0.5 lies
    // beyond the true one, ln 1.5, and stays. An end is found to 3 %.
    #[test]
    fn an_end_that_the_curvature_puts_too_near_is_moved_to_where_the_profile_has_risen() {
        let [below, above] = reaches_of_constant(0, true, 0.25).unwrap();
        assert!((below / 2.0_f64.ln() - 1.0).abs() < 0.05, "{below}");
        assert!((above - 0.5).abs() < 1e-9, "{above}");
    }

    // On the straight line, at the curvature's end 0.4, the sum rises by 1.3 times the rise of an
    // end. Refitted at that value, it rises by a third of it.
    #[test]
    fn in_a_curved_valley_the_end_is_sought_along_the_refitted_minima() {
        let [_, above] = reaches_of_constant(1, false, 0.2).unwrap();
        assert!(above > 0.8, "{above}");
    }

    // At two standard deviations of 0.03 the root of the rise is 3 % too small.
    #[test]
    fn where_the_response_is_nearly_linear_the_end_of_the_curvature_is_kept() {
        assert_eq!(reaches_of_constant(0, true, 0.03), None);
    }

    // Even without any response the sum rises by only one of the two standard deviations asked for.
    // The lower bound of K is 1e-6 in the problem's units.
    #[test]
    fn where_the_sum_never_rises_far_enough_the_interval_ends_at_the_bound() {
        let [below, _] = reaches_of_constant(0, true, 1.0).unwrap();
        assert!((13.0..15.0).contains(&below), "{below}");
    }

    #[test]
    fn the_next_distance_is_interpolated_linearly_in_the_root() {
        assert_eq!(next_distance((1.0, 0.5), None, 3.0), 2.0);
        assert_eq!(next_distance((1.0, 0.0), None, 3.0), 3.0);
        assert_eq!(next_distance((1.0, 0.5), Some((2.0, 1.5)), 3.0), 1.5);
        assert_eq!(next_distance((1.0, 0.5), Some((2.0, f64::INFINITY)), 3.0), 1.5);
    }
}
