//! Compares the standard deviations stated in an upload with the scatter of its repeats.

use super::{Experiment, Harmonic, Repeat};

/// Fewest degrees of freedom for which the comparison is made.
const MIN_DEGREES_OF_FREEDOM: f64 = 20.0;

/// Ratio of the two deviations, or its inverse, beyond which the user is told. By chance the ratio
/// is 1 with a standard deviation of at most 1/√(2·20) = 0.16.
const REMARK_RATIO: f64 = 2.0;

/// Ratio of the standard deviation of the mean from the scatter of repeats to the one stated; root
/// mean square over all harmonics that have both. `None` if there are too few.
///
/// With P repeats Yₚ, their mean Ȳ and the deviation s stated for the mean, Σ|Yₚ − Ȳ|²/(P·s²)
/// follows χ² with P − 1 degrees of freedom for each real component.
fn excess(experiments: &[Experiment]) -> Option<f64> {
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
    (dof >= MIN_DEGREES_OF_FREEDOM).then(|| (chi2 / dof).sqrt())
}

/// A remark for the user if the two contradict.
pub(super) fn remark(experiments: &[Experiment]) -> Option<String> {
    let excess =
        excess(experiments).filter(|it| !(1.0 / REMARK_RATIO..=REMARK_RATIO).contains(it))?;
    Some(format!(
        "the repeats scatter {excess:.2} times as far as the stated std says: their scatter is \
         used, not std"
    ))
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::measurement::Complex;

    /// Six repeats of twenty harmonics that scatter by 0.06, with `std` stated for their mean.
    fn repeated(std: f64) -> Experiment {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut draw = || 0.06 * Distribution::<f64>::sample(&StandardNormal, &mut rng);
        let mut deviations: Vec<Vec<Complex>> =
            (0..6).map(|_| (1..=20).map(|_| Complex::new(draw(), draw())).collect()).collect();
        for k in 0..20 {
            let mean: Complex = deviations.iter().map(|repeat| repeat[k]).sum::<Complex>() / 6.0;
            deviations.iter_mut().for_each(|repeat| repeat[k] -= mean);
        }
        let harmonic = |order| Harmonic { order, value: Complex::ONE, std: Some(std) };
        let repeat = |response| Repeat { input: Vec::new(), response };
        Experiment {
            magnitude: 1.0,
            omega_rad_s: 1.0,
            input: vec![Complex::ZERO, Complex::ONE],
            input_mean_measured: false,
            response: (1..=20).map(harmonic).collect(),
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
        let found = excess(&[repeated(right)]).unwrap();
        assert!((found - 1.0).abs() < 0.15, "{found}");
        assert_eq!(remark(&[repeated(right)]), None);
        let said = remark(&[repeated(0.2 * right)]).unwrap();
        assert!(said.contains("scatter 5.") || said.contains("scatter 4."), "{said}");
        assert!(remark(&[repeated(5.0 * right)]).unwrap().contains("scatter 0.2"));
    }
}
