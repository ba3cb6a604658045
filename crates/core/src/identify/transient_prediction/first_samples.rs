//! Extrapolates the first samples of a signal to the very first one.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Probability with which noise alone makes a parabola out of a line.
const FALSE_CURVATURE: f64 = 0.01;

/// Fewest samples to which a parabola is fitted.
const FEWEST_FOR_PARABOLA: usize = 8;

/// The value (`derivative` 0) or the slope per step (`derivative` 1) of a signal at its first
/// sample, with its standard error, from a line through equally spaced `values`, or from a parabola
/// where an F test finds them curved.
///
/// The standard error is always that of the parabola, if there is one: a curvature too small to be
/// found would shift the line's end by no more.
pub(super) fn at_first(values: &[f64], derivative: usize) -> [f64; 2] {
    let line = fitted(values, 1, derivative);
    if values.len() < FEWEST_FOR_PARABOLA {
        return [line.value, line.std];
    }
    let parabola = fitted(values, 2, derivative);
    let freedom = (values.len() - 3) as f64;
    let ratio = freedom * (line.squares / parabola.squares - 1.0);
    let chance = FisherSnedecor::new(1.0, freedom).map_or(1.0, |chance| chance.sf(ratio.max(0.0)));
    let is_curved = ratio.is_finite() && chance < FALSE_CURVATURE;
    [if is_curved { parabola.value } else { line.value }, parabola.std]
}

/// A polynomial's value or slope at the first sample.
struct Fitted {
    value: f64,
    std: f64,
    /// Sum of the squared residuals.
    squares: f64,
}

fn fitted(values: &[f64], degree: usize, derivative: usize) -> Fitted {
    // Places from 0 to 1 keep the normal matrix regular.
    let span = (values.len() - 1).max(1) as f64;
    let basis = DMatrix::from_fn(values.len(), degree + 1, |n, power| {
        (n as f64 / span).powi(i32::try_from(power).unwrap_or(i32::MAX))
    });
    let measured = DVector::from_column_slice(values);
    let inverse = (basis.transpose() * &basis).try_inverse();
    let inverse = inverse.unwrap_or_else(|| DMatrix::zeros(degree + 1, degree + 1));
    let solved = &inverse * basis.transpose() * &measured;
    let squares = (measured - basis * &solved).norm_squared();
    let freedom = values.len().saturating_sub(degree + 1).max(1) as f64;
    let scale = if derivative == 0 { 1.0 } else { 1.0 / span };
    Fitted {
        value: scale * solved[derivative],
        std: scale * (inverse[(derivative, derivative)] * squares / freedom).sqrt(),
        squares,
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// 1 + 0.02·n + curvature·n², with noise of standard deviation 0.01.
    fn samples(curvature: f64, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut noise = || 0.01 * Distribution::<f64>::sample(&StandardNormal, &mut rng);
        (0..50).map(f64::from).map(|n| 1.0 + 0.02 * n + curvature * n * n + noise()).collect()
    }

    // Five standard errors are exceeded with a probability of 6e-7 by the parabola. A curvature too
    // small to be found adds up to three.
    #[test]
    fn lines_and_parabolas_are_extrapolated_to_the_first_sample_within_their_error() {
        for seed in 0..200 {
            for curvature in [0.0, 1e-5, 1e-4, 1e-3] {
                let values = samples(curvature, seed);
                let [value, std] = at_first(&values, 0);
                // s·√(9/50): 0.0042.
                assert!((value - 1.0).abs() < 5.0 * std && (std - 0.0042).abs() < 0.0015);
                let [slope, std] = at_first(&values, 1);
                assert!((slope - 0.02).abs() < 5.0 * std, "{slope} {std} {curvature}");
            }
        }
    }

    #[test]
    fn few_or_constant_samples_have_a_first_value() {
        assert_eq!(at_first(&[2.0; 4], 0).map(|x| (1e9 * x).round()), [2e9, 0.0]);
        assert!((at_first(&[1.0, 2.0, 3.0, 4.0], 1)[0] - 1.0).abs() < 1e-12);
    }
}
