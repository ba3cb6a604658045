//! Derivatives of the response agree with the differences of simulations.

use super::*;

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
