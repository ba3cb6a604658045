//! The exact response of a first-order lag to a quintic, by the φ-functions of exponential
//! integrators (Hochbruck and Ostermann 2010, doi:10.1017/S0962492910000048).
//!
//! A step of length h of y' = −λy + q, where q has the coefficients cᵢ, takes y to
//! exp(−z)·y + h·Σ cᵢφᵢ(z), with z = λh and φᵢ(z) = ∫₀¹ uⁱ exp(−z(1 − u)) du. For |z| ≤ 7 the power
//! series of φ₆ converges without loss of digits, and the recursion φᵢ₋₁ = (1 − zφᵢ)/i is stable
//! downwards. For larger |z| the recursion is stable upwards. The derivatives are φᵢ' = φᵢ₊₁ − φᵢ.

use std::ops::{Add, Div, Mul, Sub};

use crate::measurement::Complex;
use crate::plant::Scalar;

use super::complex_dual::ComplexDual;
use super::piecewise_quintic::Quintic;

/// For |z| above this the recursion runs upwards.
const UPWARD_RECURSION_ABOVE: f64 = 7.0;

/// The factors of a step: exp(−z) for the state, and φᵢ for each power of the input.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ExponentialIntegrator<T> {
    kept: T,
    gains: [T; 6],
}

impl<S: Scalar> ExponentialIntegrator<S> {
    /// The factors of a step of z = λh.
    #[inline]
    pub fn new(z: S) -> Self {
        let number = z.value();
        let phi = if number > UPWARD_RECURSION_ABOVE {
            upwards(number, (1.0 - (-number).exp()) / number, 1.0)
        } else {
            downwards(number, series(number, number.abs(), 1.0), 1.0)
        };
        let gains = std::array::from_fn(|i| z.chain(phi[i], phi[i + 1] - phi[i]));
        Self { kept: (-z).exp(), gains }
    }

    /// The state after a step of `length_s` under the input `powers`.
    #[inline]
    pub fn step(&self, state: S, powers: &Quintic<S>, length_s: S) -> S {
        let mut gained = powers[0] * self.gains[0];
        for (power, gain) in powers.iter().zip(&self.gains).skip(1) {
            gained += *power * *gain;
        }
        state * self.kept + gained * length_s
    }
}

impl<S: Scalar> ExponentialIntegrator<ComplexDual<S>> {
    /// The same for a complex λ.
    pub fn complex(z: ComplexDual<S>) -> Self {
        let number = z.value();
        let one = Complex::new(1.0, 0.0);
        let phi = if number.norm() > UPWARD_RECURSION_ABOVE {
            upwards(number, (one - (-number).exp()) / number, one)
        } else {
            downwards(number, series(number, number.norm(), one), one)
        };
        let gains = std::array::from_fn(|i| z.chain(phi[i], phi[i + 1] - phi[i]));
        let kept = ComplexDual::new(-z.re, -z.im).exp();
        Self { kept, gains }
    }

    /// The state after a step of `length_s` under a real input.
    pub fn step(
        &self,
        state: ComplexDual<S>,
        powers: &Quintic<S>,
        length_s: f64,
    ) -> ComplexDual<S> {
        let mut gained = self.gains[0].scaled(powers[0]);
        for (gain, power) in self.gains.iter().zip(powers).skip(1) {
            gained = gained + gain.scaled(*power);
        }
        state * self.kept + gained.scaled(S::constant(length_s))
    }
}

/// φ₆(z) = Σ (−z)ᵐ·6!/(m + 7)!.
fn series<T>(z: T, size: f64, one: T) -> T
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T> + Mul<f64, Output = T>,
{
    let (mut term, mut left) = (one * (1.0 / 7.0), 1.0 / 7.0);
    let mut sum = term;
    for m in 1..60 {
        let ratio = 1.0 / f64::from(m + 7);
        term = term * z * -ratio;
        left *= size * ratio;
        sum = sum + term;
        if left < 1e-17 {
            break;
        }
    }
    sum
}

/// φ₀ … φ₆ from φ₆.
fn downwards<T>(z: T, last: T, one: T) -> [T; 7]
where
    T: Copy + Sub<Output = T> + Mul<Output = T> + Mul<f64, Output = T>,
{
    let mut phi = [last; 7];
    for i in (0..6).rev() {
        phi[i] = (one - z * phi[i + 1]) * (1.0 / (i + 1) as f64);
    }
    phi
}

/// φ₀ … φ₆ from φ₀.
fn upwards<T>(z: T, first: T, one: T) -> [T; 7]
where
    T: Copy + Sub<Output = T> + Div<Output = T> + Mul<f64, Output = T>,
{
    let mut phi = [first; 7];
    for i in 1..7 {
        phi[i] = (one - phi[i - 1] * i as f64) / z;
    }
    phi
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::Dual;

    /// ∫₀¹ uⁱ exp(−z(1 − u)) du by Simpson's rule on 2000 intervals.
    fn quadrature(i: i32, z: f64) -> f64 {
        let count = 2000;
        let f = |n: usize| {
            let u = n as f64 / count as f64;
            u.powi(i) * (-z * (1.0 - u)).exp()
        };
        let inner: f64 = (1..count).map(|n| if n % 2 == 1 { 4.0 * f(n) } else { 2.0 * f(n) }).sum();
        (f(0) + inner + f(count)) / (3.0 * count as f64)
    }

    #[test]
    fn gains_are_their_integrals_for_small_and_large_steps() {
        for z in [0.0, 1e-6, 0.3, 2.0, 6.9, 7.1, 40.0] {
            let relaxation = ExponentialIntegrator::new(z);
            for i in 0..6 {
                let wanted = quadrature(i as i32, z);
                assert!((relaxation.gains[i] - wanted).abs() < 2e-8, "{z} {i}");
            }
            let complex = ExponentialIntegrator::complex(ComplexDual::real(z));
            assert!((complex.gains[3].re - relaxation.gains[3]).abs() < 1e-14);
        }
    }

    #[test]
    fn derivatives_follow_the_length_of_the_step() {
        for z in [0.2, 5.0, 9.0] {
            let relaxation = ExponentialIntegrator::new(Dual::<1>::variable(z, 0));
            let step = 1e-5;
            let (up, down) =
                (ExponentialIntegrator::new(z + step), ExponentialIntegrator::new(z - step));
            for i in 0..6 {
                let numeric = (up.gains[i] - down.gains[i]) / (2.0 * step);
                // Error of a central difference: step², and rounding over the step.
                assert!((relaxation.gains[i].lane(0) - numeric).abs() < 1e-9, "{z} {i}");
            }
        }
    }
}
