//! Pools variances, or shrinks them towards a law or a trend by empirical Bayes (Smyth 2004,
//! doi:10.2202/1544-6115.1027).

mod cell;
mod prior_dof;
mod trend;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::variance_law::{SumOfSquares, VarianceLaw};
pub(super) use cell::Cell;
use cell::pooled;
use prior_dof::prior_dof;
use trend::trend;

/// Variances below this share of the largest one are rounding, and are raised to it.
const ROUNDING_SHARE: f64 = 1e-16;

/// Significance level of the test that all variances are equal.
const EQUALITY_LEVEL: f64 = 0.01;

/// The law that the variances of a table follow. `None` if they may all be equal, if they come from
/// records, or if the trend over magnitudes, harmonics and experiments describes them better.
pub(super) fn law_of(rows: &[Vec<Cell>]) -> Option<VarianceLaw> {
    let flat = raised(rows);
    if flat.iter().any(|cell| cell.from_record) || equal(&flat, pooled(&flat)?) {
        return None;
    }
    let law = VarianceLaw::fit(&sums_of_squares(rows))?;
    let describes = |prior: &[f64]| prior_dof(&flat, prior);
    (describes(&by_law(&flat, law)) >= describes(&trend(rows, &flat))).then_some(law)
}

/// The law of a table's variances as far as one describes them: that of [`law_of`], or one of
/// noise of one size where the variances may all be equal.
pub(super) fn describing_law(rows: &[Vec<Cell>]) -> Option<VarianceLaw> {
    let flat = raised(rows);
    let variance = pooled(&flat)?;
    match equal(&flat, variance) && !flat.iter().any(|cell| cell.from_record) {
        true => Some(VarianceLaw { additive: variance, proportional: 0.0 }),
        false => law_of(rows),
    }
}

/// The variances as sums of squares.
pub(super) fn sums_of_squares(rows: &[Vec<Cell>]) -> Vec<SumOfSquares> {
    let of = |cell: &Cell| SumOfSquares {
        sum: cell.dof * cell.variance,
        dof: cell.dof,
        additive: 1.0,
        proportional: cell.size * cell.size,
    };
    rows.iter().flatten().map(of).collect()
}

/// Variances for weighting: a residual squared over one of these has mean 1. Rows and result are in
/// the same arrangement, one row for each experiment. With a law, see [`law_of`], they are shrunk
/// towards it.
pub(super) fn weighting_variances(rows: &[Vec<Cell>], law: Option<VarianceLaw>) -> Vec<Vec<f64>> {
    // For a variance s² with ν degrees of freedom, the mean of 1/s² is ν/(ν − 2) times 1/σ².
    shrink(rows, law, |variance, dof| variance * if dof > 4.0 { dof / (dof - 2.0) } else { 2.0 })
}

/// The variances themselves, shrunk but not corrected for weighting, in the same arrangement.
pub(super) fn shrunk_variances(rows: &[Vec<Cell>], law: Option<VarianceLaw>) -> Vec<Vec<f64>> {
    shrink(rows, law, |variance, _| variance)
}

/// The cells in one list, without variances of 0.
fn raised(rows: &[Vec<Cell>]) -> Vec<Cell> {
    let largest = rows.iter().flatten().map(|cell| cell.variance).fold(0.0, f64::max);
    let floor = (largest * ROUNDING_SHARE).max(f64::MIN_POSITIVE);
    let raised = |cell: &Cell| Cell { variance: cell.variance.max(floor), ..*cell };
    rows.iter().flatten().map(raised).collect()
}

fn by_law(cells: &[Cell], law: VarianceLaw) -> Vec<f64> {
    let largest = cells.iter().map(|cell| cell.size).fold(0.0, f64::max);
    cells.iter().map(|cell| law.std(cell.size, largest).powi(2)).collect()
}

/// Pooled variances where they may all be equal; else `answer` of each shrunk variance and its
/// degrees of freedom.
fn shrink(
    rows: &[Vec<Cell>],
    law: Option<VarianceLaw>,
    answer: impl Fn(f64, f64) -> f64,
) -> Vec<Vec<f64>> {
    let flat = raised(rows);
    let prior = match (law, pooled(&flat)) {
        (Some(law), _) => by_law(&flat, law),
        (None, Some(variance)) if equal(&flat, variance) => vec![variance; flat.len()],
        (None, Some(_)) => trend(rows, &flat),
        (None, None) => vec![f64::MIN_POSITIVE; flat.len()],
    };
    let prior_dof = prior_dof(&flat, &prior);
    let mut moderated = flat.iter().zip(&prior).map(|(cell, prior)| {
        if prior_dof.is_infinite() {
            return *prior;
        }
        let dof = prior_dof + cell.dof;
        answer((prior_dof * prior + cell.dof * cell.variance) / dof, dof)
    });
    rows.iter().map(|row| moderated.by_ref().take(row.len()).collect()).collect()
}

