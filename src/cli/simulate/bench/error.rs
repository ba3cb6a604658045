//! Why a bench gives no measurement, or leaves a point out.

use servoscope_core::measurement::InvalidMeasurement;
use servoscope_core::simulate::NoResponse;

/// Why a bench gives no measurement.
#[derive(Debug, PartialEq, thiserror::Error)]
pub(in crate::cli::simulate) enum BenchError {
    #[error("magnitude {magnitude} at {omega_rad_s} rad/s: {source}")]
    NoResponse { magnitude: f64, omega_rad_s: f64, source: NoResponse },
    #[error(
        "magnitude {magnitude} at {omega_rad_s} rad/s: the mean position drifts, and no \
             constant input can hold it"
    )]
    NotHeld { magnitude: f64, omega_rad_s: f64 },
    #[error("no experiment has a response of its own period, the first of them: {first}")]
    Nothing { first: Box<BenchError> },
    #[error(
        "half of the experiments or more do not move, so --noise-db is relative to 0; raise \
         --magnitudes above the friction, {level}, or give --noise-std"
    )]
    Still { level: f64 },
    #[error(
        "a position is periodic only if the mean velocity is 0, which needs the same excess of \
         --fs over --fc in both directions, not {plus} and {minus}"
    )]
    Drifts { plus: f64, minus: f64 },
    #[error(transparent)]
    Invalid(#[from] InvalidMeasurement),
}

impl BenchError {
    /// Whether this experiment alone is without a response.
    pub(super) fn concerns_one_point(&self) -> bool {
        matches!(
            self,
            BenchError::NotHeld { .. }
                | BenchError::NoResponse { source: NoResponse::NotPeriodic { .. }, .. }
                | BenchError::NoResponse { source: NoResponse::Endless, .. }
        )
    }
}
