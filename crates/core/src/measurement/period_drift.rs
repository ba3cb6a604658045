//! Tests a stated period against the whole record: a wrong period shifts the signal a little more
//! with every period.
//!
//! The change d(n) = x(n + mL) − x(n) is computed over the largest number of periods m that leaves
//! enough of the record to compare, with L once the stated period and once the best period near
//! it. Let D and D' be the sums of d² for the two, each after the least-squares parabola is removed
//! from d: a drifting mean is not a wrong period.
//!
//! If the stated period is right, D is noise alone and so is the least D' that can occur, but of
//! other pairs of samples. With ν independent samples each, D'/D is compared with an F distribution
//! of (ν, ν) degrees of freedom. That is on the safe side: the squares of the samples are in both
//! sums, which makes the variance of ln(D'/D) 2/ν instead of 4/ν.

use nalgebra::{Matrix3, Vector3};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::period;

/// Largest relative error of the stated period that is searched for. Larger errors change a smooth
/// signal from one period to the next by more than the module `repetition` accepts.
const SEARCHED: f64 = 0.06;

/// Probability with which noise contradicts a right period by the one next best. Of about a hundred
/// distinct periods that are searched, one does so with a probability of 1e-5.
const FALSE_ALARM: f64 = 1e-7;

/// Smallest shift over all m periods, in samples, that contradicts a period. The edges of a square
/// wave are known to half a sample, so two of them can be off by one in the best of records.
const SMALLEST_SHIFT: f64 = 1.0;

/// Fewest compared samples.
const FEWEST_COMPARED: usize = 32;

/// Smallest share of the record that is compared, if it has several periods. With m periods
/// between them, the error of the period is least if the two stretches are a third of the record.
const COMPARED_SHARE: f64 = 1.0 / 3.0;

/// Fewest independent samples assumed of what remains. It only matters for remainders as smooth as
/// the signal: D'/D must then be below 0.005.
const FEWEST_INDEPENDENT: f64 = 8.0;

/// Highest lag of the autocorrelation from which the independent samples are counted.
const HIGHEST_LAG: usize = 2000;

/// The period that the signal shows near the `stated` one, in samples; `None` if it does not
/// contradict the stated one, or is too short to tell.
pub(super) fn contradicting(signal: &[f64], stated: f64) -> Option<f64> {
    let count = signal.len() as f64;
    let room = count - stated - (FEWEST_COMPARED + 2 * period::INTERPOLATION_REACH) as f64;
    if room < 0.0 {
        return None;
    }
    let compared = stated.max(COMPARED_SHARE * count);
    let periods = ((count - compared) / stated).floor().max(1.0);
    let found = period::find_near(signal, stated, SEARCHED, periods)?;
    if periods * (found - stated).abs() <= SMALLEST_SHIFT {
        return None;
    }
    let lags = [periods * stated, periods * found];
    let [before, after] = period::changes(signal, lags).map(|changes| without_parabola(&changes));
    if before.len() < FEWEST_COMPARED {
        return None;
    }
    let sum = |values: &[f64]| values.iter().map(|d| d * d).sum::<f64>();
    let ratio = sum(&after) / sum(&before);
    let by_chance = |independent: f64| {
        let freedom = independent.max(FEWEST_INDEPENDENT);
        FisherSnedecor::new(freedom, freedom).map_or(1.0, |chance| chance.cdf(ratio))
    };
    // Most records are decided without the count of independent samples.
    let contradicted = ratio < 1.0
        && by_chance(after.len() as f64) < FALSE_ALARM
        && by_chance(after.len() as f64 / correlation_time(&after)) < FALSE_ALARM;
    contradicted.then_some(found)
}

/// Values less their least-squares parabola.
fn without_parabola(values: &[f64]) -> Vec<f64> {
    let place = |n: usize| 2.0 * n as f64 / (values.len() - 1).max(1) as f64 - 1.0;
    let basis = |n: usize| Vector3::new(1.0, place(n), 1.5 * place(n).powi(2) - 0.5);
    let (mut normal, mut moments) = (Matrix3::zeros(), Vector3::zeros());
    for (n, value) in values.iter().enumerate() {
        normal += basis(n) * basis(n).transpose();
        moments += basis(n) * *value;
    }
    let solved = normal.lu().solve(&moments).unwrap_or_else(Vector3::zeros);
    values.iter().enumerate().map(|(n, value)| value - basis(n).dot(&solved)).collect()
}

