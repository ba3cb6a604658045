//! Numbers with as many digits as they deserve.

/// Decimal digits that a double holds.
const DIGITS_OF_DOUBLE: i32 = 15;

/// How a value and what belongs to it are written: to the second digit of the
/// value's deviation, all with the same power of ten.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rounding {
    /// Power of ten taken out; 0 for sizes that are read easily without.
    exponent: i32,
    /// Power of ten of the last digit written.
    place: i32,
}

impl Rounding {
    /// Rounding of a value with a standard deviation; `None` where one of them
    /// is not a number to go by.
    pub(super) fn of(value: f64, std: f64) -> Option<Self> {
        let exponent = exponent(value).or_else(|| exponent(std))?;
        let place = self::exponent(std)? - 1;
        let taken_out = if (-3..6).contains(&exponent) { 0 } else { exponent };
        Some(Self { exponent: taken_out, place: place.max(exponent + 1 - DIGITS_OF_DOUBLE) })
    }

    /// Writes the value, its deviation or an end of its interval.
    pub(super) fn write(self, number: f64) -> String {
        let Self { exponent, place } = self;
        let unit = 10.0_f64.powi(place);
        // Beyond the point the formatting rounds, and better than this does.
        let number = if place > exponent { (number / unit).round() * unit } else { number };
        let decimals = (exponent - place).max(0) as usize;
        match exponent {
            0 => format!("{number:.decimals$}"),
            _ if number == 0.0 => "0".to_owned(),
            _ => format!("{:.decimals$}e{exponent}", number / 10.0_f64.powi(exponent)),
        }
    }

    /// Significant digits that this gives `value`.
    pub(super) fn digits(self, value: f64) -> usize {
        exponent(value).map_or(1, |exponent| (exponent - self.place + 1).max(1) as usize)
    }
}

/// Decimal exponent of a number that has one.
fn exponent(number: f64) -> Option<i32> {
    let sized = number != 0.0 && number.is_finite();
    sized.then(|| number.abs().log10().floor() as i32)
}

/// A number with so many significant digits.
pub(super) fn digits(value: f64, digits: usize) -> String {
    let Some(exponent) = exponent(value) else { return format!("{value}") };
    if !(-4..6).contains(&exponent) {
        return format!("{value:.*e}", digits - 1);
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// The same without trailing zeros.
pub(super) fn significant(value: f64, digits: usize) -> String {
    let text = self::digits(value, digits);
    let (mantissa, power) = text.split_at(text.find('e').unwrap_or(text.len()));
    format!("{}{power}", without_trailing_zeros(mantissa))
}

fn without_trailing_zeros(text: &str) -> &str {
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounded(value: f64, std: f64) -> [String; 2] {
        let rounding = Rounding::of(value, std).unwrap();
        [rounding.write(value), rounding.write(std)]
    }

    #[test]
    fn a_value_ends_where_its_deviation_does() {
        assert_eq!(rounded(-10.02345, 0.031), ["-10.023", "0.031"]);
        assert_eq!(rounded(10.0, 0.0027), ["10.0000", "0.0027"]);
        assert_eq!(rounded(-10.0000001, 1.4e-7), ["-10.00000010", "0.00000014"]);
        assert_eq!(rounded(12345.6, 251.0), ["12350", "250"]);
        assert_eq!(rounded(0.0, 0.02), ["0.000", "0.020"]);
    }

    #[test]
    fn very_large_and_very_small_values_share_a_power_of_ten() {
        assert_eq!(rounded(1.0248e-7, 1.5e-10), ["1.0248e-7", "0.0015e-7"]);
        assert_eq!(rounded(2.5e6, 3.0e4), ["2.500e6", "0.030e6"]);
        assert_eq!(rounded(0.0, 8.6e-6), ["0", "8.6e-6"]);
    }

    #[test]
    fn more_digits_than_a_double_holds_are_not_written() {
        assert_eq!(rounded(1.0, 1e-30)[0], "1.00000000000000");
    }

    #[test]
    fn without_a_deviation_there_is_nothing_to_round_to() {
        assert_eq!(Rounding::of(1.0, 0.0), None);
        assert_eq!(Rounding::of(1.0, f64::NAN), None);
    }

    #[test]
    fn numbers_keep_their_significant_digits_at_any_size() {
        assert_eq!(significant(0.00123456, 3), "0.00123");
        assert_eq!(significant(-123.456, 4), "-123.5");
        assert_eq!(significant(1.5e-7, 2), "1.5e-7");
        assert_eq!(significant(2.5e6, 6), "2.5e6");
        assert_eq!(significant(100000.0, 6), "100000");
        assert_eq!(significant(0.0, 6), "0");
        assert_eq!([digits(730.0, 4), digits(2.5e6, 4)], ["730.0", "2.500e6"]);
    }
}
