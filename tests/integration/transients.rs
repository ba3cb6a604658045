//! Motions that need not repeat: the two simulators against each other.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use servoscope_bench::machines::simulator::{self, Effect, Machine, Samples, Settings, Start};
use servoscope_core::effects::{self, ActiveEffect};
use servoscope_core::measurement::Intersample;
use servoscope_core::plant::{Actuator, Friction, Plant};
use servoscope_core::simulate::{InitialState, SampledInput, Trajectory, follow};

const STEP_S: f64 = 5e-3;

/// Inputs of 6 s: a step, a chirp, a ramp to and fro, and what a drunken operator does.
fn inputs() -> Vec<(&'static str, Vec<f64>)> {
    let of = |f: &dyn Fn(f64) -> f64| (0..=1200).map(|n| f(f64::from(n) * STEP_S)).collect();
    let rng = &mut ChaCha8Rng::seed_from_u64(11);
    let (mut level, mut rate): (f64, f64) = (0.0, 0.0);
    let wander = (0..=1200).map(|_| {
        rate = 0.9 * rate + rng.random_range(-0.05..0.05);
        level = 0.97 * level + rate;
        level
    });
    vec![
        ("step", of(&|t| 1.3 * (10.0 * (t - 1.0).min(3.5 - t)).clamp(0.0, 1.0))),
        ("chirp", of(&|t| 1.5 * (t * (2.0 + 3.0 * t)).sin())),
        ("ramp", of(&|t| 2.0 * (0.5 * t - 1.0).clamp(-1.0, 1.0))),
        ("wander", wander.collect()),
    ]
}

fn plants() -> [Plant; 3] {
    let second = Actuator::SecondOrder { natural_frequency_rad_s: 31.6, damping_ratio: 0.08 };
    [Actuator::Direct, Actuator::FirstOrder { corner_rad_s: 25.0 }, second].map(|actuator| Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator,
        friction: Friction::coulomb(0.5, 0.4),
    })
}

/// One of each effect, in sizes that show.
fn every_effect() -> Vec<Effect> {
    vec![
        Effect::new("static_friction", [("fs_plus", 0.8), ("fs_minus", 0.6)]),
        Effect::new("stribeck", [("fs_over_fc", 1.6), ("stribeck_velocity", 0.1)]),
        Effect::new("viscous_asymmetry", [("alpha", 0.3)]),
        Effect::new("quadratic_drag", [("c", 0.5)]),
        Effect::new("presliding", [("sigma", 200.0)]),
        Effect::new("friction_drift", [("delta", 0.4)]),
        Effect::new(
            "backlash",
            [("load_inertia_fraction", 0.4), ("stiffness", 40.0), ("damping", 0.3), ("gap", 0.02)],
        ),
        Effect::new(
            "flexible_mode",
            [("load_inertia_fraction", 0.4), ("stiffness", 40.0), ("damping", 0.05)],
        ),
        Effect::new("spring", [("stiffness", 0.8)]),
        Effect::new("hardening_spring", [("stiffness", 0.3), ("cubic_stiffness", 0.6)]),
        Effect::new("cogging", [("amplitude", 0.2), ("cycles_per_unit", 30.0), ("phase", 0.7)]),
        Effect::new("transport_delay", [("delay", 0.0123)]),
        Effect::new("sensor_lag", [("time_constant", 0.02)]),
        Effect::new("actuator_saturation", [("limit", 1.0)]),
        Effect::new("actuator_dead_zone", [("half_width", 0.15)]),
        Effect::new("gain_asymmetry", [("gamma", 0.2)]),
        Effect::new("slew_limit", [("rate", 4.0)]),
    ]
}

/// What both simulators make of it.
fn both(
    plant: &Plant,
    effects: &[Effect],
    values: &[f64],
    hold: bool,
    velocity: f64,
) -> (Trajectory, simulator::Motion) {
    let active: Vec<ActiveEffect> = effects
        .iter()
        .map(|effect| {
            let values = effect.parameters().iter().map(|(_, value)| *value).collect();
            ActiveEffect::new(effects::find(effect.id()).unwrap(), values).unwrap()
        })
        .collect();
    let between = if hold { Intersample::Hold } else { Intersample::Linear };
    let input = SampledInput { step_s: STEP_S, values, between };
    let balance = 0.03;
    let initial = InitialState {
        velocity,
        position: 0.1,
        balance: Some(balance),
        bristle: Some(0.0),
        twist: Some(0.0),
        ..InitialState::default()
    };
    let exact = follow(plant, &active, 1.0, &input, &initial).unwrap();
    let machine = Machine { plant: *plant, effects };
    let samples = Samples { step_s: STEP_S, values, hold };
    let start = Start { velocity, position: 0.1, constant_torque: balance, ..Start::default() };
    let settings = Settings { steps_per_time_constant: 100.0, ..Settings::default() };
    (exact, simulator::follow(&machine, 1.0, &samples, &start, &settings).unwrap())
}

/// Largest difference as a share of the largest value.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    assert_eq!(one.len(), other.len());
    let largest = other.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

/// By how much velocities may differ, as a share of the largest: by the errors that the one
/// controls, ten of 1e-6 each, and by what the other misses, which is a visit to v = 0 or to a
/// level within one of its steps (1 ms at most, a hundredth of the shortest time constant): it
/// moves v by K·u'·step²/8.
fn tolerance(plant: &Plant, values: &[f64], stepped: &simulator::Motion) -> f64 {
    let steepest = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    let largest = stepped.velocity.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    1e-5 + plant.constant * steepest / STEP_S * 1e-6 / 8.0 / largest
}

#[test]
fn the_base_model_moves_alike_in_both() {
    for (name, values) in inputs() {
        for (order, plant) in plants().iter().enumerate() {
            for hold in [false, true] {
                for velocity in [0.0, -0.4] {
                    let (exact, stepped) = both(plant, &[], &values, hold, velocity);
                    let v = apart(&exact.velocity, &stepped.velocity);
                    let p = apart(&exact.position, &stepped.position);
                    // A base model's motion is exact, and its switches are on its steps' scale.
                    let case = format!("{name} {order} {hold} {velocity}: {v:.1e} {p:.1e}");
                    println!("{case}");
                    assert!(v < 1e-6 && p < 1e-6, "{case}");
                }
            }
        }
    }
}

#[test]
fn every_effect_moves_alike_in_both() {
    let effects = every_effect();
    assert!(effects::ALL.iter().all(|e| effects.iter().any(|of| of.id() == e.id())));
    let mut failed = Vec::new();
    for effect in effects {
        for (name, values) in inputs() {
            for (order, plant) in plants().iter().enumerate() {
                let (exact, stepped) = both(plant, &[effect], &values, order == 1, 0.0);
                // Collisions part what was close by: with play both find them to fewer digits.
                let play = if effect.id() == "backlash" { 10.0 } else { 1.0 };
                let most = play * tolerance(plant, &values, &stepped);
                let v = apart(&exact.velocity, &stepped.velocity);
                let p = apart(&exact.position, &stepped.position);
                let a = apart(&exact.acceleration, &stepped.acceleration);
                let case = format!("{} {name} {order}: {v:.1e} {p:.1e} {a:.1e}", effect.id());
                println!("{case}, at most {most:.1e}");
                // An acceleration is ten times as sensitive: v' ≈ a·v.
                if v > most || p > most || a > 10.0 * most {
                    failed.push(case);
                }
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}
