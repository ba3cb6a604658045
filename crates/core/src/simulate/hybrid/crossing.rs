//! Zero crossings of a signal within a step: halving finds a bracket, regula falsi the root.

/// For a signal that is 0 at position 0 and positive at `end`: a position between at which it is
/// negative, found by halving; 0 if there is none.
pub(super) fn departure(signal: &impl Fn(f64) -> f64, end: f64) -> f64 {
    let mut at = 0.5 * end;
    for _ in 0..24 {
        if signal(at) < 0.0 {
            return at;
        }
        at *= 0.5;
    }
    0.0
}

/// The root of a signal that is ≤ 0 at `low` and > 0 at `high`, by the Illinois variant of regula
/// falsi (Dowell, Jarratt 1971, doi:10.1007/BF01934364).
pub(super) fn root(mut low: f64, mut high: f64, signal: impl Fn(f64) -> f64) -> f64 {
    let (mut below, mut above) = (signal(low), signal(high));
    let mut last = 0;
    let mut at = 0.5 * (low + high);
    for _ in 0..60 {
        if high - low < 1e-13 {
            break;
        }
        let share = below / (below - above);
        at = if share.is_finite() { low + share * (high - low) } else { 0.5 * (low + high) };
        let there = signal(at);
        // This is the root to rounding, even if the other end of the bracket is still far away.
        if there.abs() < 1e-15 * above.abs().max(below.abs()) {
            break;
        }
        if there > 0.0 {
            (high, above) = (at, there);
            if last == 1 {
                below *= 0.5;
            }
            last = 1;
        } else {
            (low, below) = (at, there);
            if last == -1 {
                above *= 0.5;
            }
            last = -1;
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_is_found_where_the_signal_turns_positive() {
        let root = root(0.0, 1.0, |u| u * u * u - 0.3);
        assert!((root - 0.3_f64.cbrt()).abs() < 1e-12, "{root}");
    }

    // The first secant of a straight line gives its root to rounding, wherever that is.
    #[test]
    fn the_root_of_a_straight_line_is_found_to_rounding() {
        for step in 1..1000 {
            let expected = 0.25 + 0.000_125 * f64::from(step);
            for slope in [1.0, 4.2e-4, 0.29] {
                let root = root(0.25, 0.375, |u| slope * u - slope * expected);
                assert!((root - expected).abs() < 1e-14, "{root} for {expected}");
            }
        }
    }

    #[test]
    fn a_signal_that_begins_at_zero_is_followed_from_where_it_is_negative() {
        let signal = |u: f64| u * (u - 0.01);
        let from = departure(&signal, 1.0);
        assert!(from > 0.0 && signal(from) < 0.0);
        assert!((root(from, 1.0, signal) - 0.01).abs() < 1e-12);
        assert_eq!(departure(&|u: f64| u, 1.0), 0.0);
    }
}
