//! Noise of a measurement: how large it is, what is said of it, and how it is added.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use crate::measurement::{Complex, Harmonic, Repeat};

/// How a measurement states its noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoiseStatement {
    /// As a standard deviation of every harmonic.
    Std,
    /// Through M repeats (at least 2) of every experiment, from which it has to be estimated. The
    /// noise of each repeat is √M times larger, so that their mean is as noisy as with `Std`.
    Repeats(usize),
    /// Not at all.
    Silent,
}

/// Noise relative to the responses that it is added to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RelativeNoise {
    /// N: the additive part has a standard deviation of median|Y₁|·10^(−N/20), with the median
    /// over all experiments. dB.
    pub floor_db: f64,
    /// Standard deviation of the proportional part, as a share of |Yₖ|.
    pub share: f64,
}

impl RelativeNoise {
    /// Noise of "N dB": the same in every harmonic, without a proportional part.
    pub fn decibels(floor_db: f64) -> Self {
        Self { floor_db, share: 0.0 }
    }

    /// The law of this noise in these responses, each Y₀, Y₁ …; `None` if at least half of them
    /// are stuck, so that the floor would be 0.
    pub fn law(&self, responses: &[Vec<Complex>]) -> Option<NoiseLaw> {
        let floor = noise_std(responses, self.floor_db)?;
        Some(NoiseLaw { floor, share: self.share })
    }
}

/// How the noise of a harmonic depends on its size: σ² = floor² + (share·|Yₖ|)², for each of re
/// and im (re alone of harmonic 0). Both parts are independent of each other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NoiseLaw {
    /// Standard deviation of the additive part, response units.
    pub floor: f64,
    /// Standard deviation of the proportional part, as a share of |Yₖ|.
    pub share: f64,
}

impl NoiseLaw {
    /// Noise of the same standard deviation in every harmonic, response units.
    pub fn uniform(std: f64) -> Self {
        Self { floor: std, share: 0.0 }
    }

    /// Standard deviation of a harmonic whose exact value has this size; both in response units.
    pub fn std_of(&self, size: f64) -> f64 {
        self.floor.hypot(self.share * size)
    }

    /// The harmonics of a response, each with the standard deviation of its noise but without
    /// noise.
    pub fn stated(&self, exact: &[Complex]) -> Vec<Harmonic> {
        harmonics(exact, |value| Some(self.std_of(value.norm())))
    }

    /// Adds noise to an exact response Y₀, Y₁ …; returns its harmonics and the deviations of the
    /// repeats.
    pub fn observe(
        &self,
        exact: &[Complex],
        statement: NoiseStatement,
        rng: &mut ChaCha8Rng,
    ) -> (Vec<Harmonic>, Vec<Repeat>) {
        match statement {
            NoiseStatement::Std => {
                let mut stated = self.stated(exact);
                let values = self.noisy(exact, 1.0, rng);
                stated.iter_mut().zip(values).for_each(|(harmonic, value)| harmonic.value = value);
                (stated, Vec::new())
            }
            NoiseStatement::Silent => {
                (harmonics(&self.noisy(exact, 1.0, rng), |_| None), Vec::new())
            }
            NoiseStatement::Repeats(count) => {
                let factor = (count as f64).sqrt();
                let drawn: Vec<_> = (0..count).map(|_| self.noisy(exact, factor, rng)).collect();
                let mean: Vec<Complex> = (0..exact.len())
                    .map(|k| drawn.iter().map(|repeat| repeat[k]).sum::<Complex>() / count as f64)
                    .collect();
                let deviation = |repeat: Vec<Complex>| Repeat {
                    input: Vec::new(),
                    response: repeat.iter().zip(&mean).map(|(value, mean)| value - mean).collect(),
                };
                let repeats = drawn.into_iter().map(deviation).collect();
                (harmonics(&mean, |_| None), repeats)
            }
        }
    }

    /// The response with `factor` times the noise on re and im of every harmonic (on re alone of
    /// the mean).
    fn noisy(&self, exact: &[Complex], factor: f64, rng: &mut ChaCha8Rng) -> Vec<Complex> {
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let scattered = |(order, value): (usize, &Complex)| {
            let std = self.std_of(value.norm()) * factor;
            let re = std * normal();
            let im = if order == 0 { 0.0 } else { std * normal() };
            value + Complex::new(re, im)
        };
        exact.iter().enumerate().map(scattered).collect()
    }
}

