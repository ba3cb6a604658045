//! Axes with play: contacts, impacts, and motions of which several repeat.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use servoscope_bench::machines::draw::draw;
use servoscope_bench::machines::simulator::{Effect, Settings};
use servoscope_bench::naming::effect_draws::draw_effect;
use servoscope_core::effects::{self, ActiveEffect};
use servoscope_core::measurement::Complex;
use servoscope_core::plant::{Actuator, Friction, Plant};
use servoscope_core::simulate::{Counts, Excitation, NoResponse, respond, respond_if};

use crate::simulators::{Case, largest_difference};

// Every point of some designs: such an instant is met by one in a hundred. Across the largest
// gaps impacts may never come to repeat.
#[test]
fn contacts_that_come_the_instant_a_step_begins_leave_a_response_in_numbers() {
    let backlash = effects::find("backlash").unwrap();
    let answered = (0..21_u64).into_par_iter().map(|i| {
        let drawn = draw((i % 3) as u8, i / 3);
        let effect = draw_effect("backlash", &drawn, &mut ChaCha8Rng::seed_from_u64(i / 3));
        let values = effect.parameters().iter().map(|(_, value)| *value).collect();
        let effects = [ActiveEffect::new(backlash, values).unwrap()];
        let velocity = |(magnitude, omega): &(f64, f64)| {
            respond(&drawn.plant, &effects, &Excitation::cosine(*omega, *magnitude), 7).ok()
        };
        let velocities: Vec<_> = drawn.design.iter().filter_map(velocity).collect();
        assert!(velocities.iter().flatten().all(|v| v.is_finite()), "{i}: {velocities:?}");
        velocities.len()
    });
    let answered: usize = answered.sum();
    assert!(answered > 21 * 48 * 9 / 10, "{answered}");
}

/// An axis with play (ρ, k, c and gap) in a point of its own.
fn with_play(
    plant: Plant,
    [load_inertia_fraction, stiffness, damping, gap]: [f64; 4],
    magnitude: f64,
    omega_rad_s: f64,
) -> Case {
    let effects = vec![Effect::new(
        "backlash",
        [
            ("load_inertia_fraction", load_inertia_fraction),
            ("stiffness", stiffness),
            ("damping", damping),
            ("gap", gap),
        ],
    )];
    let input = vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)];
    Case { plant, effects, run_share: 0.0, omega_rad_s, input }
}

/// One whose impacts depend on the joint's damping and on the point.
fn rattling(damping: f64, magnitude: f64, omega_rad_s: f64) -> Case {
    let actuator =
        Actuator::SecondOrder { natural_frequency_rad_s: 6.245474, damping_ratio: 0.5944140 };
    let friction = Friction::coulomb(0.2888457, 0.3872526);
    let plant = Plant { constant: 1.660596, viscous_rate_rad_s: 3.042747, actuator, friction };
    with_play(plant, [0.182259, 59.97234, damping, 0.004244359], magnitude, omega_rad_s)
}

// At low frequencies the axis rests for long, and the load drifts from end to end of its gap,
// its twist a straight line. The tolerance is half of the contract's, of the largest response here.
#[test]
fn a_load_that_drifts_in_its_gap_while_the_axis_rests_touches_alike_in_both_simulators() {
    let plant = Plant {
        constant: 7.448064,
        viscous_rate_rad_s: 4.496167,
        actuator: Actuator::FirstOrder { corner_rad_s: 10.42757 },
        friction: Friction::coulomb(0.1064672, 0.1157884),
    };
    let joint = [0.2376795, 680.8241, 0.94244, 1.4817e-4];
    let slow = [0.67, 0.89, 1.18, 1.56, 2.07, 2.74, 3.62];
    (0..3 * slow.len()).into_par_iter().for_each(|i| {
        let (magnitude, omega_rad_s) = (0.2219 * [1.0, 2.0, 4.0][i % 3], slow[i / 3]);
        let both = with_play(plant, joint, magnitude, omega_rad_s).simulate(&Settings::default());
        let apart = largest_difference(&both.exact.unwrap(), &both.stepped.unwrap());
        assert!(apart < 1e-5, "{magnitude} {omega_rad_s}: {apart:e}");
    });
}

// Multipliers of the motions that Newton's method comes to first: −3.7 and 3.6. The tolerance
// is the contract's, of the largest response of a design that has both points.
#[test]
fn a_periodic_motion_in_which_no_axis_stays_is_not_the_response() {
    for (magnitude, omega_rad_s) in [(0.865747, 3.003098), (1.731494, 12.337548)] {
        let case = rattling(0.3670977, magnitude, omega_rad_s);
        let both = case.simulate(&Settings::default());
        let apart = largest_difference(&both.exact.unwrap(), &both.stepped.unwrap());
        assert!(apart < 5e-5 * 0.4, "{magnitude} {omega_rad_s}: {apart:e}");
    }
}

// Newton's method from the end of the first period ends in another motion. The tolerance is the
// contract's, of the response itself.
#[test]
fn of_several_motions_that_repeat_the_one_reached_from_rest_is_the_response() {
    let plant = Plant {
        constant: 3.493069,
        viscous_rate_rad_s: 12.23117,
        actuator: Actuator::FirstOrder { corner_rad_s: 68.11610 },
        friction: Friction::coulomb(0.7032706, 0.6551141),
    };
    let joint = [0.03779108, 23.32777, 0.3579927, 0.009293163];
    let apart = with_play(plant, joint, 1.5987, 22.798).difference();
    assert!(apart < 5e-5, "{apart:e}");
}

#[test]
fn where_impacts_never_come_to_repeat_there_is_no_response_but_something_to_go_on_from() {
    for (magnitude, omega_rad_s) in [(1.7315, 3.359038), (0.8657, 3.412783)] {
        let case = rattling(0.1, magnitude, omega_rad_s);
        let both = case.simulate(&Settings::default());
        assert!(both.stepped.is_err(), "{magnitude} {omega_rad_s}");
        let exact = both.exact.unwrap_err();
        assert!(matches!(exact, NoResponse::NotPeriodic { .. }), "{exact}");
        let (effects, excitation) = (case.active(), case.excitation());
        let unstable =
            respond_if(Counts::EvenUnstable, &case.plant, &effects, &excitation, 7).unwrap();
        assert!(unstable[1].norm() > 0.0 && unstable.iter().all(|v| v.is_finite()));
    }
}
