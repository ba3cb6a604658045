//! Complex numbers whose real and imaginary parts may carry derivatives.

use std::ops::{Add, Mul, Sub};

use crate::measurement::Complex;
use crate::plant::Scalar;

/// re + j·im.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ComplexDual<S> {
    pub re: S,
    pub im: S,
}

impl<S: Scalar> ComplexDual<S> {
    pub fn new(re: S, im: S) -> Self {
        Self { re, im }
    }

    pub fn real(re: S) -> Self {
        Self { re, im: S::constant(0.0) }
    }

    /// The value without the derivatives.
    pub fn value(self) -> Complex {
        Complex::new(self.re.value(), self.im.value())
    }

    /// The derivative along direction `lane`.
    pub fn lane(self, lane: usize) -> Complex {
        Complex::new(self.re.lane(lane), self.im.lane(lane))
    }

    /// f(self) by the chain rule, from the value and the derivative of an analytic f at `self`.
    pub fn chain(self, value: Complex, slope: Complex) -> Self {
        let lane = |l: usize| slope * self.lane(l);
        Self {
            re: S::with_lanes(value.re, |l| lane(l).re),
            im: S::with_lanes(value.im, |l| lane(l).im),
        }
    }

    pub fn exp(self) -> Self {
        let value = self.value().exp();
        self.chain(value, value)
    }

    pub fn scaled(self, factor: S) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    pub fn inverse(self) -> Self {
        let size = self.re * self.re + self.im * self.im;
        Self { re: self.re / size, im: -self.im / size }
    }
}

impl<S: Scalar> Add for ComplexDual<S> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl<S: Scalar> Sub for ComplexDual<S> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl<S: Scalar> Mul for ComplexDual<S> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

impl<S: Scalar> Mul<Complex> for ComplexDual<S> {
    type Output = Self;
    fn mul(self, other: Complex) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}
