//! Sizes that numbers can be computed with.
//!
//! An answer has parameters whose units are powers of those of the upload. The highest is that of
//! a cubic stiffness, input/position³ = input·ω³/velocity³. With every value between 10^±40, every
//! frequency between 10^±20 rad/s, and a velocity made of an acceleration (10^±60), that lies
//! within 10^±280, and so within what a floating-point number holds (10^±308).

/// Largest value of an input or a response, in its unit, and one over the smallest.
pub(super) const LARGEST_VALUE: f64 = 1e40;

/// Largest frequency, rad/s (of records, the sampling rate in 1/s), and one over the smallest.
pub(super) const LARGEST_FREQUENCY: f64 = 1e20;

/// Largest ratio of a deviation to the largest response, and one over the smallest: the weights
/// of the data are its squares, and products of two of them are computed.
pub(super) const LARGEST_DEVIATION: f64 = 1e20;

/// What is wrong with the size of a value, in words; 0 is right.
pub(super) fn fault(what: &str, value: f64) -> Option<String> {
    beyond(what, value, LARGEST_VALUE)
}

/// What is wrong with the size of a frequency, in words.
pub(super) fn frequency_fault(what: &str, value: f64) -> Option<String> {
    beyond(what, value, LARGEST_FREQUENCY)
}

fn beyond(what: &str, value: f64, largest: f64) -> Option<String> {
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
