//! The variance of noise as a function of the size of the response: σ² = α² + β²·|Y|².
//!
//! The additive part α is what electronics and quantisation add whatever the response; the
//! proportional part β is what an instrument states in dB and degrees. Such a two-part law is usual
//! for measuring instruments (Rocke and Lorenzato 1995, doi:10.1080/00401706.1995.10484302). It is
//! fitted by maximum likelihood to sums of squares that follow scaled χ² distributions, by Fisher
//! scoring (Davidian and Carroll 1987, doi:10.1080/01621459.1987.10478543).

/// A sum of squares whose expectation is `dof`·(`additive`·α² + `proportional`·β²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SumOfSquares {
    /// The sum, in squared units of the response.
    pub sum: f64,
    /// Its degrees of freedom.
    pub dof: f64,
    /// Factor of α².
    pub additive: f64,
    /// Factor of β², in squared units of the response.
    pub proportional: f64,
}

/// The law σ² = α² + β²·|Y|².
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct VarianceLaw {
    /// α², in squared units of the response.
    pub additive: f64,
    /// β².
    pub proportional: f64,
}

/// A proportional part is assumed only where it raises −2 ln likelihood by less than this to leave
/// it out. Chance alone exceeds 6.6 in 1 % of data with noise of one size (χ² with one degree of
/// freedom). Sums of squares that share residuals are correlated, which makes up to half as much
/// more of it.
const SIGNIFICANT_FALL: f64 = 10.0;

/// α is at least this share of the largest response: two good simulations of one machine agree to
/// no better (contract, section 3).
const LEAST_ADDITIVE_SHARE: f64 = 1e-5;

/// The normal distribution lies within this of its mean with a probability of 95 %.
const QUANTILE_95: f64 = 1.96;

/// Most steps of Fisher scoring, and the relative change at which it ends.
const MOST_STEPS: usize = 40;
const CONVERGED_CHANGE: f64 = 1e-6;

impl VarianceLaw {
    /// The most likely law; one without a proportional part if that is not significantly less
    /// likely. `None` if there is nothing to estimate it from.
    pub fn fit(sums: &[SumOfSquares]) -> Option<Self> {
        let dof: f64 = sums.iter().map(|s| s.dof).sum();
        let of_unit = |factor: fn(&SumOfSquares) -> f64| -> f64 {
            let expected: f64 = sums.iter().map(|s| s.dof * factor(s)).sum();
            sums.iter().map(|s| s.sum).sum::<f64>() / expected
        };
        let additive = Self { additive: of_unit(|s| s.additive), proportional: 0.0 };
        if !(dof > 0.0 && additive.additive > 0.0) {
            return None;
        }
        let proportional = of_unit(|s| s.proportional);
        if !proportional.is_finite() {
            return Some(additive);
        }
        // The likelihood may have several maxima; these starts lie on either side of them.
        let starts = [0.5, 1e-2, 1e-4].map(|share| Self {
            additive: share * additive.additive,
            proportional: (1.0 - share) * proportional,
        });
        let likeliest = starts
            .into_iter()
            .map(|start| start.refined(sums, MOST_STEPS))
            .min_by(|a, b| a.misfit(sums).total_cmp(&b.misfit(sums)))?;
        match additive.misfit(sums) - likeliest.misfit(sums) > SIGNIFICANT_FALL {
            true => Some(likeliest),
            false => Some(additive),
        }
    }

    /// The most likely law near this one, after so many steps of Fisher scoring. A part that is 0
    /// stays 0.
    pub fn refined(self, sums: &[SumOfSquares], steps: usize) -> Self {
        let mut law = self;
        let mut misfit = law.misfit(sums);
        for _ in 0..steps {
            let Some(scored) = law.scored(sums) else { break };
            let mut share = 1.0;
            let step = |share: f64| Self {
                additive: law.additive + share * (scored.additive - law.additive),
                proportional: law.proportional + share * (scored.proportional - law.proportional),
            };
            let mut next = step(share);
            while next.misfit(sums) > misfit && share > 1e-3 {
                share *= 0.5;
                next = step(share);
            }
            let fallen = misfit - next.misfit(sums);
            if fallen <= CONVERGED_CHANGE {
                break;
            }
            (law, misfit) = (next, misfit - fallen);
        }
        law
    }

