//! The response of axes with effects.

use super::*;
use crate::effects::Range;

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
