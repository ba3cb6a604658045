//! Spherical Bessel functions j_d(x) for x up to 16.

/// x^d/(2d + 1)!!, an upper bound of |j_d(x)| (Abramowitz and Stegun, 10.1.2 and 10.1.14).
pub(super) fn first_term(d: usize, x: f64) -> f64 {
    (1..=d).fold(1.0, |product, i| product * x / (2 * i + 1) as f64)
}

/// j_d(x) by its power series (Abramowitz and Stegun, 10.1.2). The terms alternate and are largest for
/// d = 0, at most sinh(x)/x, so that at x = 16 rounding errs by less than 1e-10.
pub(super) fn spherical(d: usize, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for m in 1.. {
        term *= -0.5 * x * x / (m * (2 * (d + m) + 1)) as f64;
        sum += term;
        if term.abs() < 1e-17 * sum.abs() {
            break;
        }
    }
    first_term(d, x) * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_of_bessel_is_the_closed_form() {
        for x in [0.3, 1.5, 3.9, 16.0_f64] {
            let (sin, cos) = x.sin_cos();
            let closed = [
                sin / x,
                sin / (x * x) - cos / x,
                (3.0 / x.powi(3) - 1.0 / x) * sin - 3.0 * cos / (x * x),
            ];
            for (d, closed) in closed.into_iter().enumerate() {
                // The closed form loses digits at small x, the series at large x.
                let tolerance = if x < 4.0 { 1e-13 } else { 1e-10 };
                assert!((spherical(d, x) - closed).abs() < tolerance, "j_{d}({x})");
            }
        }
    }
}