    /// 95 % intervals of α and of β, by the Fisher information, for sums of squares of which so many
    /// tell as much as one that shares no residuals.
    pub fn intervals(self, sums: &[SumOfSquares], shared: f64) -> [[f64; 2]; 2] {
        let [aa, ab, bb] = self.information(sums);
        let determinant = aa * bb - ab * ab;
        // A mean square has the variance 2·V²/ν, so that the covariance of α² and β² is twice the
        // inverse of Σ ν·x·xᵀ/V².
        let variances = [bb, aa].map(|other| 2.0 * shared * other / determinant);
        let mut of = [self.additive, self.proportional].into_iter().zip(variances);
        [(); 2].map(|()| {
            let (square, variance) = of.next().unwrap_or_default();
            let reach = QUANTILE_95 * variance.max(0.0).sqrt();
            // Near 0 the square is nearly normal; far from it, its logarithm.
            let ends = match reach < square {
                true => [square * (-reach / square).exp(), square * (reach / square).exp()],
                false => [0.0, square + reach],
            };
            ends.map(f64::sqrt)
        })
    }

    /// Σ ν·x·xᵀ/V² over the sums, with x their factors of α² and β²: [αα, αβ, ββ].
    fn information(&self, sums: &[SumOfSquares]) -> [f64; 3] {
        let mut information = [0.0; 3];
        for s in sums {
            let (a, b, weight) = (s.additive, s.proportional, s.dof / self.expected(s).powi(2));
            for (entry, product) in information.iter_mut().zip([a * a, a * b, b * b]) {
                *entry += weight * product;
            }
        }
        information
    }

    /// One step of Fisher scoring: a least-squares fit of the law to the mean squares, each
    /// weighted by its inverse variance under the present law, with neither part negative.
    fn scored(&self, sums: &[SumOfSquares]) -> Option<Self> {
        let [aa, ab, bb] = self.information(sums);
        let (mut ay, mut by) = (0.0, 0.0);
        for s in sums {
            let weighted = s.sum / self.expected(s).powi(2);
            ay += s.additive * weighted;
            by += s.proportional * weighted;
        }
        let least = self.additive.max(f64::MIN_POSITIVE) * 1e-3;
        let additive_alone = Self { additive: ay / aa, proportional: 0.0 };
        if self.proportional <= 0.0 {
            return (additive_alone.additive > 0.0).then_some(additive_alone);
        }
        let determinant = aa * bb - ab * ab;
        let both = Self {
            additive: (bb * ay - ab * by) / determinant,
            proportional: (aa * by - ab * ay) / determinant,
        };
        if !(both.additive.is_finite() && both.proportional.is_finite()) {
            return None;
        }
        Some(match (both.additive > least, both.proportional > 0.0) {
            (true, true) => both,
            // The additive part falls by a factor at most, so that the law stays positive.
            (false, _) => Self { additive: least, proportional: (by - ab * least).max(0.0) / bb },
            (true, false) => additive_alone,
        })
    }

    /// The expectation of a sum of squares per degree of freedom.
    fn expected(&self, sum: &SumOfSquares) -> f64 {
        self.additive * sum.additive + self.proportional * sum.proportional
    }

    /// −2 ln likelihood, up to a constant.
    fn misfit(&self, sums: &[SumOfSquares]) -> f64 {
        let of = |s: &SumOfSquares| {
            let expected = self.expected(s);
            s.dof * expected.ln() + s.sum / expected
        };
        sums.iter().filter(|s| s.dof > 0.0).map(of).sum()
    }

