use super::*;
use crate::effects::Range;
use crate::plant::{Actuator, Friction};

fn plant(actuator: Actuator, friction: Friction) -> Plant {
    Plant { viscous_rate_rad_s: 10.0, constant: 10.0, actuator, friction }
}

const RESONANT: Actuator =
    Actuator::SecondOrder { natural_frequency_rad_s: 31.6, damping_ratio: 0.08 };

/// A cosine with a tiny mean, which sends it through the code for general inputs.
fn as_general(omega: f64, magnitude: f64) -> Excitation {
    let tiny = Complex::new(f64::MIN_POSITIVE, 0.0);
    Excitation::new(omega, vec![tiny, Complex::new(magnitude, 0.0)])
}

fn largest_difference(left: &[Complex], right: &[Complex]) -> f64 {
    left.iter().zip(right).map(|(l, r)| (l - r).norm()).fold(0.0, f64::max)
}

#[test]
fn the_two_paths_agree_on_a_cosine() {
    let frictions = [
        Friction::coulomb(0.5, 0.4),
        Friction::coulomb(0.0, 0.0),
        Friction::coulomb(0.9, 0.2),
        Friction { fc_plus: 0.5, fc_minus: 0.4, fs_plus: 0.8, fs_minus: 0.6 },
    ];
    for friction in frictions {
        for actuator in [Actuator::Direct, RESONANT] {
            for omega in [0.5, 3.0, 17.0, 60.0] {
                for magnitude in [0.7, 1.0, 1.7, 4.0] {
                    let plant = plant(actuator, friction);
                    let exact =
                        respond(&plant, &[], &Excitation::cosine(omega, magnitude), 9).unwrap();
                    let general = respond(&plant, &[], &as_general(omega, magnitude), 9).unwrap();
                    // The general code interpolates w on 1024 samples: error (2π/1024)⁶/46080 of w.
                    let difference = largest_difference(&exact, &general);
                    assert!(
                        difference < 1e-9,
                        "{friction:?} {actuator:?} ω {omega} m {magnitude}: {difference:e}"
                    );
                }
            }
        }
    }
}

#[test]
fn sensitivities_agree_with_finite_differences() {
    let friction = Friction { fc_plus: 0.5, fc_minus: 0.4, fs_plus: 0.6, fs_minus: 0.55 };
    let multisine = Excitation::new(
        2.0,
        [0.1, 1.0, 0.4, 0.0, 0.3, 0.5]
            .iter()
            .enumerate()
            .map(|(k, m)| Complex::from_polar(*m, if k == 0 { 0.0 } else { (k * k) as f64 }))
            .collect(),
    );
    let excitations = [Excitation::cosine(2.0, 0.8), Excitation::cosine(15.0, 2.0), multisine];
    for (e, excitation) in excitations.iter().enumerate() {
        for actuator in [Actuator::FirstOrder { corner_rad_s: 20.0 }, RESONANT] {
            let base = [10.0, 9.0, 0.5, 0.4, 0.6, 0.55];
            let (first, second) = match actuator {
                Actuator::SecondOrder { natural_frequency_rad_s, damping_ratio } => {
                    (natural_frequency_rad_s, damping_ratio)
                }
                _ => (20.0, 0.0),
            };
            let all = [base.as_slice(), &[first, second]].concat();
            let build = |p: &[f64]| Plant {
                viscous_rate_rad_s: p[0],
                constant: p[1],
                friction: Friction { fc_plus: p[2], fc_minus: p[3], fs_plus: p[4], fs_minus: p[5] },
                actuator: match actuator {
                    Actuator::SecondOrder { .. } => {
                        Actuator::SecondOrder { natural_frequency_rad_s: p[6], damping_ratio: p[7] }
                    }
                    _ => Actuator::FirstOrder { corner_rad_s: p[6] },
                },
            };
            assert_eq!(build(&all).friction, friction);
            let mut lane = 0;
            let variables = build(&all).map(|value| {
                lane += 1;
                Wide::variable(value, lane - 1)
            });
            let response =
                respond_with_sensitivities(Counts::FromRest, &variables, lane, &[], excitation, 6)
                    .unwrap();
            // `Plant::map` visits a, K, the actuator and then the friction levels.
            let actuator = all.len() - 6 - usize::from(lane == 7);
            let order: Vec<usize> = [0, 1].into_iter().chain(6..6 + actuator).chain(2..6).collect();
            for (row, i) in order.into_iter().enumerate() {
                let step = 1e-5 * all[i].abs().max(1e-2);
                let moved = |sign: f64| {
                    let mut p = all.clone();
                    p[i] += sign * step;
                    respond(&build(&p), &[], excitation, 6).unwrap()
                };
                let (up, down) = (moved(1.0), moved(-1.0));
                for k in 0..=6 {
                    let numeric = (up[k] - down[k]) / (2.0 * step);
                    let analytic = response.sensitivities[row][k];
                    // Error of a central difference: step² times the third derivative.
                    let error = (numeric - analytic).norm();
                    assert!(
                        error < 2e-6 * (1.0 + analytic.norm()),
                        "{e} {i} k {k}: {analytic} {numeric}"
                    );
                }
            }
        }
    }
}

