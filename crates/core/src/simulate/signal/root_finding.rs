//! Roots of functions of one variable within a bracket.

/// A step of [`newton`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Step {
    /// Where it led.
    pub to: f64,
    /// Its length.
    pub length: f64,
    /// Width of the bracket around the root.
    pub bracket: f64,
}

/// The root between `low` and `high` of a function that is not above 0 at `low` and above 0 at
/// `high`, by at most `steps` steps of Newton's method from `first`.
///
/// Each value narrows the bracket; a step that would leave it halves it instead (`rtsafe` of
/// Press, Teukolsky, Vetterling and Flannery, Numerical Recipes, 3rd ed., 2007, section 9.4).
/// `rising` gives value and slope, `is_last` says after which step to end.
pub(crate) fn newton(
    [mut low, mut high]: [f64; 2],
    first: f64,
    steps: usize,
    rising: impl Fn(f64) -> (f64, f64),
    is_last: impl Fn(Step) -> bool,
) -> f64 {
    let mut at = first;
    for _ in 0..steps {
        let (value, slope) = rising(at);
        if value == 0.0 {
            break;
        }
        if value > 0.0 {
            high = at;
        } else {
            low = at;
        }
        let newton = at - value / slope;
        let next = if newton >= low && newton <= high { newton } else { 0.5 * (low + high) };
        let length = (next - at).abs();
        at = next;
        if is_last(Step { to: at, length, bracket: high - low }) {
            break;
        }
    }
    at
}

/// The same from the middle of the bracket to 1e-13, for a bracket within the unit interval.
pub(crate) fn root(low: f64, high: f64, f: impl Fn(f64) -> f64, slope: impl Fn(f64) -> f64) -> f64 {
    let rising = |u: f64| (f(u), slope(u));
    newton([low, high], 0.5 * (low + high), 60, rising, |step| step.length <= 1e-13)
}

/// Halvings that find the top of a quintic: its value is then good to rounding.
const BISECTIONS: usize = 26;

/// The end of the stretch from `low` on which `holds`; it fails at `high`.
pub(crate) fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if holds(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_root_is_found_to_rounding_where_newton_alone_would_leave() {
        // From 3, Newton's method on the arc tangent goes to −9.5 and then away for ever.
        let arc = |x: f64| ((x - 0.25).atan(), 1.0 / (1.0 + (x - 0.25).powi(2)));
        let found = newton([-10.0, 4.0], 3.0, 60, arc, |step| step.length <= 1e-15);
        assert!((found - 0.25).abs() < 1e-14, "{found}");
    }

    #[test]
    fn a_first_guess_that_is_the_root_stays_as_it_is() {
        let flat = |x: f64| (x.powi(3), 3.0 * x * x);
        assert_eq!(newton([-1.0, 1.0], 0.0, 60, flat, |_| false), 0.0);
    }

    #[test]
    fn without_a_slope_the_bracket_is_halved() {
        let found = root(0.0, 1.0, |u| u - 0.3, |_| 0.0);
        assert!((found - 0.3).abs() < 1e-12, "{found}");
    }

    #[test]
    fn the_end_of_a_stretch_is_found_to_half_a_double() {
        let end = bisect(0.0, 1.0, |u| u < 0.7);
        assert!((end - 0.7).abs() < 1e-8, "{end}");
    }
}
