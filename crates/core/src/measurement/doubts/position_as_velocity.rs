//! A response that falls like a position but is called a velocity.

use super::finding::Finding;
use super::plant_response::{median, median_phase_deg, outer_thirds, points};
use crate::measurement::{Measurement, ResponseKind};

/// A velocity lags behind the input by at most 90° where the actuator still follows. A median lag
/// above this, degrees, in the lowest third of the points is that of a position; the margin is for
/// friction and delay.
const LARGEST_LAG_DEG: f64 = 120.0;

/// The steepest slope of a velocity there is −1 in logarithms; the margin is as large.
const STEEPEST: f64 = -1.3;

pub(super) fn check(measurement: &Measurement) -> Option<Finding> {
    if measurement.metadata().response_kind != ResponseKind::Velocity {
        return None;
    }
    let points = points(measurement);
    let [low, _] = outer_thirds(&points)?;
    let lag = -median_phase_deg(low, -90.0);
    let (first, last) = low.split_at(low.len().div_ceil(2));
    if last.is_empty() {
        return None;
    }
    let middle = |half: &[super::plant_response::Point]| {
        let gain = median(half.iter().map(|point| point.ratio.norm().ln()).collect());
        (median(half.iter().map(|point| point.omega_rad_s.ln()).collect()), gain)
    };
    let ((w0, g0), (w1, g1)) = (middle(first), middle(last));
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
