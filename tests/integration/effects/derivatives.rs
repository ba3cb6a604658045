//! Derivatives of responses with effects, against differences of the responses.

use rayon::prelude::*;
use servoscope_bench::machines::simulator::Effect;
use servoscope_bench::naming::effect_draws::ids;
use servoscope_core::effects::{self, ActiveEffect, Wide};
use servoscope_core::plant::{Friction, Plant};
use servoscope_core::simulate::{Counts, Excitation, respond, respond_with_sensitivities};

use super::{cosine, general};
use crate::simulators::Case;

/// Every number of a plant as a variable, static levels tied to Coulomb levels.
fn variable(plant: &Plant) -> (Plant<Wide>, Vec<f64>) {
    let mut values = Vec::new();
    let mut next = |value: f64| {
        values.push(value);
        Wide::variable(value, values.len() - 1)
    };
    let Friction { fc_plus, fc_minus, .. } = plant.friction;
    let friction = Friction::coulomb(next(fc_plus), next(fc_minus));
    let actuator = plant.actuator.map(&mut next);
    let viscous_rate_rad_s = next(plant.viscous_rate_rad_s);
    let constant = next(plant.constant);
    (Plant { viscous_rate_rad_s, constant, actuator, friction }, values)
}

/// The plant whose numbers, in the order of [`variable`], are these.
fn plant_of(like: &Plant, values: &[f64]) -> Plant {
    let mut left = values.iter().copied();
    let mut next = || left.next().expect("as many numbers as variables");
    let friction = Friction::coulomb(next(), next());
    let actuator = like.actuator.map(|_| next());
    Plant { friction, actuator, viscous_rate_rad_s: next(), constant: next() }
}

/// Largest difference of a case's derivatives from central differences of its
/// responses, each derivative times its variable, as a share of the largest harmonic.
fn derivative_error(case: &Case) -> f64 {
    let own = |effect: &Effect| effect.parameters().iter().map(|(_, value)| *value).collect();
    let values: Vec<Vec<f64>> = case.effects.iter().map(own).collect();
    let active = |values: &[f64]| -> Vec<ActiveEffect> {
        let mut left = values.iter().copied();
        let active = |effect: &Effect| {
            let own = left.by_ref().take(effect.parameters().len()).collect();
            ActiveEffect::new(effects::find(effect.id()).unwrap(), own).unwrap()
        };
        case.effects.iter().map(active).collect()
    };
    let values = values.concat();
    let excitation = Excitation::new(case.omega_rad_s, case.input.clone());
    let excitation = excitation.at_run_share(case.run_share);
    let (wide, numbers) = variable(&case.plant);
    let count = numbers.len();
    let exact = respond_with_sensitivities(
        Counts::FromRest,
        &wide,
        count,
        &active(&values),
        &excitation,
        7,
    )
    .unwrap();
    let all: Vec<f64> = numbers.into_iter().chain(values).collect();
    assert_eq!(exact.sensitivities.len(), all.len());
    let largest = exact.velocity.iter().map(|v| v.norm()).fold(0.0, f64::max);
    let mut worst = 0.0_f64;
    for (lane, row) in exact.sensitivities.iter().enumerate() {
        let step = 1e-4 * all[lane].abs();
        let at = |sign: f64| {
            let mut moved = all.clone();
            moved[lane] += sign * step;
            let plant = plant_of(&case.plant, &moved[..count]);
            respond(&plant, &active(&moved[count..]), &excitation, 7).unwrap()
        };
        let (up, down) = (at(1.0), at(-1.0));
        for k in 0..row.len() {
            let numeric = (up[k] - down[k]) / (2.0 * step);
            worst = worst.max((row[k] - numeric).norm() * all[lane].abs() / largest);
        }
    }
    worst
}

// Central differences over 1e-4: 1e-8 of the third derivative and 1e4 of what one response
// errs by, a few 1e-8 from step to step. Where a contact, a phase of rest or the whole motion
// is born or dies within the step the derivative itself jumps: eight of ten points are free
// of that.
#[test]
fn derivatives_by_every_number_are_those_of_the_responses() {
    for id in ids() {
        let errors = |i: u64| {
            let order = (i % 3) as u8;
            let drawn = if i < 8 { cosine } else { general };
            let (case, _) = drawn(order, &[id], i);
            derivative_error(&case)
        };
        let mut errors: Vec<f64> = (0..10_u64).into_par_iter().map(errors).collect();
        errors.sort_by(f64::total_cmp);
        println!("{id}: {:.1e} {:.1e} {:.1e}", errors[5], errors[8], errors[9]);
        assert!(errors[7] < 1e-3, "{id}: {errors:?}");
    }
}

// As above. The torque depends on six numbers, which are not differentiated all at once; four
// states and the three of a spring beside a gap are those of one solver each.
#[test]
fn derivatives_of_several_effects_are_those_of_the_responses() {
    let together: [&[&str]; 4] = [
        &["actuator_saturation", "actuator_dead_zone", "gain_asymmetry", "slew_limit", "spring"],
        &["flexible_mode", "spring"],
        &["backlash", "spring"],
        &["flexible_mode", "hardening_spring"],
    ];
    for ids in together {
        let errors = |i: u64| derivative_error(&cosine(2, ids, i).0);
        let mut errors: Vec<f64> = (0..10_u64).into_par_iter().map(errors).collect();
        errors.sort_by(f64::total_cmp);
        println!("{ids:?}: {:.1e} {:.1e} {:.1e}", errors[5], errors[8], errors[9]);
        assert!(errors[7] < 1e-3, "{ids:?}: {errors:?}");
    }
}
