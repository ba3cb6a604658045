//! What looks wrong with a measurement, from the data alone: one file for each check.
//!
//! A check that finds something says what the data show and what to do. A new one takes a file and a
//! line in [`CHECKS`].

mod amplitude;
mod bad_samples;
mod clipping;
mod closed_loop;
mod finding;
mod one_direction;
mod plant_response;
mod position_as_velocity;
mod rising_phase;

use super::Measurement;
use crate::answers::ReadingDoubt;

pub(crate) use finding::per_cent;

use finding::Finding;

/// A check: `None` if nothing looks wrong.
type Check = fn(&Measurement) -> Option<Finding>;

/// Every check, by its name in answers.
const CHECKS: &[(&str, Check)] = &[
    ("one_direction", one_direction::check),
    ("rising_phase", rising_phase::check),
    ("position_as_velocity", position_as_velocity::check),
    ("closed_loop", closed_loop::check),
    ("bad_samples", bad_samples::check),
    ("clipping", clipping::check),
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
