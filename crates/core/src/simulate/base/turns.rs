//! Sums over the switching times of a motion.

use std::f64::consts::TAU;

use crate::measurement::Complex;

/// Switching times that are summed side by side: each power of a turn waits for the one before, but
/// not for those of the others.
const SIDE_BY_SIDE: usize = 4;

/// Σᵢ wᵢ·exp(−jkωtᵢ) of D weights wᵢ at the times tᵢ (seconds), for k = 0 … `highest`.
pub(super) fn sums<const D: usize>(
    instants: &[(f64, [f64; D])],
    period_s: f64,
    highest: usize,
) -> Vec<[Complex; D]> {
    let mut sums = vec![[Complex::ZERO; D]; highest + 1];
    let (blocks, rest) = instants.as_chunks::<SIDE_BY_SIDE>();
    blocks.iter().for_each(|block| add(block, period_s, &mut sums));
    let (pairs, rest) = rest.as_chunks::<2>();
    pairs.iter().for_each(|pair| add(pair, period_s, &mut sums));
    let (single, _) = rest.as_chunks::<1>();
    single.iter().for_each(|one| add(one, period_s, &mut sums));
    sums
}

fn add<const D: usize, const N: usize>(
    instants: &[(f64, [f64; D]); N],
    period_s: f64,
    sums: &mut [[Complex; D]],
) {
    let turns = instants.map(|(time_s, _)| Complex::from_polar(1.0, -TAU / period_s * time_s));
    let mut at = [Complex::ONE; N];
    for sums in sums {
        for (d, sum) in sums.iter_mut().enumerate() {
            for ((_, weights), at) in instants.iter().zip(&at) {
                *sum += *at * weights[d];
            }
        }
        at.iter_mut().zip(&turns).for_each(|(at, turn)| *at *= turn);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Powers of a turn lose 1e-16 of themselves with each factor.
    #[test]
    fn any_number_of_times_is_summed() {
        for count in 0..9 {
            let instant = |i: u32| (0.3 * f64::from(i), [f64::from(i) - 2.5, 1.0]);
            let instants: Vec<(f64, [f64; 2])> = (0..count).map(instant).collect();
            let found = sums(&instants, 2.0, 7);
            for (k, found) in found.iter().enumerate() {
                for (d, found) in found.iter().enumerate() {
                    let term = |(time_s, weights): &(f64, [f64; 2])| {
                        Complex::from_polar(weights[d], -std::f64::consts::PI * k as f64 * time_s)
                    };
                    let expected: Complex = instants.iter().map(term).sum();
                    assert!((found - expected).norm() < 1e-13, "{count} {k} {d}");
                }
            }
        }
    }
}
