//! Sums of exponentials Σₙ cₙ·exp(−jkφₙ) over few points, for all k.

use crate::measurement::Complex;

/// Points that are summed together. Each power of an exponential waits for the one before, but not
/// for those of other points.
const TOGETHER: usize = 4;

/// Adds Σₙ cₙ·exp(−jkφₙ), k = 0, 1 …, to each row of `sums`. The angles φₙ, in radians, are the
/// same for all rows; `coefficients` holds the cₙ of the first row, then those of the second, and
/// so on.
pub(crate) fn add(angles: &[f64], coefficients: &[f64], sums: &mut [Vec<Complex>]) {
    let orders = sums.iter().map(Vec::len).max().unwrap_or(0);
    for (n, some) in angles.chunks(TOGETHER).enumerate() {
        let first = n * TOGETHER;
        let mut turns = [Complex::ZERO; TOGETHER];
        for (turn, angle) in turns.iter_mut().zip(some) {
            *turn = Complex::from_polar(1.0, -angle);
        }
        let mut at = [Complex::ONE; TOGETHER];
        for k in 0..orders {
            for (sum, row) in sums.iter_mut().zip(coefficients.chunks(angles.len())) {
                if let Some(sum) = sum.get_mut(k) {
                    let row = &row[first..first + some.len()];
                    *sum += row.iter().zip(&at).map(|(value, at)| at * *value).sum::<Complex>();
                }
            }
            at.iter_mut().zip(&turns).for_each(|(at, turn)| *at *= turn);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sums_are_those_of_the_points_one_by_one() {
        let angles: Vec<f64> = (0..7).map(|n| f64::from(n) * 0.9).collect();
        let coefficients: Vec<f64> = (0..14).map(|n| f64::from(n).sin()).collect();
        let mut sums = [vec![Complex::ONE; 40], vec![Complex::ZERO; 30]];
        add(&angles, &coefficients, &mut sums);
        for ((row, sum), before) in sums.iter().enumerate().zip([Complex::ONE, Complex::ZERO]) {
            for (k, found) in sum.iter().enumerate() {
                let term = |(n, angle): (usize, &f64)| {
                    Complex::from_polar(1.0, -(k as f64) * angle) * coefficients[7 * row + n]
                };
                let expected = before + angles.iter().enumerate().map(term).sum::<Complex>();
                // Seven points of size up to 1, and 40 roundings of each power.
                assert!((found - expected).norm() < 1e-13, "{row} {k}: {found} {expected}");
            }
        }
    }
}
