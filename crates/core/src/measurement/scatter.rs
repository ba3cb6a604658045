//! Compares the standard deviations stated in an upload with the scatter of its repeats.

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::{Experiment, Harmonic, Repeat};

/// Probability with which chance alone makes a remark, two-sided: the scatter of normal noise
/// follows χ².
const FALSE_REMARK: f64 = 1e-4;

/// Ratio of the two deviations, or its inverse, up to which nothing is said: a smaller difference
/// is of no consequence, since the scatter is used.
const REMARK_RATIO: f64 = 2.0;

/// Sum of the squares of the scatter in units of the stated deviations, and its degrees of freedom,
/// over all harmonics that have both.
///
/// With P repeats Yₚ, their mean Ȳ and the deviation s stated for the mean, Σ|Yₚ − Ȳ|²/(P·s²)
/// follows χ² with P − 1 degrees of freedom for each real component.
fn sum_of_squares(experiments: &[Experiment]) -> [f64; 2] {
    let (mut chi2, mut dof) = (0.0, 0.0);
    for Experiment { response, repeats, .. } in experiments.iter().filter(|e| e.has_repeats()) {
        let count = repeats.len() as f64;
        for (i, Harmonic { order, std, .. }) in response.iter().enumerate() {
            let Some(std) = std else { continue };
            let squares: f64 = repeats.iter().map(|r: &Repeat| r.response[i].norm_sqr()).sum();
            chi2 += squares / (count * std * std);
            dof += (count - 1.0) * if *order == 0 { 1.0 } else { 2.0 };
        }
    }
    [chi2, dof]
}

/// A remark for the user if the two contradict.
pub(super) fn remark(experiments: &[Experiment]) -> Option<String> {
    let [chi2, dof] = sum_of_squares(experiments);
    let excess = (chi2 / dof).sqrt();
    if (1.0 / REMARK_RATIO..=REMARK_RATIO).contains(&excess) {
        return None;
    }
    let chance = ChiSquared::new(dof).ok()?;
    let probability = 2.0 * chance.cdf(chi2).min(chance.sf(chi2));
    (probability < FALSE_REMARK).then(|| {
        format!(
            "the repeats scatter {} times as far as their stated deviations say: their scatter is \
             used instead",
            if excess < 0.01 { format!("{excess:.1e}") } else { format!("{excess:.2}") }
        )
    })
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::measurement::Complex;

    /// `count` repeats of `harmonics` harmonics that scatter by 0.06, with `std` stated for their
    /// mean.
    fn repeated(seed: u64, count: usize, harmonics: usize, std: f64) -> Experiment {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut draw = || 0.06 * Distribution::<f64>::sample(&StandardNormal, &mut rng);
        let mut one = || (0..harmonics).map(|_| Complex::new(draw(), draw())).collect();
        let mut deviations: Vec<Vec<Complex>> = (0..count).map(|_| one()).collect();
        for k in 0..harmonics {
            let sum: Complex = deviations.iter().map(|repeat| repeat[k]).sum();
            deviations.iter_mut().for_each(|repeat| repeat[k] -= sum / count as f64);
        }
        let harmonic = |order| Harmonic { order, value: Complex::ONE, std: Some(std) };
        let repeat = |response| Repeat { input: Vec::new(), response };
        Experiment {
            magnitude: 1.0,
            omega_rad_s: 1.0,
            input: vec![Complex::ZERO, Complex::ONE],
            input_mean_measured: false,
            mean_velocity: 0.0,
            rounding_std: 0.0,
            open_samples: None,
            bad_samples: None,
            clipping: None,
            range: None,
            unknown_input: Vec::new(),
            response: (1..=harmonics).map(harmonic).collect(),
            run: None,
            repeats: deviations.into_iter().map(repeat).collect(),
            from_record: false,
        }
    }

    // The standard deviation of a mean of six is 0.06/√6. With 200 degrees of freedom the ratio has
    // a standard error of 5 %.
    #[test]
    fn a_stated_deviation_is_held_against_the_scatter_of_repeats() {
        let right = 0.06 / 6.0_f64.sqrt();
        let six = |std| [repeated(5, 6, 20, std)];
        let [chi2, dof] = sum_of_squares(&six(right));
        assert!(((chi2 / dof).sqrt() - 1.0).abs() < 0.15, "{chi2} {dof}");
        assert_eq!(remark(&six(right)), None);
        let said = remark(&six(0.2 * right)).unwrap();
        assert!(said.contains("scatter 5.") || said.contains("scatter 4."), "{said}");
        assert!(remark(&six(5.0 * right)).unwrap().contains("scatter 0.2"));
    }

    // Two degrees of freedom: χ² is above 19.8 or below 1e-4 with a probability of 1e-4.
    #[test]
    fn two_repeats_of_one_harmonic_contradict_only_a_deviation_that_chance_cannot_explain() {
        let right = 0.06 / 2.0_f64.sqrt();
        for seed in 0..200 {
            let two = |std| [repeated(seed, 2, 1, std)];
            assert_eq!(remark(&two(right)), None, "{seed}");
            assert_eq!(remark(&two(1.5 * right)), None, "{seed}");
            assert!(remark(&two(1e-3 * right)).is_some(), "{seed}");
            assert!(remark(&two(1e4 * right)).unwrap().contains("e-"), "{seed}");
        }
    }
}