#[test]
fn an_input_deviation_moves_the_response_as_the_simulation_says() {
    let plant = plant(RESONANT, Friction::coulomb(0.5, 0.4));
    let lines: Vec<Complex> = (0..6)
        .map(|k| Complex::from_polar(0.6, if k == 0 { 0.0 } else { (k * k) as f64 }))
        .collect();
    let deviation: Vec<Complex> = (0..6)
        .map(|k| Complex::from_polar(1e-6, if k == 0 { 0.0 } else { 2.0 * k as f64 }))
        .collect();
    let moved: Vec<Complex> = lines.iter().zip(&deviation).map(|(u, d)| u + d).collect();
    let before = Excitation::new(2.0, lines);
    let after = respond(&plant, &[], &Excitation::new(2.0, moved), 8).unwrap();
    let linear = respond_to_deviations(&plant, &[], &before, 8, &[&deviation]).unwrap();
    let reference = respond(&plant, &[], &before, 8).unwrap();
    for k in 0..=8 {
        let difference = after[k] - reference[k];
        // The error is of second order in a relative deviation of 1e-6, and rounding.
        assert!((difference - linear[0][k]).norm() < 1e-10, "k {k}");
    }
}

#[test]
fn an_axis_below_its_static_level_rests() {
    let plant = plant(Actuator::Direct, Friction::coulomb(0.5, 0.4));
    let response = respond(&plant, &[], &Excitation::cosine(3.0, 0.4), 5).unwrap();
    assert!(response.iter().all(|v| v.norm() == 0.0));
}

#[test]
fn a_torque_above_one_level_only_moves_the_axis_one_way() {
    let plant = plant(Actuator::Direct, Friction::coulomb(0.5, 0.4));
    let orbit = orbit(&plant, &Excitation::cosine(3.0, 0.45)).unwrap();
    let motions: Vec<Motion> = orbit.phases.iter().map(|phase| phase.motion).collect();
    assert_eq!(motions, [Motion::Backward, Motion::Stuck]);
}

#[test]
fn a_large_mean_torque_keeps_the_axis_moving() {
    let plant = plant(Actuator::Direct, Friction::coulomb(0.5, 0.4));
    let excitation = Excitation::new(3.0, vec![Complex::new(3.0, 0.0), Complex::new(1.0, 0.0)]);
    let velocity = respond(&plant, &[], &excitation, 3).unwrap();
    // The axis never reverses: it is linear, with its mean torque reduced by Fc⁺.
    let expected = plant.mechanics_response(3.0);
    assert!((velocity[0].re - 2.5).abs() < 1e-12);
    assert!((velocity[1] - expected).norm() < 1e-12);
    assert!(velocity[2].norm() < 1e-12);
}

