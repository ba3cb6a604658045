//! A response that repeats the end of its range, as a channel that clips does.

use super::finding::{Finding, per_cent};
use crate::measurement::Measurement;

pub(super) fn check(measurement: &Measurement) -> Option<Finding> {
    let clipping = measurement.experiments().iter().filter_map(|one| one.clipping.as_deref());
    let share = clipping.map(|clipping| clipping.response_share).fold(0.0, f64::max);
    (share > 0.0).then(|| Finding {
        sentence: format!(
            "{} of the samples of the velocity are its largest or smallest value, and hardly any lies \
             just inside: the channel seems to clip",
            per_cent(share)
        ),
        remedy: "measure again with a larger range of this channel, or with a smaller input".into(),
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::measurement::{Metadata, Record, RecordStatement};

    fn measured(highest: f64) -> Measurement {
        let value = |n: u32| (TAU * f64::from(n) / 200.0).cos();
        let record = Record {
            time_s: (0..800).map(|n| f64::from(n) * 1e-3).collect(),
            input: (0..800).map(value).collect(),
            output: (0..800).map(|n| value(n).min(highest)).collect(),
            run: None,
        };
        let (experiment, _) = record.experiment(RecordStatement::default()).unwrap();
        let (metadata, hash) = (Metadata::default(), String::new());
        Measurement::new(metadata, vec![experiment], Vec::new(), hash).unwrap()
    }

    #[test]
    fn a_velocity_that_repeats_its_largest_value_is_doubted() {
        assert!(check(&measured(2.0)).is_none());
        // A cosine is above 0.8 for a share of 0.205; 41 of 200 samples.
        let found = check(&measured(0.8)).unwrap();
        assert!(found.sentence.starts_with("20 % of the samples"), "{}", found.sentence);
    }
}
