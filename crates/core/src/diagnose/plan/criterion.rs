//! How surely the experiments of a design name each effect.
//!
//! What is left of an effect's change after the base model is refitted is its *excess* χ², the
//! noncentrality of the test for it; what is left beside the best imitation by another effect, too, is by
//! how much the two fits differ (Ds-optimality and optimal discrimination: A. C. Atkinson, V. V. Fedorov
//! 1975, doi:10.1093/biomet/62.1.57). Both are Schur complements of the products of columns. Every effect
//! is simulated in several sizes, because some start at a limit: a slew rate shows only where the command
//! is fastest. Near a size that is simulated, f times the size has f² times the excess. That gives the
//! probability that
//!
//! - it is detected: √excess, with unit scatter, is above √30. Chance brings any effect of the
//!   library to √15 in three measurements of a thousand; but parameters cost evidence, and the effect
//!   must show in what is held out, too. 30 was set by hand;
//! - it is told from its closest imitator: the difference of the fits, normal with the mean λ and the
//!   variance 4λ, is positive.

use nalgebra::DMatrix;
use statrs::distribution::{ContinuousCDF, Normal};

use crate::effects::{ALL, are_nested};

use super::information::{SIZES, Scenario, VARIANTS};

/// √Δχ² from which an effect is detected.
const DETECTED: f64 = 5.477_225_575_051_661;

/// The sizes that count, as factors on the simulated size next to them: six log-uniform ones from the
/// whole to a thirtieth, 30^(−k/5).
const NEAR: [[f64; 2]; SIZES] = [
    [1.0, 0.506_495_684_112_118],
    [1.405_115_826_483_646, 0.711_685_101_791_599],
    [1.974_350_485_834_82, 1.0],
];

/// The probability from which an effect is called nameable.
pub(super) const SURE: f64 = 0.9;

/// Precision of a base parameter before the first experiment: it is known to a factor of e. It keeps
/// the first choices finite.
const PRIOR: f64 = 1.0;
/// The same of the amount of an imitator, in typical sizes.
const IMITATOR_PRIOR: f64 = 0.1;

/// How much is left of the change by a variant of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Left {
    /// Index of its size.
    pub size: usize,
    /// Excess χ² beside the base model.
    pub excess: f64,
    /// Excess χ² beside the base model and the best imitator.
    pub beyond: f64,
    /// Index of that imitator in the library.
    pub imitator: Option<usize>,
}

impl Left {
    /// The probability that the effect is named if it is `factor` times as large.
    pub fn probability(&self, factor: f64) -> f64 {
        let normal = Normal::standard();
        let detected = normal.cdf(factor * self.excess.sqrt() - DETECTED);
        match self.imitator {
            Some(_) => detected * normal.cdf(0.5 * factor * self.beyond.sqrt()),
            None => detected,
        }
    }

    /// The mean of that over the sizes near this one.
    pub fn score(&self) -> f64 {
        let near = NEAR[self.size];
        near.iter().map(|factor| self.probability(*factor)).sum::<f64>() / near.len() as f64
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

/// What is left of every effect of the library, in each of its variants.
pub(super) fn left(
    scenario: &Scenario,
    products: &DMatrix<f64>,
    imitators: &[Vec<usize>],
) -> Vec<[Left; VARIANTS]> {
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
            std::array::from_fn(|variant| {
                let own = VARIANTS * effect + variant;
                let excess = rest[(own, own)].max(0.0);
                let explained = imitators[effect]
                    .iter()
                    .map(|other| (spans[*other].explained(&rest, *other, own), *other))
                    .max_by(|a, b| a.0.total_cmp(&b.0));
                let beyond = explained.map_or(excess, |(explained, _)| excess - explained);
                let imitator = explained.map(|(_, other)| other);
                Left { size: variant % SIZES, excess, beyond: beyond.max(0.0), imitator }
            })
        })
        .collect()
}

/// The mean over effects and variants of what `value` says of what is left.
pub(super) fn mean(left: &[[Left; VARIANTS]], value: impl Fn(&Left) -> f64) -> f64 {
    left.iter().flatten().map(value).sum::<f64>() / (left.len() * VARIANTS) as f64
}

/// The Cholesky factor of the products of an imitator's variants.
struct Span([[f64; VARIANTS]; VARIANTS]);

impl Span {
    fn of(rest: &DMatrix<f64>, effect: usize) -> Self {
        let at = VARIANTS * effect;
        let mut factor = [[0.0; VARIANTS]; VARIANTS];
        for i in 0..VARIANTS {
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

    /// How much of the excess of another column a sum of the variants explains.
    fn explained(&self, rest: &DMatrix<f64>, effect: usize, column: usize) -> f64 {
        let mut along = [0.0; VARIANTS];
        for i in 0..VARIANTS {
            let inner: f64 = (0..i).map(|k| self.0[i][k] * along[k]).sum();
            along[i] = (rest[(VARIANTS * effect + i, column)] - inner) / self.0[i][i];
        }
        along.iter().map(|x| x * x).sum()
    }
}
