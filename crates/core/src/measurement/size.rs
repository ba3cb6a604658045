//! Limits on the size of uploaded numbers that keep later computations from overflowing.
//!
//! The units of fitted parameters are products of powers of the upload's units. The highest powers
//! are those of a cubic stiffness, input/position³ = input·ω³/velocity³. Values lie within 10^±40,
//! frequencies within 10^±20 rad/s, and so a velocity computed from an acceleration within 10^±60.
//! The stiffness is then within 10^±280, which a floating-point number can hold (10^±308).

/// Largest absolute value of an input or a response, in its unit; the inverse is the smallest.
pub(super) const LARGEST_VALUE: f64 = 1e40;

/// Largest frequency, rad/s (for time records the sampling rate, 1/s); the inverse is the
/// smallest.
pub(super) const LARGEST_FREQUENCY: f64 = 1e20;

/// Largest ratio of a standard deviation to the largest response; the inverse is the smallest. The
/// weights of the data are its inverse squares, and products of two weights must not overflow.
pub(super) const LARGEST_DEVIATION: f64 = 1e20;

/// The message for a value that is too large or too small; 0 is accepted.
pub(super) fn fault(what: &str, value: f64) -> Option<String> {
    range_fault(what, value, LARGEST_VALUE)
}

/// The message for a frequency that is too large or too small.
pub(super) fn frequency_fault(what: &str, value: f64) -> Option<String> {
    range_fault(what, value, LARGEST_FREQUENCY)
}

fn range_fault(what: &str, value: f64, largest: f64) -> Option<String> {
    let size = value.abs();
    if size == 0.0 || (1.0 / largest..=largest).contains(&size) {
        return None;
    }
    let side = if size > largest { "large" } else { "small" };
    Some(format!(
        "{what} of {value:e} is too {side} to be computed with (from {:e} to {largest:e}): give it \
         in another unit",
        1.0 / largest
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_of_thirty_decades_either_way_are_accepted_and_those_beyond_forty_refused_by_name() {
        for size in [0.0, 1e-30, -1e-30, 1.0, 1e30] {
            assert_eq!(fault("the magnitude", size), None);
        }
        let said = fault("the magnitude", 1e-300).unwrap();
        assert!(said.starts_with("the magnitude of 1e-300 is too small"), "{said}");
        assert!(fault("the response", -1e150).unwrap().contains("too large"));
        assert!(fault("the response", f64::NAN).is_some());
    }
}
