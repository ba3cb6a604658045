//! The lines of an input that runs in a known way between its samples.

use std::f64::consts::PI;

use super::{Complex, Intersample};

impl Intersample {
    /// Line `k` of an input of which a period has this many samples, over that line of its samples:
    /// sin(x)/x·exp(−jx) where it is held and (sin(x)/x)² where it runs straight, x = πk/N. The
    /// images of the lines beyond the Nyquist frequency are left out. (A. Oppenheim, R. Schafer,
    /// *Discrete-Time Signal Processing*, 3rd ed. 2010, section 4.8.)
    pub(crate) fn factor(self, k: usize, samples: f64) -> Complex {
        let x = PI * k as f64 / samples;
        let sinc = if k == 0 { 1.0 } else { x.sin() / x };
        match self {
            Self::Hold => Complex::from_polar(sinc, -x),
            Self::Linear => Complex::new(sinc * sinc, 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Fourier coefficients by 1000 midpoints of each interval: an error of (2π·7/16000)²/24 = 3e-7.
    #[test]
    fn the_lines_are_those_of_steps_and_of_straight_lines_through_the_samples() {
        for k in [0_usize, 1, 3, 7] {
            let at = |n: f64| Complex::from_polar(1.0, std::f64::consts::TAU * k as f64 * n / 16.0);
            let line = |course: &dyn Fn(u32, f64) -> Complex| {
                let value = |n: u32| {
                    let part = (f64::from(n % 1000) + 0.5) / 1000.0;
                    course(n / 1000, part) * at(f64::from(n / 1000) + part).conj()
                };
                (0..16_000).map(value).sum::<Complex>() / 16_000.0
            };
            let held = line(&|n, _| at(f64::from(n)));
            let straight =
                line(&|n, part| at(f64::from(n)) * (1.0 - part) + at(f64::from(n + 1)) * part);
            for (expected, course) in [(held, Intersample::Hold), (straight, Intersample::Linear)] {
                assert!((course.factor(k, 16.0) - expected).norm() < 1e-6, "{k} {course:?}");
            }
        }
    }
}