/// Bartlett's test (1937, doi:10.1098/rspa.1937.0109) that all variances are equal.
fn equal(cells: &[Cell], pooled: f64) -> bool {
    let estimated: Vec<&Cell> = cells.iter().filter(|cell| cell.dof > 0.0).collect();
    let groups = estimated.len() as f64;
    if groups < 2.0 {
        return true;
    }
    let dof: f64 = estimated.iter().map(|cell| cell.dof).sum();
    let spread: f64 = estimated.iter().map(|cell| cell.dof * (pooled / cell.variance).ln()).sum();
    let reciprocal: f64 = estimated.iter().map(|cell| 1.0 / cell.dof).sum();
    let correction = 1.0 + (reciprocal - 1.0 / dof) / (3.0 * (groups - 1.0));
    ChiSquared::new(groups - 1.0).is_ok_and(|chi2| chi2.sf(spread / correction) > EQUALITY_LEVEL)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{ChiSquared as ChiSquaredSampler, Distribution};

    fn cells(
        sigma: impl Fn(usize, usize) -> f64,
        repeats: f64,
        from_record: bool,
    ) -> Vec<Vec<Cell>> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let dof = 2.0 * (repeats - 1.0);
        let chi2 = ChiSquaredSampler::new(dof).unwrap();
        let mut cell = |experiment: usize, order: usize| Cell {
            experiment,
            order,
            magnitude: (experiment % 3) as f64,
            size: size(experiment, order),
            from_record,
            by_input: 0.0,
            variance: sigma(experiment, order).powi(2) * chi2.sample(&mut rng) / dof,
            dof,
        };
        let harmonics = if from_record { 200 } else { 8 };
        let experiments = if from_record { 1 } else { 48 };
        (0..experiments).map(|e| (0..harmonics).map(|k| cell(e, k)).collect()).collect()
    }

    /// |Y|, spread over two decades without regard to magnitude or harmonic.
    fn size(experiment: usize, order: usize) -> f64 {
        0.01 * 10.0_f64.powf(((7 * experiment + 3 * order) % 20) as f64 / 10.0)
    }

    fn moderated(rows: &[Vec<Cell>]) -> Vec<Vec<f64>> {
        weighting_variances(rows, law_of(rows))
    }

    #[test]
    fn equal_variances_are_pooled_into_one() {
        let moderated = moderated(&cells(|_, _| 0.3, 6.0, false));
        let first = moderated[0][0];
        assert!(moderated.iter().flatten().all(|v| *v == first));
        // 48·8·10 degrees of freedom: the relative standard deviation is √(2/3840) = 2.3 %.
        assert!((first / 0.09 - 1.0).abs() < 0.07, "{first}");
    }

    #[test]
    fn a_noise_that_depends_on_magnitude_and_harmonic_is_followed() {
        let sigma = |e: usize, k: usize| 0.1 * (1.0 + (e % 3) as f64) / (1.0 + k as f64);
        let rows = cells(sigma, 6.0, false);
        assert_eq!(law_of(&rows), None);
        let moderated = moderated(&rows);
        for (e, row) in moderated.iter().enumerate() {
            for (k, variance) in row.iter().enumerate() {
                let ratio = variance / sigma(e, k).powi(2);
                // Each effect is the mean of at least 8 cells with 10 degrees of freedom, so ln σ²
                // has a standard deviation of about √(2/80) = 0.16; allow three.
                assert!((0.4..2.2).contains(&ratio), "{e} {k}: {ratio}");
            }
        }
    }

    // Each part is found from some 200 of 384 cells with 4 degrees of freedom: a relative standard
    // deviation of its square of √(2/800) = 5 %, more where both matter. 20 % are four of 5 %.
    #[test]
    fn noise_in_proportion_to_the_response_is_followed_from_few_repeats() {
        let sigma = |e: usize, k: usize| 0.01_f64.hypot(0.1 * size(e, k));
        let rows = cells(sigma, 3.0, false);
        assert!(law_of(&rows).is_some());
        for (e, row) in moderated(&rows).iter().enumerate() {
            for (k, variance) in row.iter().enumerate() {
                let ratio = variance / sigma(e, k).powi(2);
                assert!((0.8..1.2).contains(&ratio), "{e} {k}: {ratio}");
            }
        }
    }

    #[test]
    fn the_noise_of_a_record_is_followed_along_frequency() {
        let sigma = |_: usize, k: usize| 1.0 + 10.0 * (-(k as f64) / 40.0).exp();
        let moderated = moderated(&cells(sigma, 3.0, true));
        for (k, variance) in moderated[0].iter().enumerate().skip(10).take(180) {
            let ratio = variance / sigma(0, k).powi(2);
            // 60 degrees of freedom give 18 %, plus the slope over the neighbourhood.
            assert!((0.4..1.9).contains(&ratio), "{k}: {ratio}");
        }
    }

    // Some 66 degrees of freedom tell the rest to 17 %: three of that.
    #[test]
    fn what_noise_of_the_input_makes_of_a_record_is_not_smoothed_along_frequency() {
        let by_input = |k: usize| (1.0 + k as f64).powi(-4);
        let variance = |k: usize| by_input(k) + 1e-4;
        let mut rows = cells(|_, k| variance(k).sqrt(), 4.0, true);
        rows[0].iter_mut().enumerate().for_each(|(k, cell)| cell.by_input = by_input(k));
        for (k, found) in moderated(&rows)[0].iter().enumerate() {
            let ratio = found / variance(k);
            assert!((0.6..1.6).contains(&ratio), "{k}: {ratio}");
        }
    }
}
