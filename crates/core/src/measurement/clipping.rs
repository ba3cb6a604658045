//! Samples that a channel cut off at its range.
//!
//! A channel that clips repeats its largest or smallest value exactly, in a row and often, and hardly
//! any sample lies just inside. So does a machine that stands still, or an input that is held: a
//! diagnosis decides which it is.

mod fill;
mod unknown;

use std::ops::Range;

use super::record::{Record, RecordStatement};
use super::spectrum::{self, Periods};
use super::{ChannelRange, Clipping, Experiment, ResponseKind, resolution};
use fill::Fill;

/// Fewest samples at a limit, and fewest of them in a row somewhere.
const FEWEST: usize = 8;
const FEWEST_IN_A_ROW: usize = 2;

/// A channel clips if the samples at its limit are more than this many times those that lie inside by
/// less than [`NEAR_SHARE`] of its range, or by one step of its rounding. Of a sine that is rounded to 256
/// steps they are 2.4 times as many.
const MORE_THAN_NEAR: usize = 4;
const NEAR_SHARE: f64 = 0.0005;

/// Largest share of samples that can be filled in.
const MOST_SHARE: f64 = 0.5;

impl Record {
    /// What the channels seem to cut off in the last periods, of this length in seconds; `None` if
    /// nothing, or if a period is no whole number of samples. Of responses only velocities are looked
    /// at: a position stands still, too.
    pub(super) fn clipping(
        &self,
        periods: Periods,
        period_s: f64,
        stated: RecordStatement,
    ) -> Option<Box<Clipping>> {
        if periods.samples.fract() != 0.0 {
            return None;
        }
        let length = periods.samples as usize;
        let begin = self.input.len() - length * periods.count;
        let input = CutOff::of(&self.input[begin..]);
        let is_velocity = stated.kind == ResponseKind::Velocity;
        let response =
            if is_velocity { CutOff::of(&self.output[begin..]) } else { CutOff::default() };
        let filled = input.filled(&self.input[begin..], length).map(|filled| {
            let mut record = Self { time_s: Vec::new(), ..self.clone() };
            record.input[begin..].copy_from_slice(&filled.samples);
            let outputs = spectrum::of_periods(&record.output, periods);
            let experiment =
                record.of_periods(outputs, (periods.samples, period_s), stated, &mut Vec::new());
            let highest = experiment.response.last().map_or(0, |harmonic| harmonic.order);
            let unknown_input = unknown::directions(&filled.cut, length, highest, filled.beyond);
            Experiment { unknown_input, ..experiment }
        });
        if filled.is_none() && response.share == 0.0 {
            return None;
        }
        let [lowest, highest] = response.limits;
        let range = (response.share > 0.0).then(|| ChannelRange {
            lowest: lowest.unwrap_or(f64::NEG_INFINITY),
            highest: highest.unwrap_or(f64::INFINITY),
            samples: length,
        });
        let input_share = if filled.is_some() { input.share } else { 0.0 };
        let response_share = response.share;
        Some(Box::new(Clipping { filled, input_share, range, response_share }))
    }
}

/// Periods with what was cut off filled in.
struct Filled {
    samples: Vec<f64>,
    /// Where they were cut off, by period.
    cut: Vec<Vec<usize>>,
    /// How far they lie beyond the limits, at most.
    beyond: f64,
}

/// What a channel cuts off.
#[derive(Debug, Default)]
pub(super) struct CutOff {
    limits: [Option<f64>; 2],
    /// Share of the samples.
    share: f64,
}

impl CutOff {
    /// Nothing is cut off if too little would be left. A range is mostly symmetric: of its other end one
    /// sample is enough.
    pub(super) fn of(samples: &[f64]) -> Self {
        let limits = match limits(samples) {
            [None, Some(end)] | [Some(end), None] if samples.contains(&-end) => {
                [Some(-end.abs()), Some(end.abs())]
            }
            limits => limits,
        };
        let cut = Self { limits, share: 0.0 };
        let count = samples.iter().filter(|value| cut.is_cut(**value)).count();
        let share = count as f64 / samples.len().max(1) as f64;
        if share > MOST_SHARE { Self::default() } else { Self { share, ..cut } }
    }