    /// Standard deviation of re and of im of a response of this size. `largest` is the size of the
    /// largest response.
    pub fn std(&self, size: f64, largest: f64) -> f64 {
        let least = (LEAST_ADDITIVE_SHARE * largest).powi(2);
        (self.additive.max(least) + self.proportional * size * size).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{ChiSquared, Distribution};

    use super::*;

    /// Squares of noise on responses whose sizes are spread over three decades, with two degrees
    /// of freedom each.
    fn drawn(law: VarianceLaw, count: usize, seed: u64) -> Vec<SumOfSquares> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let chi2 = ChiSquared::new(2.0).unwrap();
        let size = |i: usize| 10.0_f64.powf(-3.0 * i as f64 / count as f64);
        let sum = |i: usize| {
            let mut sum =
                SumOfSquares { sum: 0.0, dof: 2.0, additive: 1.0, proportional: size(i).powi(2) };
            sum.sum = law.expected(&sum) * chi2.sample(&mut rng);
            sum
        };
        (0..count).map(sum).collect()
    }

    // Each part is found from about half of 400 sums: a relative standard deviation of its square
    // of √(2/400) = 7 %, more where both parts matter. 40 % are four of 10 %.
    #[test]
    fn both_parts_of_the_law_are_found() {
        for (seed, [alpha, beta]) in
            [[1e-3, 1e-2], [1e-4, 3e-3], [1e-2, 0.2]].into_iter().enumerate()
        {
            let law = VarianceLaw { additive: alpha * alpha, proportional: beta * beta };
            let found = VarianceLaw::fit(&drawn(law, 400, seed as u64)).unwrap();
            assert!((found.additive / law.additive - 1.0).abs() < 0.4, "{alpha}: {found:?}");
            assert!((found.proportional / law.proportional - 1.0).abs() < 0.4, "{beta}: {found:?}");
        }
    }

    // Of 200 intervals 190 are expected to hold the truth, with a standard deviation of 3; the
    // intervals are asymptotic, so four below and above are allowed.
    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        let law = VarianceLaw { additive: 1e-6, proportional: 1e-4 };
        let mut held = [0; 2];
        for seed in 0..200 {
            let sums = drawn(law, 300, 100 + seed);
            let ends = VarianceLaw::fit(&sums).unwrap().intervals(&sums, 1.0);
            for (count, (ends, truth)) in held.iter_mut().zip(ends.iter().zip([1e-3, 1e-2])) {
                *count += usize::from((ends[0]..=ends[1]).contains(&truth));
            }
        }
        assert!(held.iter().all(|count| (178..=200).contains(count)), "{held:?}");
    }

    #[test]
    fn noise_of_one_size_has_no_proportional_part() {
        let law = VarianceLaw { additive: 1e-6, proportional: 0.0 };
        for seed in 0..50 {
            let found = VarianceLaw::fit(&drawn(law, 200, seed)).unwrap();
            assert_eq!(found.proportional, 0.0, "{seed}");
            assert!((found.additive / law.additive - 1.0).abs() < 0.4, "{found:?}");
        }
    }

    #[test]
    fn noise_in_proportion_alone_leaves_an_additive_part_too_small_to_matter() {
        let law = VarianceLaw { additive: 0.0, proportional: 1e-4 };
        let found = VarianceLaw::fit(&drawn(law, 200, 4)).unwrap();
        // The smallest response is 1e-3.
        assert!(found.additive < 0.2 * law.proportional * 1e-6, "{found:?}");
        assert!((found.proportional / law.proportional - 1.0).abs() < 0.4, "{found:?}");
    }

    #[test]
    fn nothing_is_found_in_no_data_or_in_data_without_noise() {
        let silent = VarianceLaw { additive: 0.0, proportional: 0.0 };
        assert_eq!(VarianceLaw::fit(&[]), None);
        assert_eq!(VarianceLaw::fit(&drawn(silent, 20, 1)), None);
    }
}
