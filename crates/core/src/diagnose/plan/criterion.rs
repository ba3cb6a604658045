//! How surely the experiments of a design name each effect.
//!
//! What is left of an effect's change after the base model is refitted is its *excess* χ², the
//! noncentrality of the test for it; what is left beside the best imitation by another effect, too, is by
//! how much the two fits differ (Ds-optimality and optimal discrimination: A. C. Atkinson, V. V. Fedorov
//! 1975, doi:10.1093/biomet/62.1.57). Both are Schur complements of the products of columns. An effect
//! of f times the typical size has f² times the excess, which gives the probability that
//!
//! - it is noticed: √excess, with unit scatter, is above √30. Chance brings any effect of the library to
//!   √15 in three measurements of a thousand; but parameters cost evidence, and the effect must show in
//!   what is held out, too: of the effects of seed 64 of the example `planned` those are named that have 25
//!   to 40 or more;
//! - it is told from its closest imitator: the difference of the fits, normal with the mean λ and the
//!   variance 4λ, is positive.

use nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::effects::{ALL, are_nested};

use super::information::{SHAPES, Scenario};

/// √Δχ² from which an effect is noticed.
const NOTICED: f64 = 5.477_225_575_051_661;

/// Sizes that count, as factors on the typical size: log-uniform from the least to 1.
const LEAST_SIZE: f64 = 1.0 / 30.0;
const SIZES: usize = 6;

/// The probability from which an effect is called nameable.
pub(super) const SURE: f64 = 0.9;

/// Precision of a base parameter before the first experiment: it is known to a factor of e. It keeps
/// the first choices finite.
const PRIOR: f64 = 1.0;
/// The same of the amount of an imitator, in typical sizes.
const IMITATOR_PRIOR: f64 = 0.1;

/// How much of an effect's change is left, by its shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Left {
    /// Excess χ² beside the base model.
    pub excess: f64,
    /// Excess χ² beside the base model and the best imitator.
    pub beyond: f64,
    /// Index of that imitator in the library.
    pub imitator: Option<usize>,
}

impl Left {
    /// The probability that the effect, `factor` times as large, is named.
    pub fn probability(&self, factor: f64) -> f64 {
        let normal = Normal::standard();
        let noticed = normal.cdf(factor * self.excess.sqrt() - NOTICED);
        match self.imitator {
            Some(_) => noticed * normal.cdf(0.5 * factor * self.beyond.sqrt()),
            None => noticed,
        }
    }

    /// The mean of that over the sizes that count.
    pub fn score(&self) -> f64 {
        let factor = |i: usize| LEAST_SIZE.powf(i as f64 / (SIZES - 1) as f64);
        (0..SIZES).map(|i| self.probability(factor(i))).sum::<f64>() / SIZES as f64
    }
}

/// Which effects may imitate which: not those that contain it as a special case, since a model of fewer
/// parameters is preferred.
pub(super) fn imitators() -> Vec<Vec<usize>> {
    let contains = |more: usize, less: usize| {
        are_nested(ALL[more], ALL[less])
            && ALL[more].parameters().len() > ALL[less].parameters().len()
    };
    let of = |hidden: usize| (0..ALL.len()).filter(move |other| *other != hidden);
    (0..ALL.len()).map(|hidden| of(hidden).filter(|i| !contains(*i, hidden)).collect()).collect()
}

/// What is left of every effect of the library, in each of its shapes.
pub(super) fn left(
    scenario: &Scenario,
    products: &DMatrix<f64>,
    imitators: &[Vec<usize>],
) -> Vec<[Left; SHAPES]> {
    let base = scenario.base;
    let effects = products.nrows() - base;
    let mut known = products.view((0, 0), (base, base)).into_owned();
    (0..base).for_each(|i| known[(i, i)] += PRIOR);
    let cross = products.view((0, base), (base, effects)).into_owned();
    let mut rest = products.view((base, base), (effects, effects)).into_owned();
    if let Some(factor) = known.cholesky() {
        let absorbed = factor.l().solve_lower_triangular(&cross).unwrap_or(cross);
        rest.gemm_tr(-1.0, &absorbed, &absorbed, 1.0);
    }
    let spans: Vec<Span> = (0..ALL.len()).map(|effect| Span::of(&rest, effect)).collect();
    (0..ALL.len())
        .map(|effect| {
            std::array::from_fn(|shape| {
                let own = SHAPES * effect + shape;
                let excess = rest[(own, own)].max(0.0);
                let explained = imitators[effect]
                    .iter()
                    .map(|other| (spans[*other].explained(&rest, *other, own), *other))
                    .max_by(|a, b| a.0.total_cmp(&b.0));
                let beyond = explained.map_or(excess, |(explained, _)| excess - explained);
                let imitator = explained.map(|(_, other)| other);
                Left { excess, beyond: beyond.max(0.0), imitator }
            })
        })
        .collect()
}

/// The mean over effects and shapes of what `value` says of what is left.
pub(super) fn mean(left: &[[Left; SHAPES]], value: impl Fn(&Left) -> f64) -> f64 {
    left.iter().flatten().map(value).sum::<f64>() / (left.len() * SHAPES) as f64
}

/// The Cholesky factor of the products of an imitator's shapes.
struct Span([[f64; SHAPES]; SHAPES]);

impl Span {
    fn of(rest: &DMatrix<f64>, effect: usize) -> Self {
        let at = SHAPES * effect;
        let mut factor = [[0.0; SHAPES]; SHAPES];
        for i in 0..SHAPES {
            for j in 0..=i {
                let inner: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let product = rest[(at + i, at + j)] - inner;
                factor[i][j] = match i == j {
                    true => (product.max(0.0) + IMITATOR_PRIOR).sqrt(),
                    false => product / factor[j][j],
                };
            }
        }
        Self(factor)
    }

    /// How much of the excess of another column a sum of the shapes explains.
    fn explained(&self, rest: &DMatrix<f64>, effect: usize, column: usize) -> f64 {
        let mut along = [0.0; SHAPES];
        for i in 0..SHAPES {
            let inner: f64 = (0..i).map(|k| self.0[i][k] * along[k]).sum();
            along[i] = (rest[(SHAPES * effect + i, column)] - inner) / self.0[i][i];
        }
        along.iter().map(|x| x * x).sum()
    }
}
