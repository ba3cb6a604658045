//! Checks that samples are equally spaced, and finds the sampling interval.

use std::collections::BTreeMap;

use super::record_error::RecordError;

/// Largest accepted distance of a sample from the regular grid, as a share of the step.
const JITTER: f64 = 1e-3;

/// Largest rounding error of printed times that is accepted in addition, as a share of the step.
/// It is below one half because a missing sample looks like an error of half a step.
const LARGEST_ROUNDING: f64 = 0.35;

/// Step of equally spaced times, s, by least squares over all of them.
///
/// A sample may be off the grid by [`JITTER`] times the step plus the rounding error that the
/// number of printed decimals explains. Numbers of so many significant digits have fewer decimals the
/// larger they are.
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
    let is_regular = |rounding_s: &dyn Fn(f64) -> f64| {
        time_s.iter().enumerate().all(|(index, time)| {
            let departure = (time - offset_s - index as f64 * step_s).abs();
            departure <= JITTER * step_s + rounding_s(*time)
        })
    };
    if is_regular(&|_| 0.0) {
        return Ok(step_s);
    }
    let resolutions = resolutions(time_s);
    let largest = LARGEST_ROUNDING * step_s;
    match is_regular(&|time| (0.5 * resolutions[&decade(time)]).min(largest)) {
        true => Ok(step_s),
        false => Err(unequal(time_s)),
    }
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

/// Power of ten of the first digit of a time, s.
fn decade(time_s: f64) -> i32 {
    time_s.abs().max(f64::MIN_POSITIVE).log10().floor() as i32
}

/// Value of the last decimal place by [`decade`]: that of the time which is printed with the most decimals.
fn resolutions(time_s: &[f64]) -> BTreeMap<i32, f64> {
    let mut most = BTreeMap::new();
    for time in time_s {
        let text = time.to_string();
        let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let of_decade = most.entry(decade(*time)).or_insert(0);
        *of_decade = decimals.max(*of_decade);
    }
    let place = |decimals: usize| 10f64.powi(-i32::try_from(decimals).unwrap_or(i32::MAX));
    most.into_iter().map(|(decade, decimals)| (decade, place(decimals))).collect()
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
    fn times_of_so_many_significant_digits_are_equally_spaced() {
        // 1.5 kHz for 12 s; from 10 s on, six digits tell a seventh of a step.
        for digits in [6, 7] {
            let printed = |index: u32| format!("{:.*e}", digits - 1, f64::from(index) / 1500.0);
            let times: Vec<f64> =
                (0..18_000).map(|index| printed(index).parse().unwrap()).collect();
            assert!((step_s(&times).unwrap() * 1500.0 - 1.0).abs() < 1e-5);
            let mut lost = times;
            lost.remove(17_000);
            assert!(step_s(&lost).is_err(), "{digits}");
        }
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
