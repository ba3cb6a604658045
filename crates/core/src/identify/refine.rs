//! Refinement of a misfit's coordinates by Levenberg and Marquardt's method.

use nalgebra::DVector;

use super::levenberg_marquardt::{self, FIRST_DAMPING, LeastSquares, Linearisation};
use super::objective::{Misfit, NoResiduals};

pub(super) use super::levenberg_marquardt::{Patience, Refined};

/// Until a step would lower the cost by less than this share: of a χ² of 700, by less than a
/// ten-thousandth of a standard deviation in any coordinate.
pub(super) const THOROUGH: Patience = Patience {
    steps: 100,
    evaluations: u64::MAX,
    cost_tolerance: 1e-11,
    negligible: 0.0,
    damping: FIRST_DAMPING,
    linear_within: 0.0,
};

/// Coordinates are logarithms and shares of input scales; an evaluation is a simulation of the
/// whole measurement.
impl LeastSquares for Misfit<'_> {
    type Error = NoResiduals;

    fn residuals(&self, point: &[f64]) -> Result<DVector<f64>, NoResiduals> {
        Misfit::residuals(self, point)
    }

    fn linearise(&self, point: &[f64]) -> Result<Linearisation, NoResiduals> {
        Misfit::linearise(self, point)
    }

    fn bounds(&self, coordinate: usize) -> [f64; 2] {
        [self.coordinates.lower[coordinate], self.coordinates.upper[coordinate]]
    }

    fn clamp(&self, point: &mut [f64]) {
        self.coordinates.clamp(point);
    }

    fn cancelled(&self) -> bool {
        self.observer.cancelled()
    }
}

/// Refines a point; `on_step` receives the step number, the evaluations and the cost.
pub(super) fn refine(
    misfit: &Misfit<'_>,
    start: &[f64],
    patience: Patience,
    on_step: &mut dyn FnMut(u64, u64, f64),
) -> Refined {
    levenberg_marquardt::minimise(misfit, start, patience, on_step)
}

/// Which coordinates are held by a bound at a refined point.
pub(super) fn held(misfit: &Misfit<'_>, point: &[f64], here: &Linearisation) -> Vec<bool> {
    levenberg_marquardt::held(misfit, point, here)
}

/// The same from a point whose linearisation is known already.
pub(super) fn refine_from(
    misfit: &Misfit<'_>,
    (point, here): (Vec<f64>, Linearisation),
    patience: Patience,
    on_step: &mut dyn FnMut(u64, u64, f64),
) -> Refined {
    levenberg_marquardt::minimise_from(misfit, point, here, 0, patience, on_step)
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, joined, stepped_sine};
    use super::super::noise;
    use super::super::parameters::Coordinates;
    use super::super::problem::Problem;
    use super::*;
    use crate::answers::IdentifyOptions;
    use crate::measurement::Measurement;
    use crate::observer::{Observer, Silent};
    use crate::plant::{Friction, Plant};

    struct Impatient;

    impl Observer for Impatient {
        fn cancelled(&self) -> bool {
            true
        }
    }

    /// Refines from the middle of the search range.
    fn refined(
        measurement: &Measurement,
        order: u8,
        observer: &dyn Observer,
    ) -> (Refined, Vec<bool>, Plant) {
        let problem = Problem::new(measurement).unwrap();
        let coordinates = Coordinates::new(order, false, &problem.prior);
        let weights = noise::weights(measurement, &problem, &IdentifyOptions::default(), None);
        let misfit = Misfit::new(&problem, &coordinates, &weights, observer);
        let mut start = coordinates.within_search(&vec![0.5; coordinates.len() - 1]);
        misfit.solve_for_constant(&mut start);
        let refined = refine(&misfit, &start, THOROUGH, &mut |_, _, _| ());
        let patient = Misfit::new(&problem, &coordinates, &weights, &Silent);
        let held = held(&patient, &refined.point, &patient.linearise(&refined.point).unwrap());
        let found = problem.in_units(&coordinates.plant(&refined.point));
        (refined, held, found)
    }

    // The data comes from the independent simulator, which errs by 1e-9 of the largest value.
    // Squared and summed over some 200 data this is about 1e-16. A parameter errs by some ten times
    // 1e-9.
    #[test]
    fn refinement_from_the_middle_of_the_range_ends_at_the_truth() {
        for actuator in ACTUATORS {
            let measurement = stepped_sine(&axis(actuator), 5);
            let (refined, held, found) = refined(&measurement, actuator.order(), &Silent);
            assert!(refined.cost < 1e-16, "{refined:?}");
            assert!((found.viscous_rate_rad_s - 10.0).abs() < 1e-6);
            assert!((found.friction.fc_minus - 0.4).abs() < 1e-7);
            assert!(held.iter().all(|held| !held));
        }
    }

    // The mean is lowered until no friction explains it, and the fit asks for a level below 0.
    #[test]
    fn a_level_the_data_wants_below_zero_ends_held_by_its_bound() {
        let plant = Plant { friction: Friction::coulomb(0.5, 0.0), ..axis(ACTUATORS[0]) };
        let mut experiments = stepped_sine(&plant, 5).experiments().to_vec();
        experiments.iter_mut().for_each(|e| e.response[0].value -= 0.01);
        let (_, held, found) = refined(&joined(experiments), 0, &Silent);
        assert_eq!(held, [false, false, false, true]);
        assert_eq!(found.friction.fc_minus, 0.0);
    }

    // The axis has no actuator, and the data cannot distinguish a fast one from none, so its corner
    // goes to the bound. If a limit on that coordinate shortened the whole step, the others would
    // advance slowly. Quadratic convergence from the middle of the range takes some ten steps of
    // two evaluations; 60 leave room.
    #[test]
    fn an_undetermined_coordinate_does_not_slow_the_others() {
        let measurement = stepped_sine(&axis(ACTUATORS[0]), 5);
        let (refined, held, found) = refined(&measurement, 1, &Silent);
        assert_eq!(held, [false, false, false, false, true]);
        assert!((found.viscous_rate_rad_s - 10.0).abs() < 1e-3, "{found:?}");
        assert!(refined.evaluations < 60, "{refined:?}");
    }

    #[test]
    fn a_cancelled_refinement_takes_no_step() {
        let measurement = stepped_sine(&axis(ACTUATORS[0]), 5);
        let (refined, _, _) = refined(&measurement, 0, &Impatient);
        assert_eq!((refined.stop, refined.evaluations), ("cancelled", 1));
    }
}
