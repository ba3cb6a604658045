//! The error rates of the residual tests on noise.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::*;
use crate::diagnose::residuals::regions::Regions;
use crate::diagnose::residuals::residual::Residuals;
use crate::diagnose::residuals::statistics;
use crate::diagnose::residuals::whiteness::{Judgement, Nulls};

fn residuals(measurement: &Measurement) -> Residuals {
    Residuals::of(&crate::identify::fit_base(measurement, &request(), &Silent).unwrap())
}

// Each of 150 measurements is fitted anew; only the null distributions are linearized. The standard
// deviation of a share of 5 % is 1.8 %, of one of 50 % 4.1 %; four of those are allowed.
#[test]
fn p_values_are_uniform_however_the_noise_is_stated() {
    let exact = exact();
    for statement in [
        NoiseStatement::Std,
        NoiseStatement::Repeats(2),
        NoiseStatement::Repeats(6),
        NoiseStatement::Silent,
    ] {
        let first = residuals(&noisy(&exact, statement, 1));
        let regions = Regions::new(&first.layout, &first.freedom);
        let statistics = statistics::all(&first, &regions);
        let nulls = Nulls::draw(&first, &statistics, 1, &Silent);
        let judgements: Vec<Judgement> = (100..250)
            .into_par_iter()
            .map(|seed| {
                nulls.judge(&statistics, &residuals(&noisy(&exact, statement, seed)).values)
            })
            .collect();
        let mut p_values: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
        for test in judgements.iter().flat_map(|judgement| &judgement.tests) {
            p_values.entry(&test.name).or_default().extend(test.p_value);
        }
        let untested = p_values.iter().filter(|(_, values)| values.is_empty()).count();
        assert_eq!(untested, usize::from(statement == NoiseStatement::Silent));
        for (name, values) in p_values.iter().filter(|(_, values)| !values.is_empty()) {
            let share = |level: f64| {
                values.iter().filter(|p| **p < level).count() as f64 / values.len() as f64
            };
            let (few, half) = (share(0.05), share(0.5));
            assert!(few < 0.05 + 4.0 * 0.018, "{statement:?} {name}: {few} below 0.05");
            assert!((half - 0.5).abs() < 4.0 * 0.041, "{statement:?} {name}: {half} below 0.5");
        }
        // 0.75 are expected; more than 5 have a probability of 0.01 %.
        let wrong = judgements.iter().filter(|judgement| !judgement.noise_like).count();
        assert!(wrong <= 5, "{statement:?}: {wrong} of 150 called wrong");
    }
}

// At a level of 0.5 %, 5 of 1000 are expected, with a standard deviation of 2.2. The limit itself
// is estimated from 10 of 2000 draws, so the level is known to a third.
#[test]
fn white_residuals_fail_at_the_family_wise_error_rate() {
    let residuals = residuals(&noisy(&exact(), NoiseStatement::Std, 1));
    let regions = Regions::new(&residuals.layout, &residuals.freedom);
    let statistics = statistics::all(&residuals, &regions);
    let nulls = Nulls::draw(&residuals, &statistics, 1, &Silent);
    let failed = (0..1000)
        .into_par_iter()
        .filter(|seed| {
            let mut rng = ChaCha8Rng::seed_from_u64(10_000 + seed);
            let left = residuals.left_of(&residuals.law.draw(&mut rng));
            !nulls.judge(&statistics, &left).noise_like
        })
        .count();
    assert!((1..=15).contains(&failed), "{failed} of 1000");
}

// Three times the noise in all rows is far beyond 1e-12; 1.05 times as much, a p-value of some 2 %, is
// not, and noise itself never is.
#[test]
fn a_few_draws_say_only_of_what_is_far_from_noise_that_it_is_none() {
    let mut residuals = residuals(&noisy(&exact(), NoiseStatement::Std, 1));
    let noise = residuals.values.clone();
    let mut is_certain = |factor: f64| {
        residuals.values = &noise * factor;
        let regions = Regions::new(&residuals.layout, &residuals.freedom);
        let statistics = statistics::all(&residuals, &regions);
        Nulls::draw_unless_certain(&residuals, &statistics, 1, &Silent).is_none()
    };
    assert_eq!([1.0, 1.05, 3.0].map(&mut is_certain), [false, false, true]);
}
