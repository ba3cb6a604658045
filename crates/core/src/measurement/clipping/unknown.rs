//! Directions along which an input is not known because samples of it were cut off.
//!
//! What was filled in may be wrong by about as much as it lies beyond the limits. Neighbouring samples
//! form blocks that are short beside a period of the highest harmonic of the response: so what one block
//! adds to the response is nearly that of its mean.

use std::f64::consts::TAU;

use crate::measurement::Complex;

/// Length of a block, at most, as a share of the period of the highest harmonic of the response. The
/// moments of a block beyond its mean then change that harmonic by at most (π/8)²/6 = 3 % of what it does.
const BLOCK_SHARE: f64 = 0.125;

/// Most blocks. With more, the input counts as it is filled in.
const MOST_BLOCKS: usize = 3000;

/// The lines from k = 0 to `highest` of each block of samples that were `cut` in any period of so many
/// samples, each of them wrong by `std`; none if there are too many blocks.
pub(super) fn directions(
    cut: &[Vec<usize>],
    length: usize,
    highest: usize,
    std: f64,
) -> Vec<Vec<Complex>> {
    let mut is_cut = vec![false; length];
    cut.iter().flatten().for_each(|at| is_cut[*at] = true);
    let longest = (BLOCK_SHARE * length as f64 / highest.max(1) as f64).max(1.0) as usize;
    let positions: Vec<usize> = (0..length).filter(|at| is_cut[*at]).collect();
    let blocks: Vec<&[usize]> =
        positions.chunk_by(|a, b| a + 1 == *b).flat_map(|run| run.chunks(longest)).collect();
    if blocks.len() > MOST_BLOCKS {
        return Vec::new();
    }
    let lines = |block: &&[usize]| {
        (0..=highest).map(|k| std * line(block[0], block.len(), k, length)).collect()
    };
    blocks.iter().map(lines).collect()
}

/// Line k of a period of zeros but for `count` ones from `first` on (the sum of a geometric series).
fn line(first: usize, count: usize, k: usize, length: usize) -> Complex {
    if k == 0 {
        return Complex::from(count as f64 / length as f64);
    }
    let half = 0.5 * TAU * k as f64 / length as f64;
    let size = 2.0 / length as f64 * (count as f64 * half).sin() / half.sin();
    Complex::from_polar(1.0, -half * (2 * first + count - 1) as f64) * size
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measurement::spectrum::{Periods, of_periods};

    // Rounding of sums of some hundred terms.
    #[test]
    fn the_lines_of_all_blocks_together_are_those_of_what_was_cut_off() {
        let cut = [vec![3, 4, 5, 6, 7, 90, 91], vec![4, 5, 6, 7, 8]];
        let signal: Vec<f64> = (0..100)
            .map(|at| if cut.iter().any(|period| period.contains(&at)) { 0.5 } else { 0.0 })
            .collect();
        let expected = &of_periods(&signal, Periods { samples: 100.0, count: 1 })[0];
        let found = directions(&cut, 100, 6, 0.5);
        // Blocks of two samples.
        assert_eq!(found.len(), 4);
        for k in 0..=6 {
            let sum: Complex = found.iter().map(|lines| lines[k]).sum();
            assert!((sum - expected[k]).norm() < 1e-14, "{k}: {sum} {}", expected[k]);
        }
    }

    #[test]
    fn of_too_many_blocks_none_is_unknown() {
        let every_other = (0..8000).step_by(2).collect();
        assert!(directions(&[every_other], 8000, 10, 1.0).is_empty());
    }
}
