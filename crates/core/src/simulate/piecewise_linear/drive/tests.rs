use std::f64::consts::{PI, TAU};

use super::*;
use crate::effects::{ActiveEffect, enter_values};
use crate::effects::{Stage, find};
use crate::plant::{Friction, Plant};
use crate::simulate::signal::fourier::Fourier;

fn axis(actuator: Actuator, effects: &[(&str, f64)]) -> Axis {
    let plant = Plant {
        viscous_rate_rad_s: 10.0,
        constant: 10.0,
        actuator,
        friction: Friction::coulomb(0.5, 0.4),
    };
    let active =
        |(id, value): &(&str, f64)| ActiveEffect::new(find(id).unwrap(), vec![*value]).unwrap();
    enter_values(plant, &effects.iter().map(active).collect::<Vec<_>>(), 0.0)
}

/// Harmonics 0 … 5 of the torque.
fn harmonics(axis: &Axis, excitation: &Excitation) -> Vec<Complex> {
    let omega = excitation.omega_rad_s();
    let (forcing, grid) = torque(axis, excitation, 32);
    let mut sums = Fourier::new(grid, omega, 5);
    for cell in &forcing.cells {
        match cell.whole {
            Some(n) => sums.add_whole(n, cell.powers),
            None => sums.add_part(cell, 0.0, 1.0),
        }
    }
    let weight = |k: usize| if k == 0 { omega / TAU } else { omega / PI };
    sums.finish().iter().enumerate().map(|(k, sum)| sum.value() * weight(k)).collect()
}

// The fundamental of a cosine of amplitude 1 clipped at c: (2/π)(asin c + c·√(1 − c²)).
#[test]
fn a_clipped_cosine_has_the_describing_function_of_saturation() {
    for limit in [0.3, 0.8, 0.999] {
        let axis = axis(Actuator::Direct, &[("actuator_saturation", limit)]);
        let found = harmonics(&axis, &Excitation::cosine(3.0, 1.0));
        let expected = 2.0 / PI * (limit.asin() + limit * (1.0 - limit * limit).sqrt());
        // The cosine is interpolated from 32 cells: (2π/32)⁶/46080 = 1e-9.
        assert!((found[1] - expected).norm() < 1e-8, "{limit}: {}", found[1]);
        assert!(found[0].norm() < 1e-9 && found[2].norm() < 1e-9);
    }
}

// A triangle of amplitude r·T/4 has the fundamental (8/π²)·r·T/4, and odd harmonics 1/k² of it.
#[test]
fn a_limiter_that_never_follows_makes_the_triangle_of_the_contract() {
    let (omega, rate) = (5.0, 2.0);
    let axis = axis(Actuator::Direct, &[("slew_limit", rate)]);
    for magnitude in [2.0, 50.0] {
        let found = harmonics(&axis, &Excitation::cosine(omega, magnitude));
        let amplitude = rate * TAU / omega / 4.0;
        let expected = 8.0 / (PI * PI) * amplitude;
        assert!((found[1].norm() - expected).abs() < 1e-9 * expected, "{magnitude}");
        assert!((found[3].norm() - expected / 9.0).abs() < 1e-9 * expected, "{magnitude}");
        assert!(found[0].norm() < 1e-9 * expected, "{magnitude}");
    }
}

#[test]
fn a_limiter_that_is_fast_enough_changes_nothing() {
    let excitation = Excitation::cosine(5.0, 2.0);
    let limited = harmonics(&axis(Actuator::Direct, &[("slew_limit", 10.1)]), &excitation);
    assert!((limited[1] - 2.0).norm() < 1e-8 && limited[3].norm() < 1e-9);
}

#[test]
fn behind_the_actuator_every_harmonic_is_filtered_by_it() {
    let maps = [("actuator_dead_zone", 0.4), ("gain_asymmetry", 0.2)];
    let actuators = [
        Actuator::FirstOrder { corner_rad_s: 7.0 },
        Actuator::FirstOrder { corner_rad_s: 700.0 },
        Actuator::SecondOrder { natural_frequency_rad_s: 20.0, damping_ratio: 0.1 },
        Actuator::SecondOrder { natural_frequency_rad_s: 2e3, damping_ratio: 0.1 },
        Actuator::SecondOrder { natural_frequency_rad_s: 1e4, damping_ratio: 0.5 },
        Actuator::SecondOrder { natural_frequency_rad_s: 20.0, damping_ratio: 1.0 },
        Actuator::SecondOrder { natural_frequency_rad_s: 20.0, damping_ratio: 4.0 },
    ];
    for excitation in [
        Excitation::cosine(3.0, 2.0),
        Excitation::new(3.0, [0.1, 1.0, 0.5].map(|x| Complex::new(x, 0.2 * x)).to_vec()),
    ] {
        let ahead = harmonics(&axis(Actuator::Direct, &maps), &excitation);
        for actuator in actuators {
            let behind = harmonics(&axis(actuator, &maps), &excitation);
            for k in 0..=5 {
                let expected = ahead[k] * actuator.response(3.0 * k as f64);
                // The modes excited by a kink are represented to 1e-5 of their size.
                let error = (behind[k] - expected).norm();
                assert!(error < 3e-6, "{actuator:?} {k}: {error:e}");
            }
        }
    }
}

#[test]
fn pieces_of_a_map_meet_where_its_slope_changes() {
    let map = InputMap {
        stage: Stage::Gain,
        breaks: vec![-1.0, 0.5, 2.0],
        slopes: vec![3.0, 1.0, 0.0, -2.0],
    };
    for (i, at) in map.breaks.iter().enumerate() {
        let ((o, s), (p, t)) = (map.piece(i), map.piece(i + 1));
        assert!((o + s * at - p - t * at).abs() < 1e-15);
    }
    assert_eq!(map.piece(1), (0.0, 1.0));
}
