//! A position that moves on from period to period.
//!
//! Where nothing holds an axis and its friction is asymmetric, or its input has a mean, it moves on
//! while it oscillates: y(t) = p(t) + r·t with p of the period T of the input. The jump r·T at the
//! end of each period adds about r·T/(πk) to every harmonic k, which a model without it would take
//! for a response. So the uniform part is taken out, and r is kept as the mean velocity.

use super::spectrum::Periods;

/// Standard errors by which the means of periods must move on. Of white noise, one record in
/// 10 000 does.
const SIGNIFICANT: f64 = 4.0;

/// Distances below this share of the largest value are rounding errors.
const ROUNDING_SHARE: f64 = 1e-12;

/// Smallest distance that the user is told of, as a share of the largest value.
const TOLD_SHARE: f64 = 1e-3;

/// How many times the largest jump within a single period that at its end must be. The seam itself is
/// not within: a smooth motion may be a little more curved there.
const STANDS_OUT: f64 = 1.5;

/// Most samples over which the ends of a single period are averaged, as a share of the period.
const LONGEST_AVERAGE: f64 = 1.0 / 64.0;

/// What a position does from period to period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Travel {
    /// It returns.
    None,
    /// It moves on by this distance in each of several periods.
    Steady(f64),
    /// It ends a single period this far from where it began. That it would move on is assumed.
    Once(f64),
}

impl Travel {
    /// Of the last periods of a position.
    pub(super) fn of(position: &[f64], periods: Periods) -> Self {
        let distance = match periods.count {
            0 | 1 => of_one(position, periods.samples).map(Self::Once),
            _ => of_several(position, periods).map(Self::Steady),
        };
        distance.unwrap_or(Self::None)
    }

    /// Distance in a period, response units; 0 if it returns.
    pub(super) fn distance(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Steady(distance) | Self::Once(distance) => distance,
        }
    }

    /// The position without its uniform motion.
    pub(super) fn taken_out_of(self, position: &[f64], samples: f64) -> Vec<f64> {
        let per_sample = self.distance() / samples;
        position.iter().enumerate().map(|(n, y)| y - per_sample * n as f64).collect()
    }

    /// The remark for the user, unless the distance is small beside the position.
    pub(super) fn remark(self, position: &[f64]) -> Option<String> {
        if self.distance().abs() < TOLD_SHARE * largest(position) {
            return None;
        }
        match self {
            Self::None => None,
            Self::Steady(distance) => Some(format!(
                "the position drifts by {distance:.4} response units in every period; this steady \
                 drift is removed and used as the mean velocity"
            )),
            Self::Once(distance) => Some(format!(
                "at the end of the period the position is {distance:.4} response units away from where \
                 it began; this is removed as a steady drift. Record several periods to see whether \
                 the axis drifts or has not settled"
            )),
        }
    }
}

/// Mean distance from one period to the next, if it is not noise.
fn of_several(position: &[f64], Periods { samples, count }: Periods) -> Option<f64> {
    let shift = ((count - 1) as f64 * samples).round() as usize;
    let used = ((count as f64 * samples).round() as usize).min(position.len());
    let used = &position[position.len() - used..];
    let moved: Vec<f64> = used.iter().zip(used.get(shift..)?).map(|(a, b)| b - a).collect();
    let number = moved.len() as f64;
    let mean = moved.iter().sum::<f64>() / number;
    let variance = moved.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (number - 1.0);
    let rounding = ROUNDING_SHARE * largest(used);
    let is_significant = mean.abs() > rounding + SIGNIFICANT * (variance / number).sqrt();
    is_significant.then_some(mean / (count - 1) as f64)
}

