mod effects;

use super::*;
use crate::plant::Friction;

fn plant(fc_plus: f64, fc_minus: f64) -> Plant {
    Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator: Actuator::Direct,
        friction: Friction::coulomb(fc_plus, fc_minus),
    }
}

/// Harmonics of the base model at the default settings.
fn base(plant: &Plant, omega_rad_s: f64, input: &[Complex], harmonics: usize) -> Vec<Complex> {
    let machine = Machine::base(*plant);
    respond(&machine, 0.0, omega_rad_s, input, harmonics, &Settings::default()).unwrap()
}

fn cosine(magnitude: f64) -> Vec<Complex> {
    vec![Complex::new(0.0, 0.0), Complex::new(magnitude, 0.0)]
}

fn worst(left: &[Complex], right: &[Complex]) -> f64 {
    left.iter().zip(right).map(|(l, r)| (l - r).norm()).fold(0.0, f64::max)
}

#[test]
fn without_friction_the_response_is_the_transfer_function() {
    let second = Actuator::SecondOrder { natural_frequency_rad_s: 31.6, damping_ratio: 0.08 };
    for actuator in [Actuator::Direct, Actuator::FirstOrder { corner_rad_s: 25.0 }, second] {
        let plant = Plant { actuator, ..plant(0.0, 0.0) };
        let input = [Complex::new(0.3, 0.0), Complex::new(1.0, 0.5), Complex::new(-0.2, 0.1)];
        for omega in [1.0, 20.0, 200.0] {
            let exact: Vec<Complex> = (0..4)
                .map(|k| {
                    let line = input.get(k).copied().unwrap_or_default();
                    let at = k as f64 * omega;
                    actuator.response(at) * plant.mechanics_response(at) * line
                })
                .collect();
            let found = base(&plant, omega, &input, 3);
            // The tolerance for transients.
            assert!(worst(&found, &exact) < 2e-9, "{actuator:?} at {omega} rad/s");
        }
    }
}

#[test]
fn a_torque_below_the_static_level_leaves_the_axis_stuck() {
    let found = base(&plant(0.5, 0.4), 5.0, &cosine(0.39), 4);
    assert_eq!(found, vec![Complex::new(0.0, 0.0); 5]);
}

// The static friction is above the torque in one direction, so the axis creeps in the other only.
// Once per period it breaks away at m cos ωt = Fs⁺, and then v' = −a v + K (m cos ωt − Fc⁺).
#[test]
fn an_axis_held_in_one_direction_creeps_in_the_other() {
    let held = Plant {
        friction: Friction { fc_plus: 0.2, fc_minus: 0.2, fs_plus: 0.8, fs_minus: 5.0 },
        ..plant(0.0, 0.0)
    };
    let (omega, magnitude) = (2.0, 1.0);
    let found = base(&held, omega, &cosine(magnitude), 1);

    // Closed form: a forced oscillation, a constant and one exponential. Bisection finds its zero.
    let response = held.mechanics_response(omega);
    let forced = |t: f64| {
        (magnitude * response * Complex::from_polar(1.0, omega * t)).re
            - held.constant * 0.2 / held.viscous_rate_rad_s
    };
    let release = -(0.8_f64.acos()) / omega;
    let velocity =
        |t: f64| forced(t) - forced(release) * (-held.viscous_rate_rad_s * (t - release)).exp();
    let (mut moving, mut after) = (0.0, release + TAU / omega);
    while after - moving > 1e-14 {
        let middle = 0.5 * (moving + after);
        if velocity(middle) > 0.0 { moving = middle } else { after = middle }
    }
    let count = 20_000;
    let width = (moving - release) / count as f64;
    // The error of the midpoint rule is (width·ω)²/24 = 1e-9.
    let mean: f64 = (0..count).map(|i| velocity(release + (i as f64 + 0.5) * width)).sum::<f64>()
        * width
        * omega
        / TAU;
    assert!((found[0].re - mean).abs() < 1e-8 * mean, "{} {mean}", found[0].re);
}

#[test]
fn a_reversal_sticks_until_the_torque_exceeds_the_static_level() {
    let response = |fs: f64| {
        let friction = Friction { fs_plus: fs, fs_minus: fs, ..Friction::coulomb(0.4, 0.4) };
        let plant = Plant { friction, ..plant(0.0, 0.0) };
        base(&plant, 30.0, &cosine(1.0), 3)
    };
    // The velocity passes zero with a lag of about 35°, where |τ| is about 0.57. A static level
    // below that changes nothing but the transient, which is below the tolerance.
    assert!(worst(&response(0.4), &response(0.5)) < 1e-9);
    assert!(worst(&response(0.4), &response(0.8)) > 1e-3);
}

