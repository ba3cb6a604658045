//! Effect of the sensor's lags and of the input delay on the velocity harmonics.
//!
//! Each multiplies harmonic k of a periodic response by a factor: 1/(1 + jkωT) for a lag, and
//! exp(−jkωT) for the delay. The delay acts on the input, but it only shifts the response in time,
//! so that it can be applied to the response.

use crate::effects::Axis;
use crate::measurement::Complex;
use crate::plant::Scalar;

use super::signal::complex_dual::ComplexDual;

/// Converts velocity harmonics, and their derivatives (one row for each lane), to those that the
/// sensor reports; in place.
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
