//! Taylor series in time of nonlinear functions of a motion.
//!
//! The coefficients follow by recurrences, each from those before it (Moore 1979, Methods and
//! Applications of Interval Analysis, doi:10.1137/1.9781611970906).

use super::law::LAW_PARAMETERS;

/// Largest number of coefficients of a series.
pub const MOST_TERMS: usize = 13;

/// 1/m for m > 0.
const INVERSE: [f64; MOST_TERMS] = {
    let mut inverse = [0.0; MOST_TERMS];
    let mut m = 1;
    while m < MOST_TERMS {
        inverse[m] = 1.0 / m as f64;
        m += 1;
    }
    inverse
};

/// Coefficients of a series, that of t⁰ first.
pub type Terms = [f64; MOST_TERMS];

/// The Taylor series of a law and its derivatives along a motion, and of its argument x.
#[derive(Debug, Clone, Copy)]
pub struct TaylorSeries {
    /// The argument x: θ if the law uses it, otherwise v.
    pub argument: Terms,
    /// Sign of v, +1 or −1. At a breakaway v is 0 and does not tell it.
    pub direction: f64,
    /// The law f.
    pub value: Terms,
    /// ∂f/∂x.
    pub by_argument: Terms,
    /// ∂f/∂p for each parameter p.
    pub by_parameter: [Terms; LAW_PARAMETERS],
    /// Whether the derivatives by the parameters are needed.
    pub parameters_vary: bool,
    /// Intermediate series that the law needs for its next coefficient, such as a sine.
    pub kept: [Terms; 3],
}

impl TaylorSeries {
    /// Series without any coefficient yet.
    pub fn new(parameters_vary: bool) -> Self {
        let none = [0.0; MOST_TERMS];
        Self {
            argument: none,
            direction: 0.0,
            value: none,
            by_argument: none,
            by_parameter: [none; LAW_PARAMETERS],
            parameters_vary,
            kept: [none; 3],
        }
    }

    /// The series of a motion that is `share` times as fast: coefficient m times share^m.
    pub fn slow_down(&mut self, share: f64) {
        let [sin, cos, rates] = &mut self.kept;
        let [first, second, third] = &mut self.by_parameter;
        let all = [&mut self.argument, &mut self.value, &mut self.by_argument];
        for terms in all.into_iter().chain([first, second, third, sin, cos, rates]) {
            let mut scale = 1.0;
            for term in terms {
                *term *= scale;
                scale *= share;
            }
        }
    }
}

/// Coefficient `m` of the product of two series.
#[inline]
pub fn product(a: &Terms, b: &Terms, m: usize) -> f64 {
    a[..=m].iter().zip(b[..=m].iter().rev()).map(|(a, b)| a * b).sum()
}

/// Coefficients `m` > 0 of the sine s and the cosine c of a series x, from those below `m`:
/// m·sₘ = Σᵢ i·xᵢ·cₘ₋ᵢ and m·cₘ = −Σᵢ i·xᵢ·sₘ₋ᵢ, i = 1 … m. `rates` holds i·xᵢ.
#[inline]
pub fn sin_cos(rates: &Terms, sin: &Terms, cos: &Terms, m: usize) -> (f64, f64) {
    let (mut rise, mut fall) = (0.0, 0.0);
    let before = sin[..m].iter().zip(&cos[..m]).rev();
    for (rate, (sin, cos)) in rates[1..=m].iter().zip(before) {
        rise += rate * cos;
        fall += rate * sin;
    }
    (rise * INVERSE[m], -fall * INVERSE[m])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x = 0.3 + 0.5 t − 0.2 t².
    fn series() -> Terms {
        let mut x = [0.0; MOST_TERMS];
        x[..3].copy_from_slice(&[0.3, 0.5, -0.2]);
        x
    }

    fn sum(terms: &Terms, t: f64) -> f64 {
        terms.iter().rev().fold(0.0, |sum, term| sum * t + term)
    }

    #[test]
    fn the_taylor_series_of_a_sine_sums_to_the_sine() {
        let x = series();
        let rates = std::array::from_fn(|m| m as f64 * x[m]);
        let (mut sin, mut cos) = ([0.0; MOST_TERMS], [0.0; MOST_TERMS]);
        (sin[0], cos[0]) = x[0].sin_cos();
        for m in 1..MOST_TERMS {
            (sin[m], cos[m]) = sin_cos(&rates, &sin, &cos, m);
        }
        // The first omitted term is of order 0.3¹³.
        let exact = sum(&x, 0.3).sin_cos();
        assert!((sum(&sin, 0.3) - exact.0).abs() < 2e-7, "{}", sum(&sin, 0.3) - exact.0);
        assert!((sum(&cos, 0.3) - exact.1).abs() < 2e-7, "{}", sum(&cos, 0.3) - exact.1);
    }

    #[test]
    fn the_taylor_series_of_a_product_sums_to_the_product() {
        let x = series();
        let square: Terms = std::array::from_fn(|m| product(&x, &x, m));
        // A product of parabolas has five coefficients, so that the series is exact.
        assert!((sum(&square, 0.7) - sum(&x, 0.7).powi(2)).abs() < 1e-15);
    }
}
