//! Event location: the position at which a slide ends, the first zero of the velocity within a
//! cell.

use crate::plant::Scalar;

use crate::simulate::signal::exponential_integrator::ExponentialIntegrator;
use crate::simulate::signal::piecewise_quintic::{Cell, restricted, slope, through, value};
use crate::simulate::signal::root_finding::{bisect, root};

/// A slide in one direction, in plain numbers.
pub(crate) struct Sliding {
    /// +1 forward, −1 backward.
    pub sign: f64,
    /// a, rad/s.
    pub rate: f64,
    /// The Coulomb level, with the direction's sign.
    pub friction: f64,
    /// Rounding error of x.
    pub rounding: f64,
}

impl Sliding {
    /// The position from `from` on at which the slide ends in the cell; `None` if it goes on. x is
    /// `start` at `from`, and would be `end` at the end of the cell.
    pub fn stop<S: Scalar>(&self, cell: &Cell<S>, from: f64, start: f64, end: f64) -> Option<f64> {
        let h = cell.length_s;
        let growth =
            |u: f64, x: f64| h * self.sign * (-self.rate * x + cell.number(u) - self.friction);
        // A slide that began within the cell starts at x = 0, and rounding may give x the wrong
        // sign at first. A stop found there would be followed by a breakaway at the same time,
        // without end.
        let fresh = start == 0.0;
        let crosses = self.sign * end < if fresh { -self.rounding } else { 0.0 };
        let begins = growth(from, start);
        if !crosses {
            // |x| may fall to zero between both ends, but only if its tangent does.
            let reaches = self.sign * start + begins * (1.0 - from) < 0.0;
            if fresh || !(begins < 0.0 && growth(1.0, end) > 0.0 && reaches) {
                return None;
            }
        }
        let powers = cell.powers.map(S::value);
        let x = |u: f64| {
            let mut driving = restricted(&powers, from, u);
            driving[0] -= self.friction;
            let length_s = (u - from) * h;
            ExponentialIntegrator::new(self.rate * length_s).step(start, &driving, length_s)
        };
        if crosses && !fresh {
            let first_guess = self.meets_zero(cell, (from, start), (1.0, end));
            let found = first_guess
                .and_then(|u| newton(u, (from, 1.0), x, |u, x| growth(u, x) * self.sign));
            if found.is_some() {
                return found;
            }
        }
        let (mut low, mut high) = (from, 1.0);
        if !crosses {
            high = bisect(low, high, |u| growth(u, x(u)) < 0.0);
            if self.sign * x(high) >= 0.0 {
                return None;
            }
        } else if fresh && begins > 0.0 {
            // |x| rises from zero and returns to it within the cell: search after its maximum.
            low = bisect(low, high, |u| growth(u, x(u)) > 0.0);
        }
        let fallen = |u: f64| -self.sign * x(u);
        Some(root(low, high, fallen, |u| -growth(u, x(u))))
    }

    /// The zero of the quintic through x and its two derivatives at both ends.
    fn meets_zero<S: Scalar>(
        &self,
        cell: &Cell<S>,
        (from, start): (f64, f64),
        (to, end): (f64, f64),
    ) -> Option<f64> {
        let (h, width) = (cell.length_s, to - from);
        let node = |u: f64, x: f64| {
            let first = h * (cell.number(u) - self.friction - self.rate * x);
            let second = h * (cell.number_slope(u) - self.rate * first);
            [self.sign * x, self.sign * first * width, self.sign * second * width * width]
        };
        let quintic = through(node(from, start), node(to, end));
        let falls = |u: f64| -value(&quintic, u);
        (falls(0.0) < 0.0 && falls(1.0) > 0.0)
            .then(|| from + width * root(0.0, 1.0, falls, |u| -slope(&quintic, u)))
    }
}

/// Newton's method from a good guess; `None` if it leaves the bracket or does not converge in five
/// steps.
fn newton(
    mut u: f64,
    (low, high): (f64, f64),
    f: impl Fn(f64) -> f64,
    slope: impl Fn(f64, f64) -> f64,
) -> Option<f64> {
    for _ in 0..5 {
        let value = f(u);
        let step = value / slope(u, value);
        u -= step;
        if !(u > low && u < high) {
            return None;
        }
        if step.abs() < 1e-10 {
            return Some(u);
        }
    }
    None
}