#[test]
fn without_friction_the_response_is_the_transfer_function() {
    let plant = plant(RESONANT, Friction::coulomb(0.0, 0.0));
    let velocity = respond(&plant, &[], &Excitation::cosine(20.0, 2.0), 3).unwrap();
    let expected = 2.0 * plant.mechanics_response(20.0) * RESONANT.response(20.0);
    assert!((velocity[1] - expected).norm() < 1e-12);
    assert!(velocity[3].norm() < 1e-12);
}

#[test]
fn presliding_on_stiff_bristles_is_close_to_set_valued_friction() {
    let plant = plant(RESONANT, Friction::coulomb(0.5, 0.4));
    let presliding = effects::find("presliding").unwrap();
    for omega in [1.5, 6.0] {
        let excitation = Excitation::cosine(omega, 2.0);
        let rigid = respond(&plant, &[], &excitation, 7).unwrap();
        let difference = |sigma: f64| {
            let effect = ActiveEffect::new(presliding, vec![sigma]).unwrap();
            largest_difference(&rigid, &respond(&plant, &[effect], &excitation, 7).unwrap())
        };
        // When the axis stops, it swings back on the bristles with a velocity of up to Fc·√(K/σ).
        let (soft, stiff) = (difference(1e3), difference(1e5));
        let swing = 0.5 * (10.0_f64 / 1e5).sqrt();
        assert!(stiff < 0.2 * soft && stiff < swing, "ω {omega}: {soft:e} {stiff:e}");
    }
}

fn with_effect(id: &str, values: &[f64], omega: f64, magnitude: f64) -> Vec<Complex> {
    let axis = plant(Actuator::Direct, Friction::coulomb(0.5, 0.4));
    let effect = crate::effects::find(id).unwrap();
    let active = ActiveEffect::new(effect, values.to_vec()).unwrap();
    respond(&axis, &[active], &Excitation::cosine(omega, magnitude), 7).unwrap()
}

// The effects change the response by about a per cent, so that the change is proportional to the
// size of the effect up to a small term of second order.
#[test]
fn an_effect_of_half_the_size_changes_the_response_by_half() {
    let axis = plant(Actuator::Direct, Friction::coulomb(0.5, 0.4));
    let cases: [(&str, &[f64]); 6] = [
        ("flexible_mode", &[0.02, 0.8, 0.01]),
        ("backlash", &[0.02, 0.8, 0.02, 0.002]),
        ("presliding", &[1e4]),
        ("transport_delay", &[1e-3]),
        ("stribeck", &[1.04, 0.3]),
        ("quadratic_drag", &[0.02]),
    ];
    for (id, values) in cases {
        let effect = crate::effects::find(id).unwrap();
        let absent = |i: usize| match (id, i) {
            ("presliding", _) => Some(f64::INFINITY),
            ("transport_delay" | "quadratic_drag", _) => Some(0.0),
            ("stribeck", 0) => Some(1.0),
            _ => None,
        };
        let ranges: Vec<Range> = (0..values.len())
            .map(|i| Range { bounds: [0.0, 1.0], likely: [0.0, 1.0], absent: absent(i) })
            .collect();
        let mut halved = values.to_vec();
        (effect.search().resize)(&mut halved, &ranges, 0.5);
        // At this frequency and magnitude the axis never sticks.
        let base = respond(&axis, &[], &Excitation::cosine(20.0, 2.0), 7).unwrap();
        let whole = largest_difference(&with_effect(id, values, 20.0, 2.0), &base);
        let half = largest_difference(&with_effect(id, &halved, 20.0, 2.0), &base);
        assert!(whole > 0.0 && (half / whole - 0.5).abs() < 0.1, "{id}: {half:e} of {whole:e}");
    }
}

