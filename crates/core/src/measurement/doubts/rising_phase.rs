//! The phase rises with frequency, as that of a conjugated response does.

use super::finding::Finding;
use super::plant_response::{median_phase_deg, outer_thirds, points};
use crate::measurement::Measurement;

/// Least share of the points at which the response leads.
const LEADING_SHARE: f64 = 0.75;

/// Least rise of the phase from the lowest to the highest third of the points, degrees.
const LEAST_RISE_DEG: f64 = 10.0;

pub(super) fn check(measurement: &Measurement) -> Option<Finding> {
    let points = points(measurement);
    let [low, high] = outer_thirds(&points)?;
    let leading = points.iter().filter(|point| point.ratio.im > 0.0).count();
    // A spring leads at low frequencies, too, but its phase falls.
    let begin = median_phase_deg(low, 0.0);
    let end = median_phase_deg(high, 90.0);
    let is_rising = leading as f64 > LEADING_SHARE * points.len() as f64;
    (is_rising && end > begin + LEAST_RISE_DEG).then(|| Finding {
        sentence: format!(
            "the phase from input to velocity rises from {begin:.0}° to {end:.0}° over the band; that \
             of a machine falls"
        ),
        remedy: "the response seems to be conjugated, as with the convention exp(−jωt), or input and \
                 response seem to be exchanged: change the sign of the phase (of `im`), or exchange \
                 them"
            .into(),
    })
}
