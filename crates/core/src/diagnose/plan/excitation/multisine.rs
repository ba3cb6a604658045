//! A multisine over the whole band, which tells noise, even and odd distortion apart.
//!
//! Only odd lines are excited, and of every four consecutive ones a random one is left out: what the
//! response has at even lines is even distortion, at odd lines that are left out odd distortion, and
//! what differs from period to period is noise (random odd multisine: R. Pintelon, J. Schoukens 2012,
//! doi:10.1002/9781118287422).

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::diagnose::plan::design::{sample_s, samples_per_period};
use crate::diagnose::plan::setting::Setting;
use crate::measurement::Complex;
use crate::simulate::{Excitation, respond};

use super::crest_factor::{Phased, optimised};
use super::{ExcitationError, Samples};

/// Of so many consecutive odd lines, one is left out.
const GROUP: usize = 4;
/// Most odd lines before some are left out; beyond, they are spread logarithmically.
const MOST_LINES: usize = 64;
/// Fewest periods of a magnitude: their scatter tells the noise.
const FEWEST_PERIODS: usize = 2;
/// Magnitudes, as shares of the largest.
const LEVELS: [f64; 3] = [0.25, 0.5, 1.0];

/// How many samples there are at least: those of the shortest multisine, or what fills the budget.
/// Phases for one of many more are sought for minutes.
pub(super) fn fewest_samples(setting: &Setting) -> f64 {
    let period = samples_per_period(setting, setting.band_rad_s[0]) as f64;
    let settle = setting.periods(setting.band_rad_s[0])[0];
    let shortest = (settle + FEWEST_PERIODS) as f64 * period;
    let filled = setting.request.budget_s / sample_s(setting) - LEVELS.len() as f64 * period;
    shortest.max(filled)
}

/// The multisine at as many magnitudes as fit, each for as many periods as fit.
///
/// # Errors
/// [`ExcitationError::NoMultisine`] if not even one fits.
pub(super) fn samples(setting: &Setting) -> Result<Samples, ExcitationError> {
    let [lowest, highest] = setting.band_rad_s;
    let refuse = |reason: String| ExcitationError::NoMultisine { lowest_rad_s: lowest, reason };
    let step_s = sample_s(setting);
    let period = samples_per_period(setting, lowest);
    let period_s = period as f64 * step_s;
    let rng = &mut ChaCha8Rng::seed_from_u64(setting.request.options.seed);
    let lines = lines((highest / lowest).floor() as usize, rng);
    let phased = optimised(&lines, rng);
    let waveform = phased.waveform(period);
    let peak = waveform.iter().map(|x| x.abs()).fold(0.0, f64::max);
    let levels: Vec<f64> = LEVELS
        .iter()
        .map(|share| share * setting.magnitudes[1])
        .filter(|level| *level >= setting.magnitudes[0])
        .filter(|level| within_limits(setting, &phased, level / peak, TAU / period_s))
        .collect();
    if levels.is_empty() {
        return Err(refuse("the largest velocity or travel is exceeded at every magnitude".into()));
    }
    let settle = setting.periods(TAU / period_s)[0];
    let all = (setting.request.budget_s / period_s) as usize;
    let fits = |count: &usize| all / count >= settle + FEWEST_PERIODS;
    let Some(count) = (1..=levels.len()).rev().find(fits) else {
        let needed_s = (settle + FEWEST_PERIODS) as f64 * period_s;
        return Err(refuse(format!(
            "{settle} periods to settle and {FEWEST_PERIODS} to measure take {needed_s:.3} s"
        )));
    };
    let levels = &levels[levels.len() - count..];
    let measured = all / count - settle;
    let mut values = Vec::new();
    let mut before = 0.0;
    for (segment, level) in levels.iter().enumerate() {
        let gain = level / peak;
        for sample in 0..(settle + measured) * period {
            // The magnitude rises over the first period.
            let share = (sample as f64 / period as f64).min(1.0);
            let value = (before + (gain - before) * share) * waveform[sample % period];
            values.push((value, (sample >= settle * period).then_some(segment)));
        }
        before = gain;
    }
    values.extend((0..=period).map(|sample| {
        let share = 1.0 - sample as f64 / period as f64;
        (before * share * waveform[sample % period], None)
    }));
    let excited: Vec<String> = lines.iter().map(ToString::to_string).collect();
    let comments = vec![
        format!(
            "multisine: {} odd lines of {:.6e} rad/s, crest factor {:.3}, {count} magnitudes, {measured} \
             periods each; rows without a segment are ramps and settling",
            lines.len(),
            TAU / period_s,
            phased.crest_factor()
        ),
        format!("excited lines are {}", excited.join(" ")),
        "add a column output with the measured velocity in the same rows, and servoscope reads the file".into(),
    ];
    Ok(Samples { step_s, values, comments })
}

