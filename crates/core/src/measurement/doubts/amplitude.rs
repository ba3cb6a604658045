//! Stated magnitudes and measured inputs differ by a factor of two conventions of an amplitude.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

use super::finding::Finding;
use super::plant_response::median;
use crate::measurement::{Experiment, Measurement};

/// Ratios of two conventions, with what the measured input would then be.
const RATIOS: [(f64, &str, &str); 4] = [
    (FRAC_1_SQRT_2, "1/√2", "an rms value where the magnitude is a peak"),
    (SQRT_2, "√2", "a peak where the magnitude is an rms value"),
    (2.0, "2", "a peak-to-peak value where the magnitude is a peak"),
    (0.5, "1/2", "a peak where the magnitude is a peak-to-peak value"),
];

/// Largest relative deviation from such a ratio.
const TOLERANCE: f64 = 0.02;

pub(super) fn check(measurement: &Measurement) -> Option<Finding> {
    let ratios: Vec<f64> = measurement.experiments().iter().filter_map(ratio).collect();
    let ratio = median(ratios);
    let (_, text, meaning) =
        RATIOS.into_iter().find(|(exact, _, _)| (ratio / exact - 1.0).abs() < TOLERANCE)?;
    Some(Finding {
        sentence: format!(
            "the measured input (`u_re`, `u_im`) is {text} of the stated magnitude: {meaning}"
        ),
        remedy: "bring both to one convention, and state it: `--amplitude rms` or the line `# \
                 amplitude: rms`; where they differ, leave the magnitude out"
            .into(),
    })
}

/// Measured amplitude of a single line of the input over the stated magnitude.
fn ratio(experiment: &Experiment) -> Option<f64> {
    let mut lines = experiment.input.iter().skip(1).filter(|u| u.norm() > 0.0);
    let only = lines.next().filter(|_| lines.next().is_none())?;
    (experiment.magnitude > 0.0).then(|| only.norm() / experiment.magnitude)
}