/// Distance from the beginning of a single period to its end, if that jump stands out from all others
/// that the same formula sees within the period.
///
/// With b the means of four neighbouring groups of w samples, the jump between the inner two, less
/// the slope on either side, is 3/2·(b₂ − b₁) − ½·(b₃ − b₀). It is 0 for a parabola. The width w is
/// that which makes it smallest within the period: it balances noise against curvature.
fn of_one(position: &[f64], samples: f64) -> Option<f64> {
    if samples.fract() != 0.0 || position.len() < samples as usize {
        return None;
    }
    let period = &position[position.len() - samples as usize..];
    let longest = (LONGEST_AVERAGE * samples) as usize;
    let widths = std::iter::successors(Some(1), |width| Some(2 * width));
    let of_width = |width: usize| {
        let within = jumps(period, width);
        let rms = (within.iter().map(|jump| jump * jump).sum::<f64>() / within.len() as f64).sqrt();
        (rms, width, within)
    };
    let (_, width, within) = widths
        .take_while(|width| *width <= longest.max(1) && 8 * width <= period.len())
        .map(of_width)
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    // Of the end followed by the beginning there is exactly one.
    let seam = [&period[period.len() - 2 * width..], &period[..2 * width]].concat();
    let jump = jumps(&seam, width)[0];
    let rounding = ROUNDING_SHARE * largest(period);
    (jump.abs() > STANDS_OUT * largest(&within) + rounding).then_some(-jump)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// The jump between the second and the third of every four neighbouring groups of `width` samples.
fn jumps(signal: &[f64], width: usize) -> Vec<f64> {
    let mut sums = vec![0.0; signal.len() + 1];
    for (n, value) in signal.iter().enumerate() {
        sums[n + 1] = sums[n] + value;
    }
    let mean = |from: usize| (sums[from + width] - sums[from]) / width as f64;
    (0..=signal.len() - 4 * width)
        .map(|n| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|place| mean(n + place * width));
            1.5 * (c - b) - 0.5 * (d - a)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const SAMPLES: usize = 2000;

    /// A smooth motion with a kink of its acceleration, a uniform motion and noise.
    fn position(count: usize, travel: f64, std: f64, seed: u64) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let at = |n: usize| {
            let phase = n as f64 / SAMPLES as f64;
            let noise: f64 = StandardNormal.sample(&mut rng);
            let kink = (phase.fract() - 0.3).max(0.0).powi(2) * (1.0 - phase.fract()).powi(2);
            (TAU * phase).cos()
                + 0.3 * (7.0 * TAU * phase).sin()
                + kink
                + travel * phase
                + std * noise
        };
        (0..count * SAMPLES).map(at).collect()
    }

    fn found(count: usize, travel: f64, std: f64, seed: u64) -> Travel {
        let periods = Periods { samples: SAMPLES as f64, count };
        Travel::of(&position(count, travel, std, seed), periods)
    }

    // The mean of 2000 differences of samples has a standard error of √(2/2000) of the noise.
    #[test]
    fn a_position_that_moves_on_over_several_periods_does_so_by_their_means() {
        for seed in 0..20 {
            let Travel::Steady(distance) = found(3, 0.01, 1e-3, seed) else {
                panic!("it moves on")
            };
            let error = 1e-3 * (2.0 / SAMPLES as f64).sqrt() / 2.0;
            assert!((distance - 0.01).abs() < 4.0 * error, "{distance}");
        }
    }

    // The difference of means over w samples has a standard error of √(5/w) of the noise, w ≥ 1.
    #[test]
    fn a_single_period_ends_elsewhere_by_more_than_any_jump_within_it() {
        for seed in 0..20 {
            let Travel::Once(distance) = found(1, -0.02, 1e-3, seed) else { panic!("it moves on") };
            assert!((distance + 0.02).abs() < 4.0 * 5.0_f64.sqrt() * 1e-3, "{distance}");
        }
    }

    #[test]
    fn a_position_that_returns_has_no_travel() {
        for seed in 0..20 {
            assert_eq!(found(4, 0.0, 1e-3, seed), Travel::None, "{seed}");
            assert_eq!(found(1, 0.0, 1e-2, seed), Travel::None, "{seed}");
        }
        assert_eq!(found(1, 0.0, 0.0, 0), Travel::None);
    }

    #[test]
    fn the_uniform_motion_is_taken_out() {
        let moved = position(2, 0.5, 0.0, 0);
        let travel = Travel::of(&moved, Periods { samples: SAMPLES as f64, count: 2 });
        let periodic = travel.taken_out_of(&moved, SAMPLES as f64);
        let expected = position(2, 0.0, 0.0, 0);
        // Rounding of a mean of 2000 values.
        assert!(periodic.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
