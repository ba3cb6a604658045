//! Steps of the Runge–Kutta pair of orders 5 and 4 of Dormand and Prince (1980,
//! doi:10.1016/0771-050X(80)90013-3), with its continuous extension of order 4 (Hairer, Nørsett,
//! Wanner 1993, Solving Ordinary Differential Equations I, II.6).

use crate::plant::Scalar;

/// State of a motion, or its derivative by time.
pub(super) type Vector<S, const M: usize> = [S; M];

/// Positions of stages 2 to 6 within a step.
pub(super) const NODES: [f64; 5] = [0.2, 0.3, 0.8, 8.0 / 9.0, 1.0];

const A2: [f64; 1] = [0.2];
const A3: [f64; 2] = [3.0 / 40.0, 9.0 / 40.0];
const A4: [f64; 3] = [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0];
const A5: [f64; 4] = [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0];
const A6: [f64; 5] =
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0];
const A7: [f64; 6] =
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0];

/// Weights of the error estimate: the difference of the formulas of orders 5 and 4.
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339_200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// Weights of the highest coefficient of the continuous extension.
const DENSE: [f64; 7] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];

/// One step.
pub(super) struct Stages<S, const M: usize> {
    pub length_s: f64,
    pub start: Vector<S, M>,
    /// State at the end.
    pub end: Vector<S, M>,
    /// Derivatives by time at every stage.
    pub slopes: [Vector<S, M>; 7],
}

impl<S: Scalar, const M: usize> Stages<S, M> {
    /// A step from `start`, where the derivative is `slope`, over `length_s`. `f` gives the
    /// derivative at a stage, numbered 0 … 4 as in [`NODES`], for the state there.
    #[inline]
    pub fn new(
        start: &Vector<S, M>,
        slope: &Vector<S, M>,
        length_s: f64,
        f: impl Fn(usize, &Vector<S, M>) -> Vector<S, M>,
    ) -> Self {
        let mut this =
            Self { length_s, start: *start, end: *start, slopes: [[S::constant(0.0); M]; 7] };
        this.slopes[0] = *slope;
        this.slopes[1] = f(0, &this.moved(&A2));
        this.slopes[2] = f(1, &this.moved(&A3));
        this.slopes[3] = f(2, &this.moved(&A4));
        this.slopes[4] = f(3, &this.moved(&A5));
        this.slopes[5] = f(4, &this.moved(&A6));
        this.end = this.moved(&A7);
        this.slopes[6] = f(4, &this.end);
        this
    }

    /// The start plus the first slopes with these weights, times the length.
    #[inline(always)]
    fn moved<const W: usize>(&self, weights: &[f64; W]) -> Vector<S, M> {
        // Loops, since `array::from_fn` is not inlined.
        let mut state = self.start;
        for (i, entry) in state.iter_mut().enumerate() {
            let mut sum = self.slopes[0][i] * (weights[0] * self.length_s);
            for (slope, weight) in self.slopes.iter().zip(weights).skip(1) {
                if *weight != 0.0 {
                    sum += slope[i] * (*weight * self.length_s);
                }
            }
            *entry += sum;
        }
        state
    }

    /// Estimated error at the end, as a share of `scale`; the largest of all states.
    #[inline]
    pub fn error(&self, scale: &[f64; M]) -> f64 {
        (0..M)
            .map(|i| {
                let sum: f64 =
                    self.slopes.iter().zip(ERROR).map(|(slope, e)| e * slope[i].value()).sum();
                (self.length_s * sum / scale[i]).abs()
            })
            .fold(0.0, f64::max)
    }

    /// The step without derivatives.
    pub fn values(&self) -> Stages<f64, M> {
        let of = |vector: &Vector<S, M>| vector.map(S::value);
        Stages {
            length_s: self.length_s,
            start: of(&self.start),
            end: of(&self.end),
            slopes: self.slopes.each_ref().map(of),
        }
    }

    /// Coefficients of state `i` over the step as a polynomial in u, 0 to 1.
    #[inline]
    pub fn powers(&self, i: usize) -> [S; 5] {
        let (h, start) = (self.length_s, self.start[i]);
        let change = self.end[i] - start;
        let first = self.slopes[0][i] * h - change;
        let second = change - self.slopes[6][i] * h - first;
        let mut last = self.slopes[0][i] * DENSE[0];
        for (slope, weight) in self.slopes.iter().zip(DENSE).skip(2) {
            last += slope[i] * weight;
        }
        let last = last * h;
        [start, change + first, second + last - first, -(second + last * 2.0), last]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Error at the end and in the middle of one step of x' = −x + t.
    fn errors(h: f64) -> (f64, f64) {
        let exact = |t: f64| 2.0 * (-t).exp() + t - 1.0;
        let start = [1.0];
        let f = |t: f64, x: &Vector<f64, 1>| [t - x[0]];
        let slope = f(0.0, &start);
        let step = Stages::new(&start, &slope, h, |stage, x| f(NODES[stage] * h, x));
        let middle = crate::simulate::signal::piecewise_quintic::polynomial(&step.powers(0), 0.5);
        ((step.end[0] - exact(h)).abs(), (middle - exact(0.5 * h)).abs())
    }

    #[test]
    fn ends_are_of_fifth_order_and_the_extension_of_fourth() {
        let (coarse, fine) = (errors(0.2), errors(0.1));
        // Local errors are of one order more: ratios 2⁶ and 2⁵.
        assert!(coarse.0 / fine.0 > 50.0, "{coarse:?} {fine:?}");
        assert!(coarse.1 / fine.1 > 25.0, "{coarse:?} {fine:?}");
    }
}
