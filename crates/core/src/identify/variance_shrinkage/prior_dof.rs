//! Degrees of freedom of a prior of variances, from their scatter about it.

use statrs::function::gamma::digamma;

use super::cell::Cell;

/// Degrees of freedom of the prior, from the excess of the scatter of ln s² about the prior over
/// ψ'(ν/2), which the few repeats alone cause. Infinite if there is no significant excess.
pub(super) fn prior_dof(cells: &[Cell], prior: &[f64]) -> f64 {
    let (mut excess, mut scatter, mut count) = (0.0, 0.0, 0.0);
    let mut alike = LogScatter::of(1.0);
    for (cell, prior) in cells.iter().zip(prior).filter(|(cell, _)| cell.dof > 0.0) {
        // Nearly all cells have as many degrees of freedom as the one before.
        if alike.dof != cell.dof {
            alike = LogScatter::of(cell.dof);
        }
        let deviation = (cell.variance / prior).ln() - alike.mean;
        excess += deviation * deviation - alike.variance;
        scatter += alike.variance;
        count += 1.0;
    }
    if count == 0.0 {
        return f64::INFINITY;
    }
    let excess: f64 = excess / count;
    // The mean of `count` squares has a relative standard deviation of about √(2/count); allow two.
    let noise = scatter / count * f64::sqrt(8.0 / count);
    if excess <= noise { f64::INFINITY } else { 2.0 * inverse_trigamma(excess) }
}

/// ln s² − ln σ² of an estimated variance.
pub(super) struct LogScatter {
    /// ν, the degrees of freedom of the estimate.
    dof: f64,
    /// Its mean, ψ(ν/2) − ln(ν/2).
    pub(super) mean: f64,
    /// Its variance, ψ'(ν/2).
    variance: f64,
}

impl LogScatter {
    /// For more than 0 degrees of freedom.
    pub(super) fn of(dof: f64) -> Self {
        let half = 0.5 * dof;
        Self { dof, mean: digamma(half) - half.ln(), variance: trigamma(half) }
    }
}

/// ψ'(x) for x > 0, by the recurrence and the asymptotic series (DLMF 5.15.8).
fn trigamma(mut x: f64) -> f64 {
    let mut sum = 0.0;
    while x < 10.0 {
        sum += 1.0 / (x * x);
        x += 1.0;
    }
    let inverse = 1.0 / x;
    let square = inverse * inverse;
    sum + inverse
        * (1.0 + 0.5 * inverse + square * (1.0 / 6.0 - square * (1.0 / 30.0 - square / 42.0)))
}

/// The x with ψ'(x) = y > 0, by bisection in ln x.
fn inverse_trigamma(y: f64) -> f64 {
    let (mut low, mut high) = (-20.0_f64, 20.0_f64);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if trigamma(middle.exp()) > y { low = middle } else { high = middle }
    }
    (0.5 * (low + high)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trigamma_agrees_with_known_values() {
        let pi2 = std::f64::consts::PI.powi(2);
        assert!((trigamma(1.0) - pi2 / 6.0).abs() < 1e-10);
        assert!((trigamma(0.5) - pi2 / 2.0).abs() < 1e-10);
        assert!((inverse_trigamma(trigamma(3.7)) - 3.7).abs() < 1e-9);
    }
}
