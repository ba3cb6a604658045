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

/// Numbers of unsettled periods that are tried one by one.
const TRIED_EACH: usize = 16;

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
                 by {:.1} % of its root mean square: it has not settled, or it drifts. The \
                 parameters and the verdict may then be wrong: give more settle_periods, or record \
                 for longer",
                100.0 * share
            )),
        }
    }
}

/// Number of periods at the beginning that have not settled, if at least `MIN_OTHER_PERIODS` + 1
/// settled ones follow; else 0.
///
/// Each number that is tried looks at all periods after it. A response settles once, so beyond
/// `TRIED_EACH` the number is doubled until the rest has settled, and then found by bisection.
pub(super) fn unsettled_periods(spectra: &[Vec<Complex>]) -> usize {
    let end = spectra.len().saturating_sub(MIN_OTHER_PERIODS);
    let settled = |dropped: usize| ratio(&spectra[dropped..]).is_none();
    if let Some(dropped) = (0..end.min(TRIED_EACH)).find(|dropped| settled(*dropped)) {
        return dropped;
    }
    let doubled = std::iter::successors(Some(TRIED_EACH), |dropped| Some(2 * dropped));
    let Some(mut enough) = doubled.take_while(|dropped| *dropped < end).find(|d| settled(*d))
    else {
        return 0;
    };
    let mut too_few = (enough / 2).max(TRIED_EACH - 1);
    while enough - too_few > 1 {
        let middle = too_few + (enough - too_few) / 2;
        match settled(middle) {
            true => enough = middle,
            false => too_few = middle,
        }
    }
    enough
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Periods of one line each, the first `unsettled` of which fall to the settled value, less and
    /// less far from it.
    fn falling(count: usize, unsettled: usize) -> Vec<Vec<Complex>> {
        let turn = |n: usize| Complex::from_polar(1e-3, n as f64);
        let far = |n: usize| 10.0 * unsettled.saturating_sub(n) as f64;
        (0..count).map(|n| vec![Complex::ZERO, Complex::from(far(n)) + turn(n)]).collect()
    }

    #[test]
    fn all_unsettled_periods_are_found_however_many_they_are() {
        for unsettled in [0, 1, 2, 15, 16, 17, 31, 40, 100, 300] {
            assert_eq!(unsettled_periods(&falling(20_000, unsettled)), unsettled);
        }
    }
}
