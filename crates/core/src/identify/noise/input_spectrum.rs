//! The noise of an input that is measured, line by line.

use crate::measurement::Experiment;

/// Lines of the input on either side that count for the variance of one: 60 degrees of freedom where
/// there are three periods.
const NEIGHBOURS: usize = 8;
/// Fewest lines whose variances may show a slope.
const FEWEST_FOR_SLOPE: usize = 5;
/// Standard errors by which a slope must differ from none: noise alone does so once in a hundred times,
/// with 17 lines.
const STEEPEST: f64 = 3.0;

/// Variance of re and of im of each line of the input in a single repeat, in scale, from the lines
/// around. The mean may drift, so that it is at least what it shows itself. `None` if the variance rises
/// or falls along the lowest lines: a controller that feeds noise of the response back makes it do so,
/// and the lines around tell nothing of the lowest one then.
pub(super) fn input_variances(experiment: &Experiment, scale: f64) -> Option<Vec<f64>> {
    let freedom = experiment.repeats.len().checked_sub(1).filter(|freedom| *freedom > 0)? as f64;
    let lines = experiment.input.len();
    let own = |k: usize| {
        let squares = experiment.repeats.iter().filter_map(|repeat| repeat.input.get(k));
        squares.map(|u| u.norm_sqr()).sum::<f64>() / (scale * scale * freedom)
    };
    let own: Vec<f64> = (0..lines).map(own).collect();
    if has_slope(own.get(1..lines.min(2 * NEIGHBOURS + 2))?) {
        return None;
    }
    let around = |k: usize| {
        let near = &own
            [k.saturating_sub(NEIGHBOURS).max(1).min(lines - 1)..(k + NEIGHBOURS + 1).min(lines)];
        near.iter().sum::<f64>() / (2.0 * near.len() as f64)
    };
    Some((0..lines).map(|k| if k == 0 { own[0].max(0.5 * around(1)) } else { around(k) }).collect())
}

/// Whether variances rise or fall with a power of their place, by a t test of the slope of a straight line
/// through their logarithms.
fn has_slope(variances: &[f64]) -> bool {
    let count = variances.len() as f64;
    if variances.len() < FEWEST_FOR_SLOPE || variances.iter().any(|variance| *variance <= 0.0) {
        return false;
    }
    let points = variances.iter().enumerate().map(|(i, v)| [(1.0 + i as f64).ln(), v.ln()]);
    let points: Vec<[f64; 2]> = points.collect();
    let mean = |of: usize| points.iter().map(|point| point[of]).sum::<f64>() / count;
    let means = [mean(0), mean(1)];
    let product = |a: usize, b: usize| -> f64 {
        points.iter().map(|point| (point[a] - means[a]) * (point[b] - means[b])).sum()
    };
    let slope = product(0, 1) / product(0, 0);
    let scatter = (product(1, 1) - slope * product(0, 1)).max(0.0) / (count - 2.0);
    slope.abs() > STEEPEST * (scatter / product(0, 0)).sqrt()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::identify::fixtures::{ACTUATORS, axis, multisine};
    use crate::measurement::{Complex, Repeat};

    /// Four repeats of an input of 30 lines with these standard deviations.
    fn repeated(std: impl Fn(usize) -> f64) -> Experiment {
        let mut experiment = multisine(&axis(ACTUATORS[0])).experiments()[0].clone();
        let rng = &mut ChaCha8Rng::seed_from_u64(6);
        let mut normal = || Distribution::<f64>::sample(&StandardNormal, rng);
        let mut line = |k: usize| match k {
            0 => Complex::new(std(0) * normal(), 0.0),
            _ => std(k) * Complex::new(normal(), normal()),
        };
        let lines = experiment.input.len();
        let mut repeats: Vec<Vec<Complex>> =
            (0..4).map(|_| (0..lines).map(&mut line).collect()).collect();
        for k in 0..lines {
            let mean: Complex = repeats.iter().map(|repeat| repeat[k]).sum::<Complex>() / 4.0;
            repeats.iter_mut().for_each(|repeat| repeat[k] -= mean);
        }
        let of = |input| Repeat { input, response: Vec::new() };
        experiment.repeats = repeats.into_iter().map(of).collect();
        experiment
    }

    // Nine lines of 6 degrees of freedom tell a variance to 19 %, 17 to 14 %. Three of that.
    #[test]
    fn noise_that_is_flat_is_smoothed_over_its_neighbours_and_the_mean_may_drift() {
        let found = input_variances(&repeated(|k| if k == 0 { 2.0 } else { 0.1 }), 1.0).unwrap();
        assert!(found[0] > 0.5, "{}", found[0]);
        for variance in &found[1..] {
            assert!((variance / 0.01 - 1.0).abs() < 0.57, "{variance}");
        }
        let still = input_variances(&repeated(|k| if k == 0 { 0.0 } else { 0.1 }), 1.0).unwrap();
        assert!((still[0] / still[1] - 0.5).abs() < 1e-12);
    }

    #[test]
    fn noise_that_rises_with_the_frequency_has_no_variances() {
        assert!(input_variances(&repeated(|k| 0.01 * k as f64), 1.0).is_none());
    }
}