#[test]
fn mirrored_friction_mirrors_the_response() {
    let found = base(&plant(0.5, 0.4), 3.0, &cosine(1.0), 5);
    let mirrored = base(&plant(0.4, 0.5), 3.0, &cosine(-1.0), 5);
    let negative: Vec<Complex> = mirrored.iter().map(|v| -v).collect();
    assert!(worst(&found, &negative) < 1e-14);
}

#[test]
fn half_the_step_leaves_a_sixteenth_of_the_error() {
    let second = Actuator::SecondOrder { natural_frequency_rad_s: 31.6, damping_ratio: 0.08 };
    let friction = Friction { fs_plus: 0.8, fs_minus: 0.6, ..Friction::coulomb(0.5, 0.4) };
    for (actuator, omega) in [(Actuator::Direct, 2.0), (Actuator::Direct, 30.0), (second, 15.0)] {
        let plant = Plant { actuator, friction, ..plant(0.0, 0.0) };
        let with_steps = |steps_per_period| {
            let settings = Settings {
                steps_per_period,
                steps_per_time_constant: 0.0,
                tolerance: 1e-13,
                ..Settings::default()
            };
            respond(&Machine::base(plant), 0.0, omega, &cosine(1.5), 5, &settings).unwrap()
        };
        let exact = with_steps(8192);
        let errors = [128, 256, 512].map(|steps| worst(&with_steps(steps), &exact));
        // Two halvings, each with a factor between 2³ and 2⁵: the fourth order is asymptotic, and
        // the error varies with the position of events within their steps.
        let gain = errors[0] / errors[2];
        assert!((8.0 * 8.0..32.0 * 32.0).contains(&gain), "{actuator:?}: {errors:?}");
        // The accuracy at the default settings that the module documentation states.
        assert!(worst(&with_steps(2048), &exact) < 1e-9);
    }
}

#[test]
fn a_multisine_of_240_lines_is_resolved() {
    // Schroeder phases give a low crest factor, so the velocity crosses zero often.
    let mut input = vec![Complex::new(0.0, 0.0)];
    let phase = |k: usize| -std::f64::consts::PI * (k * (k - 1)) as f64 / 240.0;
    input.extend((1..=240).map(|k| Complex::from_polar(0.15, phase(k))));
    let plant = plant(0.3, 0.25);
    let with = |steps_per_input_line| {
        let settings = Settings { steps_per_input_line, ..Settings::default() };
        respond(&Machine::base(plant), 0.0, 0.5, &input, 240, &settings).unwrap()
    };
    let (found, finer) = (with(64), with(256));
    let largest = finer.iter().map(|v| v.norm()).fold(0.0, f64::max);
    // The error of Simpson's rule is (2π/64)⁴/2880 = 3e-8 of the highest line.
    assert!(worst(&found, &finer) < 3e-8 * largest);
}

#[test]
fn invalid_parameters_are_refused_by_name() {
    let refused = |plant: Plant, omega: f64, input: &[Complex]| {
        let machine = Machine::base(plant);
        respond(&machine, 0.0, omega, input, 1, &Settings::default()).unwrap_err().to_string()
    };
    let base = plant(0.5, 0.4);
    let slow = Plant { viscous_rate_rad_s: f64::NAN, ..base };
    assert_eq!(refused(slow, 1.0, &cosine(1.0)), "a is NaN: it must be finite and positive");
    let friction = Friction { fs_plus: 0.1, ..base.friction };
    let inverted = Plant { friction, ..base };
    assert!(refused(inverted, 1.0, &cosine(1.0)).starts_with("Fs+ is 0.1"));
    assert!(refused(base, 0.0, &cosine(1.0)).starts_with("the fundamental frequency"));
    assert!(refused(base, 1.0, &cosine(f64::INFINITY)).starts_with("a line of the input"));
    assert!(refused(base, 1e-6, &cosine(1.0)).contains("steps"));
}

#[test]
fn a_transient_that_has_not_died_is_an_error() {
    let settings = Settings { most_periods: 2, ..Settings::default() };
    let machine = Machine::base(plant(0.1, 0.1));
    let error = respond(&machine, 0.0, 300.0, &cosine(1.0), 1, &settings).unwrap_err();
    assert!(matches!(error, SimulatorError::NotPeriodic { periods: 2, .. }), "{error}");
}