/// Adds noise of the standard deviation `std` (response units), the same in every harmonic, to an
/// exact response; returns its harmonics and the deviations of the repeats. `None`: no noise, and
/// none stated.
pub fn observe(
    exact: &[Complex],
    std: Option<f64>,
    statement: NoiseStatement,
    rng: &mut ChaCha8Rng,
) -> (Vec<Harmonic>, Vec<Repeat>) {
    match std {
        Some(std) => NoiseLaw::uniform(std).observe(exact, statement, rng),
        None => (silent(exact), Vec::new()),
    }
}

/// The harmonics of a response without noise, of which nothing is said.
pub(super) fn silent(exact: &[Complex]) -> Vec<Harmonic> {
    harmonics(exact, |_| None)
}

fn harmonics(values: &[Complex], std: impl Fn(&Complex) -> Option<f64>) -> Vec<Harmonic> {
    let harmonic =
        |(order, value): (usize, &Complex)| Harmonic { order, value: *value, std: std(value) };
    values.iter().enumerate().map(harmonic).collect()
}

/// median|Y₁|·10^(−N/20), if it is positive.
pub fn noise_std(responses: &[Vec<Complex>], noise_db: f64) -> Option<f64> {
    let mut fundamentals: Vec<f64> =
        responses.iter().map(|response| response.get(1).map_or(0.0, |y| y.norm())).collect();
    fundamentals.sort_by(f64::total_cmp);
    let middle = fundamentals.len() / 2;
    let median = match fundamentals.len() {
        0 => 0.0,
        count if count % 2 == 1 => fundamentals[middle],
        _ => 0.5 * (fundamentals[middle - 1] + fundamentals[middle]),
    };
    (median > 0.0).then(|| median * 10.0_f64.powf(-noise_db / 20.0))
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    const LAW: NoiseLaw = NoiseLaw { floor: 0.001, share: 0.01 };

    fn response() -> Vec<Complex> {
        [(0.02, 0.0), (3.0, -4.0), (0.0, 0.0)].map(|(re, im)| Complex::new(re, im)).into()
    }

    #[test]
    fn both_parts_of_the_noise_add_as_squares() {
        // 1 % of 5 is 0.05; of nothing the floor is left.
        let expected =
            [(0.000_2_f64.powi(2) + 1e-6).sqrt(), (0.05_f64.powi(2) + 1e-6).sqrt(), 1e-3];
        for (harmonic, std) in LAW.stated(&response()).iter().zip(expected) {
            assert!((harmonic.std.unwrap() / std - 1.0).abs() < 1e-12, "{harmonic:?}");
        }
    }

    #[test]
    fn without_a_proportional_part_the_noise_is_its_floor_to_the_bit() {
        for std in [1.234_567_890_123e-7, 0.1, 3.3, 7.7e5] {
            let sizes = [0.0, 1e-9, 1.0, 1e9];
            assert!(sizes.iter().all(|size| NoiseLaw::uniform(std).std_of(*size) == std));
        }
    }

    #[test]
    fn the_floor_is_relative_to_the_median_fundamental() {
        let of = |size: f64| vec![Complex::new(9.0, 0.0), Complex::new(0.0, size)];
        let noise = RelativeNoise { floor_db: 60.0, share: 0.004 };
        let law = noise.law(&[of(1.0), of(50.0), of(2.0)]).unwrap();
        assert!((law.floor / 0.002 - 1.0).abs() < 1e-12 && law.share == 0.004);
        assert_eq!(noise.law(&[of(0.0), of(0.0), of(2.0)]), None);
    }

    #[test]
    fn the_scatter_follows_the_law_whatever_is_said_of_it() {
        let exact = response();
        let rng = &mut ChaCha8Rng::seed_from_u64(1);
        let count = 2_000;
        for statement in [NoiseStatement::Std, NoiseStatement::Silent, NoiseStatement::Repeats(4)] {
            let mut squares = [0.0; 3];
            for _ in 0..count {
                let (found, _) = LAW.observe(&exact, statement, rng);
                for (sum, (found, exact)) in squares.iter_mut().zip(found.iter().zip(&exact)) {
                    *sum += (found.value - exact).norm_sqr();
                }
            }
            for (order, sum) in squares.into_iter().enumerate() {
                let parts = if order == 0 { 1.0 } else { 2.0 } * f64::from(count);
                let std = LAW.std_of(exact[order].norm());
                // The rms of n normal values has a relative standard error of 1/√(2n); 4 times
                // that.
                let margin = 4.0 / (2.0 * parts).sqrt();
                let found = (sum / parts).sqrt();
                assert!((found / std - 1.0).abs() < margin, "{statement:?} {order}: {found}");
            }
        }
    }
}