/// Samples per independent sample, 1 + 4·Σρ(h)² over the lags h of the autocorrelation ρ.
///
/// The correlation of noise with a signal that has the autocorrelation ρₓ has the variance of
/// 1 + 2·Σρ·ρₓ independent samples (M. Bartlett, J. R. Stat. Soc. 98, 1935). The sum here is at
/// least as large if the noise has its resonance on a line of the signal, the worst case, and for
/// noise of first order.
fn correlation_time(values: &[f64]) -> f64 {
    if values.iter().all(|x| *x == 0.0) {
        return 1.0;
    }
    let products = period::products(values);
    let highest = (values.len() / 4).min(HIGHEST_LAG);
    let squares = products[1..=highest].iter().map(|product| (product.re / products[0].re).powi(2));
    1.0 + 4.0 * squares.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const TAU: f64 = std::f64::consts::TAU;

    fn sine(angle: f64) -> f64 {
        2.0 * angle.cos()
    }

    fn multisine(angle: f64) -> f64 {
        1.5 * angle.cos() + 0.8 * (3.0 * angle + 1.0).cos() + 0.5 * (7.0 * angle + 2.0).cos()
    }

    fn square(angle: f64) -> f64 {
        (angle + 0.3).sin().signum()
    }

    fn record(wave: fn(f64) -> f64, period: f64, count: usize, noise: &[f64]) -> Vec<f64> {
        (0..count)
            .map(|n| wave(TAU * n as f64 / period) + noise.get(n).copied().unwrap_or(0.0))
            .collect()
    }

    /// x(n) = a·x(n−1) + b·x(n−2) + level·w(n), with w white.
    fn noise(level: f64, [a, b]: [f64; 2], count: usize, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let (mut last, mut before) = (0.0, 0.0);
        (0..count + 1000)
            .map(|_| {
                let white: f64 = StandardNormal.sample(&mut rng);
                let next = a * last + b * before + level * white;
                (last, before) = (next, last);
                next
            })
            .skip(1000)
            .collect()
    }

    #[test]
    fn a_period_wrong_by_half_a_percent_to_two_percent_is_contradicted_by_the_right_one() {
        for wave in [sine, multisine] {
            for level in [0.0, 1e-3, 0.1] {
                let signal = record(wave, 200.0, 3600, &noise(level, [0.0; 2], 3600, 1));
                for share in [0.98, 0.99, 0.995, 1.005, 1.01, 1.02] {
                    let found = contradicting(&signal, share * 200.0).unwrap();
                    assert!((found / 200.0 - 1.0).abs() < 3e-4, "{found} {share} {level}");
                }
            }
        }
    }

    #[test]
    fn two_periods_are_enough_where_the_noise_is_small() {
        for wave in [sine, multisine] {
            let signal = record(wave, 200.0, 400, &noise(5e-3, [0.0; 2], 400, 2));
            for share in [0.985, 1.015] {
                assert!(contradicting(&signal, share * 200.0).is_some(), "{share}");
            }
        }
    }

    // 600 records, each with a chance of 1e-5.
    #[test]
    fn a_right_period_is_not_contradicted_by_noise_of_any_colour() {
        // White; of first order; the resonance of a loop at harmonic 3 (angle 3·2π/200, radius
        // 0.98).
        let resonant = [2.0 * 0.98 * (3.0 * TAU / 200.0).cos(), -0.98 * 0.98];
        for (level, colour) in [(0.3, [0.0; 2]), (0.1, [0.95, 0.0]), (0.02, resonant)] {
            for seed in 0..50 {
                for (count, wave) in [
                    (400, sine as fn(f64) -> f64),
                    (700, multisine),
                    (2500, sine),
                    (2500, multisine),
                ] {
                    let signal = record(wave, 200.0, count, &noise(level, colour, count, seed));
                    let found = contradicting(&signal, 200.0);
                    assert_eq!(found, None, "{count} {colour:?} {seed}");
                }
            }
        }
    }

    #[test]
    fn a_mean_that_wanders_is_not_a_wrong_period() {
        for seed in 0..50 {
            // A random walk that is as large as the signal after ten periods.
            let walk = noise(0.02, [1.0, 0.0], 2500, seed);
            for wave in [sine, multisine] {
                let signal = record(wave, 200.0, 2500, &walk);
                assert_eq!(contradicting(&signal, 200.0), None, "{seed}");
            }
        }
    }

    #[test]
    fn a_first_period_that_settles_is_not_a_wrong_period() {
        for time in [10.0, 40.0, 150.0, 400.0] {
            let settling: Vec<f64> = (0..1000).map(|n| (-f64::from(n) / time).exp()).collect();
            for (count, wave) in
                [(400, sine as fn(f64) -> f64), (400, multisine), (1000, sine), (1000, multisine)]
            {
                let signal = record(wave, 200.0, count, &settling);
                assert_eq!(contradicting(&signal, 200.0), None, "{time} {count}");
            }
        }
    }

    #[test]
    fn edges_between_samples_are_not_a_wrong_period() {
        for period in [62.37, 40.5, 101.71, 199.99] {
            for count in [130, 250, 900] {
                let signal = record(square, period, count, &[]);
                assert_eq!(contradicting(&signal, period), None, "{period} {count}");
            }
        }
    }
}
