//! Samples that do not belong to the rest of their record.

use super::finding::Finding;
use crate::answers::Channel;
use crate::measurement::{BadSample, Measurement};

pub(super) fn check(measurement: &Measurement) -> Option<Finding> {
    let bad = measurement.experiments().iter().filter_map(|one| one.bad_samples.as_deref());
    let all: Vec<&BadSample> = bad.flat_map(|bad| &bad.samples).collect();
    let worst = all.iter().max_by(|a, b| a.sigmas.total_cmp(&b.sigmas))?;
    let channel = match worst.channel {
        Channel::Input => "input",
        Channel::Response => "response",
    };
    let line = worst.line.map_or(String::new(), |line| format!(" (line {line})"));
    let places = if all.len() == 1 { "one place" } else { &format!("{} places", all.len()) };
    Some(Finding {
        sentence: format!(
            "at {places} of the record samples do not belong to the rest: that of the {channel} at {:.6} \
             s{line} is {:.0} standard deviations off",
            worst.time_s, worst.sigmas
        ),
        remedy:
            "look for a disturbance of the wires or a fault of the transmission at these times; a \
                 diagnosis interpolates such samples"
                .into(),
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::measurement::{Metadata, Record, RecordStatement};

    fn measured(spike: f64) -> Measurement {
        let value = |n: u32| (TAU * f64::from(n) / 200.0).cos();
        let mut record = Record {
            time_s: (0..800).map(|n| f64::from(n) * 1e-3).collect(),
            input: (0..800).map(value).collect(),
            output: (0..800).map(|n| value(n) + 1e-3 * f64::from(n * n % 7)).collect(),
            run: None,
        };
        record.output[305] += spike;
        let (experiment, _) = record.experiment(RecordStatement::default()).unwrap();
        let (metadata, hash) = (Metadata::default(), String::new());
        Measurement::new(metadata, vec![experiment], Vec::new(), hash).unwrap()
    }

    #[test]
    fn a_sample_that_does_not_belong_is_doubted() {
        assert!(check(&measured(0.0)).is_none());
        let found = check(&measured(0.5)).unwrap();
        assert!(found.sentence.contains("of the response at 0.305000 s is"), "{}", found.sentence);
    }
}
