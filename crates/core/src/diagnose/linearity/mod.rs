//! What the measured data tell before any model is fitted: the best linear approximation, the
//! noise, and the nonlinear distortion.
//!
//! A linear axis answers only at the lines that the input excites. What appears at other lines,
//! beyond the noise, is distortion: at even lines of a nonlinearity that is not odd, at odd lines of
//! one that is. Where all lines are excited, distortion shows only as scatter between inputs with
//! different phases, or as a gain that changes with the level (R. Pintelon, J. Schoukens, *System
//! Identification: A Frequency Domain Approach*, 2nd ed. 2012, sections 3.4, 4.2 and 4.3).

mod cosines;
mod level;
mod lines;
mod multisines;
mod sentence;

use crate::answers::{Linearity, LinearityLevel, Share};
use crate::measurement::{Complex, Measurement};

use level::{Part, Power};

/// Frequencies that differ by less than this share are one: values in files are rounded.
const SAME_FREQUENCY: f64 = 1e-6;

/// What the data tell before any model; `None` if they tell nothing: one level, no noise, and
/// nothing measured beside the excited lines.
pub fn linearity(measurement: &Measurement) -> Option<Linearity> {
    let experiments = measurement.experiments();
    let levels = match experiments.iter().all(|e| e.pure_cosine().is_some()) {
        true => cosines::levels(experiments),
        false => multisines::levels(experiments),
    };
    let change_with_level = match levels.as_slice() {
        [first, .., last] => change(first, last),
        _ => None,
    };
    let tells = |level: &LinearityLevel| {
        level.noise.is_some()
            || level.even.is_some()
            || level.odd.is_some()
            || level.stochastic.is_some()
    };
    (change_with_level.is_some() || levels.iter().any(tells)).then(|| Linearity {
        sentence: sentence::of(measurement, &levels, change_with_level),
        levels,
        change_with_level,
    })
}

/// Change of the gain from one level to another; `None` without a common line.
fn change(from: &LinearityLevel, to: &LinearityLevel) -> Option<Share> {
    let (mut changed, mut whole) = (Part::default(), 0.0);
    for line in &to.approximation {
        let is_same = |omega: f64| (omega / line.omega_rad_s - 1.0).abs() < SAME_FREQUENCY;
        let Some(other) = from.approximation.iter().find(|other| is_same(other.omega_rad_s)) else {
            continue;
        };
        let gain = |[re, im]: [f64; 2]| Complex::new(re, im);
        let variance = |std: Option<f64>| std.map(|std| 2.0 * std * std);
        let noise = variance(line.total_std.or(line.noise_std))
            .zip(variance(other.total_std.or(other.noise_std)))
            .map(|(a, b)| a + b);
        // Relative, so that every line counts alike.
        let size = gain(line.gain).norm_sqr();
        if size == 0.0 {
            continue;
        }
        let difference = (gain(line.gain) - gain(other.gain)).norm_sqr();
        changed
            .add(Power { power: difference / size, noise: noise.map(|n| n / size) }, f64::INFINITY);
        whole += 1.0;
    }
    changed.share(whole, 1.0)
}

#[cfg(test)]
mod tests;