    fn is_cut(&self, value: f64) -> bool {
        self.limits.contains(&Some(value))
    }

    /// Whether any of these samples, or one beside them, lies at a limit.
    pub(super) fn is_at_limit(&self, samples: &[f64], these: Range<usize>) -> bool {
        let (first, end) = (these.start.saturating_sub(1), (these.end + 1).min(samples.len()));
        samples[first..end].iter().any(|value| self.is_cut(*value))
    }

    /// Periods of so many samples with what was cut off filled in; it lies beyond the limits. `None` if
    /// nothing was: the samples on both sides of a top may be equal, and fit what is beside them.
    fn filled(&self, samples: &[f64], length: usize) -> Option<Filled> {
        if self.share == 0.0 {
            return None;
        }
        let cut: Vec<Vec<usize>> = samples
            .chunks_exact(length)
            .map(|period| (0..length).filter(|i| self.is_cut(period[*i])).collect())
            .collect();
        let mut filled = samples.to_vec();
        Fill::of(length).fill(&mut filled, &cut);
        let [lowest, highest] = self.limits;
        let mut beyond = 0.0_f64;
        for (before, after) in samples.iter().zip(&mut filled) {
            if Some(*before) == highest {
                *after = after.max(*before);
            } else if Some(*before) == lowest {
                *after = after.min(*before);
            }
            beyond = beyond.max((*after - before).abs());
        }
        let [least, most] = ends(samples.iter().copied());
        let filled = Filled { samples: filled, cut, beyond };
        (beyond > NEAR_SHARE * (most - least)).then_some(filled)
    }
}

/// The smallest and the largest value.
fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let beyond = [f64::INFINITY, f64::NEG_INFINITY];
    values.fold(beyond, |[least, most], value| [least.min(value), most.max(value)])
}