// At a reversal, presliding lasts √(2·Fc/(σ·v')). Where the axis rests, presliding delays breakaway
// by a time proportional to σ^(-2/3) and adds a travel proportional to 1/σ. So a hundred times the
// stiffness leaves between a tenth and a hundredth of the difference. At rest the axis oscillates
// hundreds of times on its bristles.
#[test]
fn presliding_approaches_set_valued_friction_as_its_bristles_stiffen() {
    for (omega, magnitude) in [(1.0, 1.1), (2.0, 2.0), (20.0, 2.0)] {
        let axis = plant(Actuator::Direct, Friction::coulomb(0.5, 0.4));
        let rigid = respond(&axis, &[], &Excitation::cosine(omega, magnitude), 7).unwrap();
        let [soft, stiff] = [3e3, 3e5].map(|sigma| {
            largest_difference(&with_effect("presliding", &[sigma], omega, magnitude), &rigid)
        });
        let ratio = soft / stiff;
        assert!((9.0..110.0).contains(&ratio), "ω {omega} m {magnitude}: {soft:e} {stiff:e}");
    }
}

// A phase φ of the input shifts the response in time: Yₖ becomes Yₖ·exp(jkφ). The limiter never
// follows its input here (rate·T/4 is a third of m or less), so that its output is a triangle.
// Simulations are required to be accurate to 1e-6 of the largest response (contract, section 3).
#[test]
fn a_triangle_behind_a_slew_limit_is_shifted_with_the_phase_of_the_input() {
    let axis = plant(Actuator::Direct, Friction::coulomb(0.5, 0.4));
    let limit = crate::effects::find("slew_limit").unwrap();
    let active = [ActiveEffect::new(limit, vec![10.0]).unwrap()];
    let omega = 5.0;
    let with_phase = |phase: f64| {
        let input = vec![Complex::ZERO, Complex::from_polar(10.0, phase)];
        respond(&axis, &active, &Excitation::new(omega, input), 7).unwrap()
    };
    let unshifted = with_phase(0.0);
    assert!(unshifted[1].norm() > 0.1, "the axis moves");
    for phase in [-2.5, -1.0, 1.0, 2.5, std::f64::consts::PI] {
        let expected: Vec<Complex> = unshifted
            .iter()
            .enumerate()
            .map(|(k, value)| value * Complex::from_polar(1.0, k as f64 * phase))
            .collect();
        let difference = largest_difference(&with_phase(phase), &expected);
        assert!(difference < 1e-6 * unshifted[1].norm(), "phase {phase}: {difference:e}");
    }
}

// The simulation with a ripple is integrated, with an error of a millionth of the response, which is a
// thousandth of the ripple; terms of second order are of the order of the ripple beside the friction,
// 0.2 %.
#[test]
fn a_small_torque_changes_the_response_as_the_simulation_with_it_says() {
    // Alike in both directions, so that a ripple, which forces the mean to zero, changes nothing else.
    let plant = plant(RESONANT, Friction::coulomb(0.5, 0.5));
    let multisine = Excitation::new(
        2.0,
        [0.0, 3.0, 1.0, 0.5].iter().map(|m| Complex::from_polar(*m, 4.0 * m)).collect(),
    );
    for excitation in [Excitation::cosine(3.0, 2.0), multisine] {
        let ripple = |amplitude: f64| {
            let ripple = crate::effects::find("cogging").unwrap();
            let active = ActiveEffect::new(ripple, vec![amplitude, 5.0, 0.7]).unwrap();
            respond(&plant, &[active], &excitation, 6).unwrap()
        };
        let size = 1e-3;
        let (with, without) = (ripple(size), ripple(0.0));
        let responses = TorqueResponses::new(&plant, &excitation, 6).unwrap();
        let torque = |_: f64, position: f64| (5.0 * position + 0.7).sin();
        let found = &responses.to(&[&torque], 400)[0];
        let expected: Vec<Complex> =
            with.iter().zip(&without).map(|(with, without)| (with - without) / size).collect();
        let largest = expected.iter().map(|change| change.norm()).fold(0.0, f64::max);
        let apart = largest_difference(found, &expected);
        assert!(apart < 0.02 * largest, "{apart:e} of {largest}");
    }
}
