//! How often causes are right, by their confidence.

use serde::Serialize;

use super::Wanted;
use crate::naming::judge::Outcome;
use crate::naming::rate::Rate;

/// Bounds of the bins of the confidence.
const CONFIDENCE_BOUNDS: [f64; 6] = [0.0, 0.5, 0.8, 0.9, 0.99, 1.0];
/// Lower bound of the bin with a target, and the share of its causes that must be right: 75–95 % of
/// those at a confidence of 0.8 to 0.9 (contract, section 4).
const CALIBRATION_TARGET: (f64, [f64; 2]) = (0.8, [0.75, 0.95]);

/// How often the causes in one range of confidence are right.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ConfidenceBin {
    /// Lowest confidence.
    pub from: f64,
    /// Highest confidence. This value belongs to the next bin, except for 1.
    pub to: f64,
    /// Mean confidence of the causes in the bin; null if it is empty.
    pub mean: Option<f64>,
    /// Rate of the causes that are right.
    pub right: Rate,
    /// The 95 % interval of that rate.
    pub interval95: [f64; 2],
    /// Whether the mean confidence lies within that interval; null if the bin is empty.
    pub calibrated: Option<bool>,
    /// Its target.
    pub wanted: Wanted,
}

/// The causes of all draws, small effects of a machine among them, by confidence. Those with a fault
/// of the measurement do not count.
pub(super) fn calibration(outcomes: &[Outcome]) -> Vec<ConfidenceBin> {
    let bin = |bounds: &[f64]| {
        let (from, to) = (bounds[0], bounds[1]);
        let within = |p: f64| p >= from && (p < to || (to >= 1.0 && p <= 1.0));
        let mut right = Rate::default();
        let mut sum = 0.0;
        for outcome in outcomes.iter().filter(|outcome| !outcome.kind.is_mismeasured()) {
            for cause in outcome.causes().iter().filter(|cause| within(cause.confidence)) {
                right.add(outcome.is_hidden(&cause.effect));
                sum += cause.confidence;
            }
        }
        let mean = (right.of > 0).then(|| sum / f64::from(right.of));
        let (asked_from, shares) = CALIBRATION_TARGET;
        let wanted = if from == asked_from { Wanted::Between(shares) } else { Wanted::Nothing };
        let interval95 = right.interval95();
        let calibrated = mean.map(|mean| (interval95[0]..=interval95[1]).contains(&mean));
        ConfidenceBin { from, to, mean, right, interval95, calibrated, wanted }
    };
    CONFIDENCE_BOUNDS.windows(2).map(bin).collect()
}

#[cfg(test)]
mod tests {
    use servoscope_core::answers::Verdict;

    use super::*;
    use crate::naming::fixtures::{machine, outcome};

    #[test]
    fn a_bin_is_calibrated_where_its_mean_lies_in_the_interval_of_its_rate() {
        let rate = |hits, of| Rate { hits, of };
        let sure = |right: bool| {
            let named = if right { "spring" } else { "cogging" };
            let causes = [(named, 0.85, &[][..])];
            outcome("single-60-spring-o0-0", &["spring"], &causes, Verdict::Explained)
        };
        // Four of ten: at most 0.74 by the exact interval.
        let ten: Vec<Outcome> = (0..10).map(|i| sure(i < 4)).collect();
        let bin = calibration(&ten)[2];
        assert_eq!((bin.right, bin.calibrated), (rate(4, 10), Some(false)));
        assert_eq!(bin.interval95, bin.right.interval95());
        let bin = calibration(&(0..10).map(|i| sure(i < 8)).collect::<Vec<_>>())[2];
        assert_eq!((bin.right, bin.calibrated), (rate(8, 10), Some(true)));
    }

    #[test]
    fn a_small_effect_of_a_machine_is_a_right_cause() {
        let hidden = ["spring", "stribeck"];
        let causes = [("spring", 0.9, &[][..]), ("stribeck", 0.95, &[]), ("backlash", 0.92, &[])];
        let bin = calibration(&[machine("machine-60-spring-o0-0", 1, &hidden, &causes)])[3];
        assert_eq!(bin.right, Rate { hits: 2, of: 3 });
        let nothing = calibration(&[])[3];
        assert_eq!((nothing.mean, nothing.calibrated), (None, None));
    }
}
