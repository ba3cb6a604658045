//! What a check finds.

/// What a check finds: what the data show, and what to do.
pub(super) struct Finding {
    pub(super) sentence: String,
    pub(super) remedy: String,
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
