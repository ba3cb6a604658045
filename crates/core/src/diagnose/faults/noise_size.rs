//! A stated standard deviation that is wrong by a factor.
//!
//! Where nothing but the size of the noise contradicts a model, what it leaves tells that size: Σr²/s²
//! has a χ² distribution.

use crate::answers::{FaultKind, MeasurementFault};

/// −2 ln of the prior odds of a wrong size, and prior standard deviation of its logarithm.
const COST: f64 = 6.0;
const DEVIATION: f64 = 1.1;

/// Half the width of a 95 % interval, in standard deviations.
const HALF_WIDTH: f64 = 1.96;

/// What a wrong size costs, −2 ln, where it is estimated with so many degrees of freedom.
pub(super) fn price(dof: f64) -> f64 {
    COST + (2.0 * dof * DEVIATION.powi(2)).ln_1p()
}

/// By which factor the noise differs from what is stated, with its interval, from Σr² and its degrees
/// of freedom. `None` where |Σr²/ν − 1| is within `limit`, the most that chance makes of it.
pub(super) fn factor(squares: f64, dof: f64, limit: f64) -> Option<MeasurementFault> {
    let variance = squares / dof;
    let factor = variance.sqrt();
    let spread = HALF_WIDTH / (2.0 * dof).sqrt();
    ((variance - 1.0).abs() > limit).then(|| MeasurementFault {
        value: Some(factor),
        interval95: Some([factor * (-spread).exp(), factor * spread.exp()]),
        ..MeasurementFault::of(FaultKind::StdFactor)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    // Of 200 degrees of freedom s is known to 1/√400 = 5 %, its 95 % interval to ±9.8 %.
    #[test]
    fn a_factor_is_stated_with_its_interval_where_it_is_more_than_chance() {
        let found = factor(800.0, 200.0, 0.3).unwrap();
        assert_eq!(found.value, Some(2.0));
        let [low, high] = found.interval95.unwrap();
        assert!((low - 2.0 / 1.103).abs() < 0.002 && (high - 2.0 * 1.103).abs() < 0.002);
        assert_eq!(factor(220.0, 200.0, 0.3), None);
    }
}
