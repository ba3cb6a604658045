//! Checks a stated period against the input.

use super::period::whole_if_nearly;
use super::period_drift;
use super::record_error::RecordError;
use super::repetition::Change;

/// Largest relative error of a stated period that is mended instead of refused: that of
/// 1/3 s printed with three digits (0.1 %), or of two clocks.
const MENDED: f64 = 1.5e-3;

/// Share of a second period that must be there to compare before a contradicting period is named,
/// and before the period counts as checked.
const COMPARED_SHARE: f64 = 0.5;

/// The period in samples to be used for the stated one, and a remark for the user if there is
/// something to say.
///
/// # Errors
/// If the input contradicts the stated period.
pub(super) fn checked(
    input: &[f64],
    period_s: f64,
    step_s: f64,
) -> Result<(f64, Option<String>), RecordError> {
    let stated = whole_if_nearly(period_s / step_s);
    let share = input.len() as f64 / stated - 1.0;
    let change = Change::of(input, stated);
    let not_repeating =
        |change: Change| RecordError::NotRepeating { period_s, percent: 100.0 * change.share };
    if let Some(found) = period_drift::contradicting(input, stated) {
        let found_s = six_digits(found * step_s);
        return match change {
            Some(change) if share < COMPARED_SHARE => Err(not_repeating(change)),
            _ if (found / stated - 1.0).abs() > MENDED => {
                Err(RecordError::OtherPeriod { period_s, found_s })
            }
            _ => Ok((
                found,
                Some(format!(
                    "the input repeats with {found_s} s, not with the period of {period_s} s that \
                     is given: {found_s} s is used"
                )),
            )),
        };
    }
    if let Some(change) = change.filter(|change| change.contradicts()) {
        return Err(not_repeating(change));
    }
    let percent = 100.0 * share.max(0.0);
    let remark = match change {
        _ if share >= COMPARED_SHARE => None,
        Some(_) => Some(format!(
            "the period of {period_s} s that is given is checked on {percent:.0} % of a second \
             period only: a wrong one may not show"
        )),
        None => Some(format!(
            "the period of {period_s} s that is given could not be checked: the record is too short"
        )),
    };
    Ok((stated, remark))
}

fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
