//! A response that falls like a position but is called a velocity.

use super::finding::Finding;
use super::plant_response::{Point, median, median_phase_deg, of_one_magnitude, points};
use crate::measurement::{Measurement, ResponseKind};

/// Share of the points that are looked at, the lowest: resonances and the actuator's lag come above.
const LOWEST_SHARE: f64 = 1.0 / 6.0;

/// Fewest points that are looked at.
const FEWEST: usize = 4;

/// A velocity lags behind the input by at most 90° where the actuator still follows, a position by up
/// to 180°. Half of the points lag by more than this, degrees; the margin is for delay and for the
/// lags that real machines have.
const LARGEST_LAG_DEG: f64 = 150.0;

/// The steepest slope of a velocity there is −1 in logarithms, of a position −2.
const STEEPEST: f64 = -1.6;

pub(super) fn check(measurement: &Measurement) -> Option<Finding> {
    if measurement.metadata().response_kind != ResponseKind::Velocity {
        return None;
    }
    let points = of_one_magnitude(&points(measurement));
    let count = ((LOWEST_SHARE * points.len() as f64) as usize).max(FEWEST);
    let low = points.get(..count)?;
    let lag = -median_phase_deg(low, -90.0);
    let (first, last) = low.split_at(low.len().div_ceil(2));
    let middle = |half: &[Point]| {
        let gain = median(half.iter().map(|point| point.ratio.norm().ln()).collect());
        (median(half.iter().map(|point| point.omega_rad_s.ln()).collect()), gain)
    };
    let ((w0, g0), (w1, g1)) = (middle(first), middle(last));
    if w1 <= w0 {
        return None;
    }
    let slope = (g1 - g0) / (w1 - w0);
    (lag > LARGEST_LAG_DEG && slope < STEEPEST).then(|| Finding {
        sentence: format!(
            "at the lowest frequencies the response lags by {lag:.0}° and falls as ω^{slope:.1}; a \
             velocity lags by at most 90° and falls no faster than 1/ω there"
        ),
        remedy: "if the response is a position, say so: `--response \"position UNIT\"`, the query \
                 parameter `response`, or the line `# response: position UNIT`"
            .into(),
    })
}
