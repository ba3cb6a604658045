//! Checks that samples are equally spaced, and finds the sampling interval.

use super::record_error::RecordError;

/// Largest accepted distance of a sample from the regular grid, as a share of the step.
const JITTER: f64 = 1e-3;

/// Largest rounding error of printed times that is accepted in addition, as a share of the step.
/// It is below one half because a missing sample looks like an error of half a step.
const LARGEST_ROUNDING: f64 = 0.35;

/// Step of equally spaced times, s, by least squares over all of them.
///
/// A sample may be off the grid by [`JITTER`] times the step plus the rounding error that the
/// number of printed decimals explains.
///
/// # Errors
/// If times do not increase or are not equally spaced; the error names the sample.
pub(super) fn step_s(time_s: &[f64]) -> Result<f64, RecordError> {
    if let Some(index) = time_s.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(RecordError::NotIncreasing {
            sample: index + 1,
            time_s: time_s[index + 1],
            before_s: time_s[index],
        });
    }
    if time_s.len() < 2 {
        return Err(RecordError::TooShort { samples: time_s.len() });
    }
    let (offset_s, step_s) = grid(time_s);
    let departure = time_s
        .iter()
        .enumerate()
        .map(|(index, time)| (time - offset_s - index as f64 * step_s).abs())
        .fold(0.0, f64::max);
    let tolerance = JITTER * step_s;
    if departure <= tolerance {
        return Ok(step_s);
    }
    let rounding = (0.5 * resolution(time_s)).min(LARGEST_ROUNDING * step_s);
    if departure <= tolerance + rounding {
        return Ok(step_s);
    }
    Err(unequal(time_s))
}

/// Origin and step of the line through the times, by least squares.
fn grid(time_s: &[f64]) -> (f64, f64) {
    let count = time_s.len() as f64;
    let centre = (count - 1.0) / 2.0;
    let first = time_s[0];
    let mean = time_s.iter().map(|time| time - first).sum::<f64>() / count;
    let covariance: f64 = time_s
        .iter()
        .enumerate()
        .map(|(index, time)| (index as f64 - centre) * (time - first - mean))
        .sum();
    let variance = count * (count * count - 1.0) / 12.0;
    let step = covariance / variance;
    (first + mean - centre * step, step)
}

/// Value of the last decimal place, by the time that is printed with the most decimals.
fn resolution(time_s: &[f64]) -> f64 {
    let decimals = |time: &f64| {
        let text = time.to_string();
        text.split_once('.').map_or(0, |(_, decimals)| decimals.len())
    };
    let most = time_s.iter().map(decimals).max().unwrap_or(0);
    10f64.powi(-i32::try_from(most).unwrap_or(i32::MAX))
}

/// The error that names the sample after the step that differs most from the median step.
fn unequal(time_s: &[f64]) -> RecordError {
    let steps: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut sorted = steps.clone();
    sorted.sort_by(f64::total_cmp);
    let usual_s = sorted[sorted.len() / 2];
    let worst = (0..steps.len())
        .max_by(|a, b| (steps[*a] - usual_s).abs().total_cmp(&(steps[*b] - usual_s).abs()))
        .unwrap_or(0);
    RecordError::UnequalSampling { sample: worst + 1, step_s: steps[worst], usual_s }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounded(step_s: f64, decimals: i32, count: usize) -> Vec<f64> {
        let unit = 10f64.powi(decimals);
        (0..count).map(|index| (index as f64 * step_s * unit).round() / unit).collect()
    }

    #[test]
    fn times_rounded_in_print_are_equally_spaced() {
        // 3 kHz in tenths of a millisecond: steps of 3 and 4 units.
        let step = step_s(&rounded(1.0 / 3000.0, 4, 5000)).unwrap();
        // Rounding errors of ±0.5 units at both ends, over 5000 samples.
        assert!((step * 3000.0 - 1.0).abs() < 1e-4);
    }

    #[test]
    fn a_lost_sample_is_found_wherever_it_was() {
        for lost in [1, 700, 1000, 1998] {
            for (step, decimals) in [(1e-3, 3), (4e-4, 4), (1.0 / 3000.0, 4), (1.0 / 3000.0, 12)] {
                let mut times = rounded(step, decimals, 2000);
                times.remove(lost);
                assert!(
                    matches!(step_s(&times), Err(RecordError::UnequalSampling { sample, .. })
                        if sample == lost),
                    "{lost} {step} {decimals}"
                );
            }
        }
    }

    #[test]
    fn a_time_that_stands_still_is_named() {
        let error = step_s(&[0.0, 1.0, 1.0, 2.0]).unwrap_err();
        assert_eq!(error, RecordError::NotIncreasing { sample: 2, time_s: 1.0, before_s: 1.0 });
    }

    #[test]
    fn jitter_beyond_a_thousandth_of_the_step_is_refused() {
        let mut times: Vec<f64> = (0..100).map(f64::from).collect();
        times[50] += 0.8e-3 + 1e-16;
        assert!(step_s(&times).is_ok());
        times[50] += 0.8e-3 + 1.234_567_8e-9;
        assert!(step_s(&times).is_err());
    }
}
