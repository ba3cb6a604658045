//! What looks wrong with a measurement, from the data alone: one file for each check.
//!
//! A check that finds something says what the data show and what to do. A new one takes a file and a
//! line in [`CHECKS`].

mod amplitude;
mod closed_loop;
mod one_direction;
mod plant_response;
mod position_as_velocity;
mod rising_phase;

use super::Measurement;
use crate::answers::ReadingDoubt;

/// What a check finds: what the data show, and what to do.
struct Finding {
    sentence: String,
    remedy: String,
}

/// A check: `None` if nothing looks wrong.
type Check = fn(&Measurement) -> Option<Finding>;

/// Every check, by its name in answers.
const CHECKS: &[(&str, Check)] = &[
    ("one_direction", one_direction::check),
    ("rising_phase", rising_phase::check),
    ("position_as_velocity", position_as_velocity::check),
    ("closed_loop", closed_loop::check),
    ("amplitude", amplitude::check),
];

impl Measurement {
    /// What looks wrong with the measurement, from the data alone; empty if nothing does.
    pub fn doubts(&self) -> Vec<ReadingDoubt> {
        let found = CHECKS.iter().filter_map(|(check, find)| {
            let Finding { sentence, remedy } = find(self)?;
            Some(ReadingDoubt { check: (*check).to_owned(), sentence, remedy })
        });
        found.collect()
    }
}

/// A share in per cent, with two significant digits.
pub(crate) fn per_cent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals =
        if percent > 0.0 { (1.0 - percent.log10().floor()).clamp(0.0, 9.0) } else { 0.0 };
    format!("{percent:.*} %", decimals as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_any_size_have_two_digits() {
        assert_eq!([0.0031, 0.00000234, 0.5].map(per_cent), ["0.31 %", "0.00023 %", "50 %"]);
    }
}
