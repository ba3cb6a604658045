//! Dual numbers for forward-mode automatic differentiation (Wengert 1964,
//! doi:10.1145/355586.364791).
//!
//! The simulation is written once for any [`Scalar`]. With `f64` it computes the response. With
//! [`Dual`] every operation also applies the chain rule, so that the same code computes the
//! response and its derivatives along N directions, exact to rounding. A *lane* is one of the N
//! directions.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// A real number that may carry derivatives.
pub trait Scalar:
    Copy
    + Debug
    + Default
    + Send
    + Sync
    + PartialEq
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
    + SubAssign
{
    /// Number of derivatives that the number carries.
    const LANES: usize;

    /// A constant: all its derivatives are 0.
    fn constant(value: f64) -> Self;

    /// The value without the derivatives.
    fn value(self) -> f64;

    /// The derivative along direction `lane`; 0 from [`Self::LANES`] on.
    fn lane(self, lane: usize) -> f64;

    /// A number with this value and the derivative `lane(i)` along each direction i.
    fn with_lanes(value: f64, lane: impl Fn(usize) -> f64) -> Self;

    /// f(self) by the chain rule, from the value and the slope of f at `self`.
    fn chain(self, value: f64, slope: f64) -> Self {
        Self::with_lanes(value, |lane| slope * self.lane(lane))
    }

    /// exp(self).
    fn exp(self) -> Self {
        let value = self.value().exp();
        self.chain(value, value)
    }

    /// √self.
    fn sqrt(self) -> Self {
        let value = self.value().sqrt();
        self.chain(value, 0.5 / value)
    }

    /// (sin self, cos self).
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value().sin_cos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }
}

impl Scalar for f64 {
    const LANES: usize = 0;

    fn constant(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn lane(self, _lane: usize) -> f64 {
        0.0
    }

    fn with_lanes(value: f64, _lane: impl Fn(usize) -> f64) -> Self {
        value
    }
}

/// A value and its derivatives along N directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<const N: usize> {
    value: f64,
    lanes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// An independent variable: its derivative is 1 along direction `lane` and 0 along the others.
    ///
    /// # Panics
    /// If `lane` ≥ N.
    pub fn variable(value: f64, lane: usize) -> Self {
        let mut this = Self::constant(value);
        this.lanes[lane] = 1.0;
        this
    }
}

/// Builds an array entry by entry. The plain loop vectorises; `array::from_fn` is not inlined here.
#[inline(always)]
fn each<const N: usize>(f: impl Fn(usize) -> f64) -> [f64; N] {
    let mut array = [0.0; N];
    for (i, entry) in array.iter_mut().enumerate() {
        *entry = f(i);
    }
    array
}

impl<const N: usize> Default for Dual<N> {
    fn default() -> Self {
        Self::constant(0.0)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    const LANES: usize = N;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value, lanes: [0.0; N] }
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self.lanes.get(lane).copied().unwrap_or(0.0)
    }

    #[inline(always)]
    fn with_lanes(value: f64, lane: impl Fn(usize) -> f64) -> Self {
        Self { value, lanes: each(lane) }
    }

    #[inline(always)]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, lanes: each(|i| slope * self.lanes[i]) }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, lanes: each(|i| -self.lanes[i]) }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let lanes = each(|i| self.lanes[i] + other.lanes[i]);
        Self { value: self.value + other.value, lanes }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let lanes = each(|i| self.lanes[i] - other.lanes[i]);
        Self { value: self.value - other.value, lanes }
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule")]
    fn mul(self, other: Self) -> Self {
        let lanes = each(|i| self.lanes[i] * other.value + self.value * other.lanes[i]);
        Self { value: self.value * other.value, lanes }
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let scale = 1.0 / other.value;
        // Dividing, rather than multiplying by `scale`, gives the same value as `f64` arithmetic.
        let value = self.value / other.value;
        let lanes = each(|i| (self.lanes[i] - value * other.lanes[i]) * scale);
        Self { value, lanes }
    }
}

impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Self { value: self.value + other, ..self }
    }
}

impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Self { value: self.value - other, ..self }
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Self { value: self.value * other, lanes: each(|i| self.lanes[i] * other) }
    }
}

impl<const N: usize> AddAssign for Dual<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> SubAssign for Dual<N> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_formula() {
        let (x, y) = (Dual::<2>::variable(0.7, 0), Dual::<2>::variable(1.9, 1));
        let (sin, cos) = (x * y).sin_cos();
        let f = (x / y).exp() * sin - cos.sqrt_of_square() + y.sqrt() * 3.0 - x + 1.0;
        let numeric = |dx: f64, dy: f64| {
            let (x, y) = (0.7 + dx, 1.9 + dy);
            (x / y).exp() * (x * y).sin() - (x * y).cos().abs() + y.sqrt() * 3.0 - x + 1.0
        };
        let h = 1e-6;
        assert!((f.value() - numeric(0.0, 0.0)).abs() < 1e-15);
        // Error of a central difference: h² times the third derivative, and rounding over h.
        assert!((f.lane(0) - (numeric(h, 0.0) - numeric(-h, 0.0)) / (2.0 * h)).abs() < 1e-9);
        assert!((f.lane(1) - (numeric(0.0, h) - numeric(0.0, -h)) / (2.0 * h)).abs() < 1e-9);
        assert_eq!(f.lane(2), 0.0);
    }

    impl Dual<2> {
        fn sqrt_of_square(self) -> Self {
            (self * self).sqrt()
        }
    }
}
