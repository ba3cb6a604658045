//! Closed-form starting points, computed from the data without any search.
//!
//! For pure cosines: the describing function of Coulomb friction has gain 4F̄/π and the phase of
//! the velocity. For the fundamental this gives A(jω)·U = V/P(jω) + (4/π)·F̄·V/|V| (Chen, Huang,
//! Yen 2002, IEEE Trans. Control Systems Technology 10(5)). It is linear in 1/K, a/K and F̄ if A is
//! known, and two magnitudes at one frequency give F̄/A(jω) itself. Its accuracy is that of the
//! describing function: good for a start, never for a comparison of models.
//!
//! For general inputs: the measured harmonics give the motion, hence when the axis moves in which
//! direction, hence the harmonics S⁺ and S⁻ of the indicators of v > 0 and v < 0. Then A(jkω)·Uₖ =
//! (jkω + a)·Vₖ/K + Fc⁺·Sₖ⁺ − Fc⁻·Sₖ⁻ is linear in 1/K, a/K, Fc⁺ and Fc⁻ for each actuator.

mod describing_function;
mod inverse_dynamics;

use crate::plant::{Actuator, Plant};

use super::problem::Problem;
use describing_function::{actuator_from_pairs, magnitude_pairs, mechanics, moving_fundamentals};
use inverse_dynamics::{fast, inverse_dynamics, over_the_band};

/// A starting plant, in scale; `None` if the data does not allow one.
pub(super) fn start(problem: &Problem, order: u8) -> Option<Plant> {
    let cosines = problem.experiments.iter().all(|e| e.excitation.is_pure_cosine());
    if !cosines {
        return inverse_dynamics(problem, &[fast(order, &problem.prior)]);
    }
    let fundamentals = moving_fundamentals(problem);
    let actuator = match order {
        0 => Actuator::Direct,
        _ => actuator_from_pairs(&fundamentals, order)?,
    };
    mechanics(&fundamentals, actuator)
}

/// The same for general inputs, beside the best of many actuators; `None` for cosines, or without an
/// actuator.
pub(super) fn beside_actuators(problem: &Problem, order: u8) -> Option<Plant> {
    let cosines = problem.experiments.iter().all(|e| e.excitation.is_pure_cosine());
    let has_some = order > 0 && !cosines;
    has_some.then(|| inverse_dynamics(problem, &over_the_band(order, &problem.prior))).flatten()
}

/// Whether pure cosines move the axis at two magnitudes of one frequency.
pub(super) fn has_two_magnitudes(problem: &Problem) -> bool {
    let cosines = problem.experiments.iter().all(|e| e.excitation.is_pure_cosine());
    cosines && !magnitude_pairs(&moving_fundamentals(problem)).is_empty()
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, multisine, stepped_sine};
    use super::*;

    fn assert_near(found: &Plant, wanted: &Plant, tolerance: f64) {
        let pairs = [
            (found.viscous_rate_rad_s, wanted.viscous_rate_rad_s),
            (found.constant, wanted.constant),
            (found.friction.fc_plus, wanted.friction.fc_plus),
            (found.friction.fc_minus, wanted.friction.fc_minus),
        ];
        for (found, wanted) in pairs {
            assert!((found / wanted).ln().abs() < tolerance, "{found} {wanted}");
        }
    }

    // Describing functions err by 5 to 20 % in the fundamental at 4 friction levels. The pole is a
    // small difference of larger terms and errs by up to twice that.
    #[test]
    fn cosines_of_two_magnitudes_give_a_start_of_describing_function_accuracy() {
        for actuator in ACTUATORS {
            let plant = axis(actuator);
            let problem = Problem::new(&stepped_sine(&plant, 3)).unwrap();
            let found = problem.in_units(&start(&problem, actuator.order()).unwrap());
            assert_near(&found, &plant, 0.4);
            assert_eq!(found.actuator.order(), actuator.order());
        }
    }

    // The motion is computed from the 30 measured lines; higher ones are missing.
    #[test]
    fn a_multisine_gives_a_start_from_the_measured_motion() {
        let plant = axis(Actuator::Direct);
        let problem = Problem::new(&multisine(&plant)).unwrap();
        let found = problem.in_units(&start(&problem, 0).unwrap());
        assert_near(&found, &plant, 0.1);
    }

    #[test]
    fn one_magnitude_gives_no_start_for_an_unknown_actuator() {
        let plant = axis(ACTUATORS[1]);
        let all = stepped_sine(&plant, 3);
        let one = super::super::fixtures::joined(all.experiments()[..8].to_vec());
        let problem = Problem::new(&one).unwrap();
        assert!(start(&problem, 0).is_some());
        assert!(start(&problem, 1).is_none() && start(&problem, 2).is_none());
    }

    // Neighbouring natural frequencies that are tried with such a resonance differ by 3 and 10 %.
    #[test]
    fn a_multisine_shows_the_sharp_resonance_of_an_actuator() {
        let plant =
            axis(Actuator::SecondOrder { natural_frequency_rad_s: 15.3, damping_ratio: 0.05 });
        let problem = Problem::new(&multisine(&plant)).unwrap();
        let found = problem.in_units(&beside_actuators(&problem, 2).unwrap());
        let Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } = found.actuator
        else {
            panic!("{found:?}")
        };
        assert!((natural_frequency_rad_s / 15.3).ln().abs() < 0.1, "{found:?}");
        assert!(damping_ratio < 0.2, "{found:?}");
    }
}
