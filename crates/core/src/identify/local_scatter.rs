//! How far residuals scatter about their neighbours in frequency.
//!
//! What a model lacks changes smoothly along frequency, and noise does not. A residual less what its
//! two neighbours at the same magnitude and harmonic make one expect is therefore nearly free of
//! model error, and its square tells the noise even where the model is wrong (difference-based
//! variance estimation: Gasser, Sroka and Jennen-Steinmetz 1986, doi:10.1093/biomet/73.3.625).

use std::collections::BTreeMap;

use crate::measurement::Complex;

use super::problem::Problem;
use super::variance_law::SumOfSquares;

/// Magnitudes that differ by less than this share are the same.
const SAME_MAGNITUDE: f64 = 1e-3;

/// A datum of a series along frequency.
#[derive(Debug, Clone, Copy)]
struct Datum {
    ln_omega: f64,
    /// Its number in the order of the targets.
    number: usize,
    /// Degrees of freedom: 1 of a real datum, else 2.
    dof: f64,
}

/// The numbers of a datum and of its two neighbours in frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Triple {
    at: usize,
    below: usize,
    above: usize,
    /// Weight of the upper neighbour in the interpolation; the lower one has the rest.
    share: f64,
    /// Degrees of freedom of the datum.
    dof: f64,
}

impl Triple {
    fn of(below: Datum, at: Datum, above: Datum) -> Self {
        let span = above.ln_omega - below.ln_omega;
        let share = if span > 0.0 { (at.ln_omega - below.ln_omega) / span } else { 0.5 };
        Self { at: at.number, below: below.number, above: above.number, share, dof: at.dof }
    }
}

/// The data of a problem that have neighbours in frequency.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LocalScatter {
    triples: Vec<Triple>,
}

impl LocalScatter {
    /// Finds the neighbours. Only experiments with a pure cosine as input have any.
    pub fn of(problem: &Problem) -> Self {
        // By magnitude, in steps of `SAME_MAGNITUDE`, and by harmonic.
        let mut series: BTreeMap<(i64, usize), Vec<Datum>> = BTreeMap::new();
        let mut number = 0;
        for experiment in &problem.experiments {
            let amplitude = experiment.excitation.input().get(1).map_or(0.0, |u| u.norm());
            let level = (amplitude.max(f64::MIN_POSITIVE).ln() / SAME_MAGNITUDE).round() as i64;
            let ln_omega = experiment.excitation.omega_rad_s().ln();
            for target in &experiment.targets {
                if experiment.excitation.is_pure_cosine() && !target.constraint {
                    let dof = if target.real { 1.0 } else { 2.0 };
                    let series = series.entry((level, target.order)).or_default();
                    series.push(Datum { ln_omega, number, dof });
                }
                number += 1;
            }
        }
        let mut triples = Vec::new();
        for mut series in series.into_values() {
            series.sort_by(|a, b| a.ln_omega.total_cmp(&b.ln_omega));
            triples.extend(
                series.windows(3).map(|around| Triple::of(around[0], around[1], around[2])),
            );
        }
        Self { triples }
    }

    /// The same for a part of the data, renumbered: whether each datum is kept.
    pub fn only(&self, kept: &[bool]) -> Self {
        let mut count = 0;
        let number: Vec<Option<usize>> = kept
            .iter()
            .map(|kept| {
                count += usize::from(*kept);
                kept.then(|| count - 1)
            })
            .collect();
        let renumbered = |triple: &Triple| {
            let [at, below, above] = [triple.at, triple.below, triple.above].map(|i| number[i]);
            Some(Triple { at: at?, below: below?, above: above?, ..*triple })
        };
        Self { triples: self.triples.iter().filter_map(renumbered).collect() }
    }

    /// Whether no datum has neighbours.
    pub fn is_empty(&self) -> bool {
        self.triples.is_empty()
    }

    /// The squared differences of residuals from what their neighbours make one expect, given the
    /// sizes |Y| of the responses; both by number of the datum.
    pub fn sums(&self, residuals: &[Complex], sizes: &[f64]) -> Vec<SumOfSquares> {
        let of = |triple: &Triple| {
            let Triple { at, below, above, share, dof } = *triple;
            let rest = 1.0 - share;
            let expected = residuals[below] * rest + residuals[above] * share;
            let of_size = |i: usize, weight: f64| (weight * sizes[i]).powi(2);
            SumOfSquares {
                sum: (residuals[at] - expected).norm_sqr(),
                dof,
                additive: 1.0 + rest * rest + share * share,
                proportional: of_size(at, 1.0) + of_size(below, rest) + of_size(above, share),
            }
        };
        self.triples.iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures::{ACTUATORS, axis, multisine, stepped_sine};
    use super::*;

    // Two magnitudes, eight frequencies and harmonics 0 to 3: six inner frequencies each.
    #[test]
    fn inner_frequencies_are_compared_with_their_neighbours_at_the_same_magnitude_and_harmonic() {
        let problem = Problem::new(&stepped_sine(&axis(ACTUATORS[0]), 3)).unwrap();
        let scatter = LocalScatter::of(&problem);
        assert_eq!(scatter.triples.len(), 2 * 6 * 4);
        for triple in &scatter.triples {
            // Four harmonics an experiment, frequencies in ascending and equal steps of ln ω.
            assert_eq!((triple.below, triple.above), (triple.at - 4, triple.at + 4));
            assert!((triple.share - 0.5).abs() < 1e-12);
            assert_eq!(triple.dof, if triple.at % 4 == 0 { 1.0 } else { 2.0 });
        }
    }

    #[test]
    fn residuals_that_are_linear_in_the_logarithm_of_frequency_leave_nothing() {
        let problem = Problem::new(&stepped_sine(&axis(ACTUATORS[0]), 3)).unwrap();
        let scatter = LocalScatter::of(&problem);
        let data = 16 * 4;
        let linear: Vec<Complex> =
            (0..data).map(|i| Complex::new(1.0, 2.0) * (i / 4) as f64).collect();
        let mut sums = scatter.sums(&linear, &vec![1.0; data]);
        assert!(sums.iter().all(|s| s.sum < 1e-20 && s.additive == 1.5 && s.proportional == 1.5));
        let mut kinked = linear;
        kinked[20] += Complex::new(3.0, 4.0);
        sums = scatter.sums(&kinked, &vec![1.0; data]);
        let mut left: Vec<f64> = sums.iter().map(|s| s.sum).filter(|sum| *sum > 1e-9).collect();
        left.sort_by(f64::total_cmp);
        let expected = [6.25, 6.25, 25.0];
        assert!(left.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{left:?}");
    }

    // Without the last of eight frequencies at the second magnitude.
    #[test]
    fn a_part_of_the_data_has_the_neighbours_that_are_left() {
        let problem = Problem::new(&stepped_sine(&axis(ACTUATORS[0]), 3)).unwrap();
        let all = LocalScatter::of(&problem);
        let kept: Vec<bool> = (0..64).map(|datum| datum < 60).collect();
        let rest = all.only(&kept);
        assert_eq!(rest.triples.len(), all.triples.len() - 4);
        assert!(rest.triples.iter().all(|triple| all.triples.contains(triple)));
        let later = all.only(&(0..64).map(|datum| datum >= 4).collect::<Vec<_>>());
        assert!(later.triples.iter().all(|t| (t.below, t.above) == (t.at - 4, t.at + 4)));
    }

    #[test]
    fn lines_of_a_multisine_have_no_neighbours() {
        let problem = Problem::new(&multisine(&axis(ACTUATORS[0]))).unwrap();
        assert!(LocalScatter::of(&problem).is_empty());
    }
}
