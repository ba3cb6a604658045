//! The variance of the logarithm of a ratio of errors, from how the errors vary between groups.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::residual_sums::ResidualSums;

/// How groups of data are related, which decides how the variance of ln ratio is estimated. With
/// b_g and a_g the Σ|Y − Ŷ|² of both models in group g of n, Student's t has n − 1 degrees of
/// freedom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sample {
    /// Errors vary smoothly from group to group, so only differences of neighbours count as chance:
    /// the successive-difference estimator. With x_g = b_g/mean(b) − a_g/mean(a),
    ///
    /// ```text
    ///   Var(ln ratio) = ¼ · Σ(x_{g+1} − x_g)² / (2n(n − 1))
    /// ```
    ///
    /// where the ¼ is due to the root in the NRMSE (Wolter 2007, Introduction to Variance
    /// Estimation, doi:10.1007/978-0-387-35099-8, section 8.2).
    Smooth,
    /// Groups are independent: the delete-one jackknife. With r_g the ln ratio of all groups but g
    /// (Efron and Stein 1981, doi:10.1214/aos/1176345462),
    ///
    /// ```text
    ///   Var(ln ratio) = (n − 1)/n · Σ(r_g − mean(r))²
    /// ```
    Independent,
}

/// Standard deviation of ln ratio by [`Sample::Smooth`], for two groups or more.
pub(super) fn smooth_std(groups: &[[ResidualSums; 2]]) -> f64 {
    let count = groups.len() as f64;
    let mean = |model: usize| groups.iter().map(|group| group[model].error).sum::<f64>() / count;
    let (before, after) = (mean(0), mean(1));
    let share = |group: &[ResidualSums; 2]| group[0].error / before - group[1].error / after;
    let steps = groups.windows(2).map(|pair| (share(&pair[1]) - share(&pair[0])).powi(2));
    0.5 * (steps.sum::<f64>() / (2.0 * count * (count - 1.0))).sqrt()
}

/// The same by [`Sample::Independent`]; not finite if one group holds the whole error of a model.
pub(super) fn jackknife_std(groups: &[[ResidualSums; 2]], total: &[ResidualSums; 2]) -> f64 {
    let count = groups.len() as f64;
    let without = |group: &[ResidualSums; 2]| {
        let [before, after] = [0, 1].map(|model| total[model].error - group[model].error);
        0.5 * (before / after).ln()
    };
    let ratios: Vec<f64> = groups.iter().map(without).collect();
    let mean = ratios.iter().sum::<f64>() / count;
    let squares = ratios.iter().map(|ratio| (ratio - mean).powi(2)).sum::<f64>();
    ((count - 1.0) / count * squares).sqrt()
}

/// 97.5 % quantile of Student's t with `groups` − 1 degrees of freedom.
pub(super) fn student(groups: usize) -> Option<f64> {
    let law = StudentsT::new(0.0, 1.0, groups as f64 - 1.0).ok()?;
    Some(law.inverse_cdf(0.975))
}
