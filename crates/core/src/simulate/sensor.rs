//! From the velocity to what the sensor reports, and the delay ahead of it all.
//!
//! Both act on a periodic response as a factor on every harmonic: exp(−jkωT) for
//! a delay of the input, which comes through the axis as it is, and
//! 1/(1 + jkωT) for a lag.

use crate::effects::Axis;
use crate::measurement::Complex;
use crate::plant::Scalar;

use super::signal::complex_dual::ComplexDual;

/// Turns velocity harmonics, and rows of their derivatives by lane, into those
/// reported.
pub(super) fn report<S: Scalar>(
    axis: &Axis<S>,
    omega: f64,
    velocity: &mut [Complex],
    rows: &mut [Vec<Complex>],
) {
    let delayed = axis.delay != S::constant(0.0);
    if !delayed && axis.sensor_lags.is_empty() {
        return;
    }
    for (k, value) in velocity.iter_mut().enumerate() {
        let s = k as f64 * omega;
        let (sin, cos) = (axis.delay * -s).sin_cos();
        let mut factor = ComplexDual::new(cos, sin);
        for lag in &axis.sensor_lags {
            factor = factor * ComplexDual::new(S::constant(1.0), *lag * s).inverse();
        }
        for (lane, row) in rows.iter_mut().enumerate() {
            row[k] = row[k] * factor.value() + *value * factor.lane(lane);
        }
        *value *= factor.value();
    }
}
