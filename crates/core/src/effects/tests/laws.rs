//! Derivatives and Taylor series of the laws agree with their values.

use super::*;

#[test]
fn derivatives_of_every_law_are_those_of_its_values() {
    let base = plant().map(Wide::constant);
    for effect in ALL {
        let values: Vec<f64> =
            (0..effect.parameters().len()).map(|i| 0.6 + 0.2 * i as f64).collect();
        let active = ActiveEffect::new(*effect, values.clone()).unwrap();
        let axis = enter(base, &[active], 0.5, 0);
        let at = |values: &[f64], v: f64, x: f64| -> Option<f64> {
            let active = ActiveEffect::new(*effect, values.to_vec()).unwrap();
            let axis = enter_values(plant(), &[active], 0.5);
            let law = axis.friction_curve.or(axis.torques.first().copied())?;
            Some(law.at(v, x))
        };
        let Some(law) = axis.friction_curve.or(axis.torques.first().copied()) else { continue };
        let lanes = values.len();
        let (v, x) = (0.3, -0.7);
        let exact = law.at(Wide::variable(v, lanes), Wide::variable(x, lanes + 1));
        let h = 1e-5;
        let numeric = |lane: usize| {
            let shifted = |sign: f64| {
                let mut values = values.clone();
                if lane < lanes {
                    values[lane] += sign * h;
                }
                let step = |l: usize| if lane == l { sign * h } else { 0.0 };
                at(&values, v + step(lanes), x + step(lanes + 1)).unwrap()
            };
            (shifted(1.0) - shifted(-1.0)) / (2.0 * h)
        };
        for lane in 0..lanes + 2 {
            // Error of a central difference: h² times the third derivative.
            let error = (exact.lane(lane) - numeric(lane)).abs();
            assert!(error < 1e-8, "{} lane {lane}: {error:e}", effect.id());
        }
    }
}

#[test]
fn the_taylor_series_of_a_law_sums_to_the_law_along_the_motion() {
    type Number = crate::plant::Dual<4>;
    let mut tried = 0;
    for effect in ALL {
        let ranges = effect.parameters().iter().map(|p| (p.range)(&scope()));
        let values: Vec<f64> = ranges.map(|r| 0.7 * r.likely[0] + 0.3 * r.likely[1]).collect();
        let active = ActiveEffect::new(*effect, values).unwrap();
        for law in enter_values(plant(), &[active], 0.0).torques {
            if !law.form().has_series() {
                continue;
            }
            tried += 1;
            let lane = std::cell::Cell::new(0);
            let law =
                law.map(|parameter| Number::variable(parameter, lane.replace(lane.get() + 1)));
            // x = 0.3 + 0.02·t − 0.01·t². Lane 3 is the derivative by the initial value 0.3.
            let x = [Number::variable(0.3, 3), Number::constant(0.02), Number::constant(-0.01)];
            let term = |m: usize| x.get(m).copied().unwrap_or(Number::constant(0.0));
            let (mut series, mut sum) = (TaylorSeries::new(true), Number::constant(0.0));
            series.direction = 1.0;
            let t = 0.8_f64;
            for m in 0..MOST_TERMS {
                let value = law.term(&mut series, term(m).value(), m);
                sum += (law.term_derivative(&series, term, m) + value) * t.powi(m as i32);
            }
            let there = x[0] + x[1] * t + x[2] * (t * t);
            let exact = law.at(there, there);
            let size = 1.0 + exact.value().abs();
            // The first omitted term of a ripple is of order (N·0.01)¹³; N is 26 here.
            let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * size.max(b.abs());
            assert!(close(sum.value(), exact.value()), "{}: {sum:?} {exact:?}", effect.id());
            for lane in 0..4 {
                assert!(close(sum.lane(lane), exact.lane(lane)), "{} {lane}", effect.id());
            }
        }
    }
    assert_eq!(tried, 3);
}