/// The excited lines, up to the highest.
fn lines(highest: usize, rng: &mut ChaCha8Rng) -> Vec<usize> {
    let odd: Vec<usize> = (1..=highest.max(1)).step_by(2).collect();
    let candidates: Vec<usize> = match odd.len() <= MOST_LINES {
        true => odd,
        false => {
            let ratio = highest as f64;
            let spread = (0..MOST_LINES).map(|i| {
                let about = ratio.powf(i as f64 / (MOST_LINES - 1) as f64);
                ((about as usize).saturating_sub(1) / 2) * 2 + 1
            });
            let mut spread: Vec<usize> = spread.collect();
            spread.dedup();
            spread
        }
    };
    let mut kept = Vec::new();
    for group in candidates.chunks(GROUP) {
        // An incomplete group is kept whole.
        let out = (group.len() == GROUP).then(|| rng.random_range(0..GROUP));
        let in_group = group.iter().enumerate().filter(|(i, _)| Some(*i) != out);
        kept.extend(in_group.map(|(_, line)| *line));
    }
    kept
}

/// Whether the rough axis keeps within the limits under the multisine.
fn within_limits(setting: &Setting, phased: &Phased, gain: f64, omega_rad_s: f64) -> bool {
    let request = &setting.request;
    if request.options.largest_velocity.is_none() && request.options.largest_travel.is_none() {
        return true;
    }
    let highest = phased.lines.last().copied().unwrap_or(1);
    let mut input = vec![Complex::ZERO; highest + 1];
    for (line, phase) in phased.lines.iter().zip(&phased.phases) {
        input[*line] = Complex::from_polar(gain, *phase);
    }
    let excitation = Excitation::new(omega_rad_s, input);
    let Ok(velocity) = respond(&setting.plant, &[], &excitation, highest) else { return false };
    let largest = |of: &dyn Fn(usize, Complex) -> Complex| {
        let count = 8 * highest;
        let at = |sample: usize| {
            let terms = velocity.iter().enumerate().skip(1).map(|(k, value)| {
                let angle = TAU * (k * sample % count) as f64 / count as f64;
                (of(k, *value) * Complex::from_polar(1.0, angle)).re
            });
            terms.sum::<f64>().abs()
        };
        (0..count).map(at).fold(0.0, f64::max)
    };
    let reserve = 1.0 + request.options.uncertainty;
    let speed = velocity[0].norm() + largest(&|_, value| value);
    let travel = largest(&|k, value| value / Complex::new(0.0, k as f64 * omega_rad_s));
    let within = |value: f64, most: Option<f64>| most.is_none_or(|most| reserve * value <= most);
    within(speed, request.options.largest_velocity)
        && within(travel, request.options.largest_travel)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_odd_lines_are_excited_and_one_of_four_is_left_out() {
        for highest in [7, 67, 400] {
            let lines = lines(highest, &mut ChaCha8Rng::seed_from_u64(1));
            assert!(lines.iter().all(|line| line % 2 == 1 && *line <= highest));
            assert!(lines.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(lines.len() <= MOST_LINES);
        }
        // Of 34 odd lines, 8 groups of four and two more.
        assert_eq!(lines(67, &mut ChaCha8Rng::seed_from_u64(1)).len(), 8 * 3 + 2);
    }
}