/// The lowest and the highest value of a channel, where it clips.
fn limits(samples: &[f64]) -> [Option<f64>; 2] {
    [-1.0, 1.0].map(|sign| {
        let toward = |value: &f64| sign * value;
        let [lowest, highest] = ends(samples.iter().map(toward));
        let is_at = |value: &f64| toward(value) == highest;
        let longest = samples.chunk_by(|a, b| is_at(a) == is_at(b));
        let longest = longest.filter(|run| is_at(&run[0])).map(<[f64]>::len).max()?;
        let at = samples.iter().filter(|value| is_at(value)).count();
        // At 0 a machine stands still that moves in one direction.
        let is_possible = highest != 0.0 && highest > lowest;
        if at < FEWEST || longest < FEWEST_IN_A_ROW || !is_possible {
            return None;
        }
        let width = (NEAR_SHARE * (highest - lowest)).max(1.5 * resolution::step(samples));
        let is_near = |value: &&f64| !is_at(value) && toward(value) > highest - width;
        let near = samples.iter().filter(is_near).count();
        (at > MORE_THAN_NEAR * near).then_some(sign * highest)
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const LENGTH: usize = 400;

    /// Four periods of 12 lines with noise of 60 dB.
    fn signal() -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut value = |n: usize| {
            let noise: f64 = StandardNormal.sample(&mut rng);
            let line =
                |k: i32| (f64::from(k) * (TAU * n as f64 / LENGTH as f64) + f64::from(k * k)).cos();
            (1..=12).map(line).sum::<f64>() + 1e-3 * noise * 6.0_f64.sqrt()
        };
        (0..4 * LENGTH).map(&mut value).collect()
    }

    fn clipped(signal: &[f64], low: f64, high: f64) -> Vec<f64> {
        signal.iter().map(|value| value.clamp(low, high)).collect()
    }

    #[test]
    fn what_was_cut_off_is_filled_in_to_the_noise() {
        let whole = signal();
        let samples = clipped(&whole, -2.5, 4.0);
        let cut = CutOff::of(&samples);
        assert!((0.05..0.3).contains(&cut.share), "{}", cut.share);
        let samples = cut.filled(&samples, LENGTH).unwrap().samples;
        let squares = whole.iter().zip(&samples).map(|(a, b)| (a - b).powi(2));
        let rms = (squares.sum::<f64>() / whole.len() as f64).sqrt();
        // The noise itself is 2.4e-3; a tenth of the samples is filled in.
        assert!(rms < 2.5e-3, "{rms}");
    }

    #[test]
    fn a_channel_clips_only_where_it_repeats_its_limit() {
        let whole = signal();
        assert_eq!(limits(&whole), [None, None]);
        assert_eq!(limits(&clipped(&whole, -2.5, 40.0)), [Some(-2.5), None]);
        assert_eq!(limits(&clipped(&whole, -25.0, 4.0)), [None, Some(4.0)]);
        // Rounded to 256 steps.
        let rounded = |n: u32| (128.0 * (f64::from(n) * 0.01).cos()).round();
        assert_eq!(limits(&(0..2000).map(rounded).collect::<Vec<_>>()), [None, None]);
    }

    #[test]
    fn two_samples_of_each_period_can_be_cut_off_but_not_where_they_fit_what_is_beside_them() {
        let peak = |period: u32| {
            let distance = |n: u32| (f64::from(n) - 100.5).abs();
            let value =
                move |n: u32| 3.0 * (-0.2 * distance(n).powi(2)).exp() + (0.5 * f64::from(n)).sin();
            (0..400).map(move |n| value(n) + 1e-4 * f64::from(n * period % 7))
        };
        let whole: Vec<f64> = (1..=4).flat_map(peak).collect();
        let third = {
            let mut sorted = whole[..400].to_vec();
            sorted.sort_by(|a, b| b.total_cmp(a));
            sorted[2]
        };
        assert_eq!(CutOff::of(&whole).share, 0.0);
        let limit = third + 0.002;
        let samples = clipped(&whole, -50.0, limit);
        let cut = CutOff::of(&samples);
        assert_eq!(cut.share, 8.0 / 1600.0);
        assert!(cut.filled(&samples, 400).is_some());
        // The two samples next to the top of a symmetric signal are equal.
        let line = |k: f64, n: u32| (TAU * k * (f64::from(n) + 0.5) / 100.0).cos();
        let value =
            |n: u32| (1e5 * (line(1.0, n) + 0.4 * line(2.0, n) + 0.3 * line(5.0, n))).round();
        let symmetric: Vec<f64> = (0..400).map(value).collect();
        let cut = CutOff::of(&symmetric);
        assert!(cut.share > 0.0 && cut.filled(&symmetric, 100).is_none());
    }

    #[test]
    fn one_sample_at_the_other_end_of_a_symmetric_range_is_cut_off_as_well() {
        let mut samples = clipped(&signal(), -50.0, 4.0);
        assert_eq!(CutOff::of(&samples).limits, [None, Some(4.0)]);
        let lowest = samples.iter().position(|value| *value < -4.0).unwrap();
        samples.iter_mut().for_each(|value| *value = value.max(-3.9));
        samples[lowest] = -4.0;
        assert_eq!(CutOff::of(&samples).limits, [Some(-4.0), Some(4.0)]);
    }

    #[test]
    fn a_machine_that_stands_still_does_not_clip() {
        assert_eq!(limits(&clipped(&signal(), 0.0, 40.0)), [None, None]);
    }

    #[test]
    fn most_of_a_period_cannot_be_filled_in() {
        assert_eq!(CutOff::of(&clipped(&signal(), -0.1, 0.1)).share, 0.0);
    }
}
