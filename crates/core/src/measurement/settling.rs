//! Finds periods at the beginning of a record in which the response has not settled.

use super::Complex;
use super::repetition::Change;
use super::spectrum::{mean_and_deviations, power};

/// Fewest periods besides the first whose scatter the first is compared with.
const MIN_OTHER_PERIODS: usize = 3;

/// The first period has not settled if its deviation from the mean exceeds that of the others by
/// this factor. Tuned: deviations due to noise alone are nearly equal, since each is a sum over
/// all lines.
const UNSETTLED_RATIO: f64 = 2.5;

/// Change of the response from the first period to the last, as a share of its root mean square,
/// above which the user is told if it is smooth. A smaller change moves parameters by about as
/// little.
const CHANGE_SHARE: f64 = 0.01;

/// What is known of the beginning of the periods that are used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Beginning {
    /// Nothing speaks against it.
    Settled,
    /// The first period deviates from the mean this many times as far as the others.
    Unsettled(f64),
    /// The response changes smoothly by this share from the first period to the last.
    Changing(f64),
}

impl Beginning {
    /// Of the last periods of a response with `samples` samples each.
    pub(super) fn of(spectra: &[Vec<Complex>], output: &[f64], samples: f64) -> Self {
        let count = spectra.len();
        if let Some(times) = Some(spectra).filter(|_| count > MIN_OTHER_PERIODS).and_then(ratio) {
            return Self::Unsettled(times);
        }
        let used = (samples * count as f64).ceil() as usize;
        let used = &output[output.len() - used.min(output.len())..];
        // White noise is as smooth as this with a probability below 1e-4 (see `repetition`).
        Change::of(used, samples * count.saturating_sub(1) as f64)
            .filter(|change| count > 1 && change.share > CHANGE_SHARE && change.is_smooth())
            .map_or(Self::Settled, |change| Self::Changing(change.share))
    }

    /// The remark for the user.
    pub(super) fn remark(self, count: usize) -> Option<String> {
        match self {
            Self::Settled => None,
            Self::Unsettled(times) => Some(format!(
                "the response of the first period departs from the mean {times:.1} times as far as \
                 that of the others: it has not settled; give more settle_periods"
            )),
            Self::Changing(share) => Some(format!(
                "from the first of the {count} periods to the last the response changes smoothly \
                 by {:.1} % of its root mean square: it has not settled, or drifts; parameters and \
                 verdict suffer from it; give more settle_periods, or record for longer",
                100.0 * share
            )),
        }
    }
}

/// Number of periods at the beginning that have not settled, if at least `MIN_OTHER_PERIODS` + 1
/// settled ones follow; else 0.
pub(super) fn unsettled_periods(spectra: &[Vec<Complex>]) -> usize {
    (0..spectra.len().saturating_sub(MIN_OTHER_PERIODS))
        .find(|dropped| ratio(&spectra[*dropped..]).is_none())
        .unwrap_or(0)
}

/// Ratio of the first period's deviation from the mean to the others' root mean square deviation;
/// `None` if scatter alone explains it.
fn ratio(spectra: &[Vec<Complex>]) -> Option<f64> {
    let (_, deviations) = mean_and_deviations(spectra);
    let powers: Vec<f64> = deviations.iter().map(|deviation| power(deviation)).collect();
    let (first, others) = powers.split_first()?;
    let largest = others.iter().copied().fold(0.0, f64::max);
    let mean = others.iter().sum::<f64>() / others.len() as f64;
    let times = (first / mean).sqrt();
    (times > UNSETTLED_RATIO && *first > largest).then_some(times)
}
