//! Samples of a record that do not belong to the rest: single values, or a few in a row, that a
//! disturbance of the wires or of the transmission replaced.
//!
//! A channel with three or more periods is compared with the median over the periods. Otherwise the
//! response alone is looked at, which moves smoothly from sample to sample; an input may jump. Samples
//! are bad if their neighbours on both sides do not lead to them, and if the channel is as smooth as
//! elsewhere once they are interpolated.

mod suspect;

use super::spectrum::Periods;
use super::{Experiment, Record, ResponseKind, resolution};
use crate::answers::Channel;
use suspect::{BEYOND_JUMP, Suspects};

/// Fewest periods whose median tells what belongs.
const FEWEST_PERIODS: usize = 3;

/// Largest share of the samples of a record that can be bad, and number that always can.
const MOST_SHARE: f64 = 0.01;
const MOST_ALWAYS: usize = 8;

/// Samples at nearly the same place of two periods, within so many samples, are no accident: what
/// happens there varies from period to period.
const SAME_PLACE: usize = 3;

/// Share of the largest value below which differences are rounding of arithmetic.
const ARITHMETIC_SHARE: f64 = 1e-9;

/// What a record would be without its bad samples.
#[derive(Debug, Clone, PartialEq)]
pub struct BadSamples {
    /// The experiment with the bad samples interpolated.
    pub mended: Experiment,
    /// The bad samples.
    pub samples: Vec<BadSample>,
}

/// Samples in a row that do not belong.
#[derive(Debug, Clone, PartialEq)]
pub struct BadSample {
    /// The channel.
    pub channel: Channel,
    /// Index of the first of them in the record.
    pub first: usize,
    /// Number of samples.
    pub count: usize,
    /// Time of the first, s.
    pub time_s: f64,
    /// Line of the file of the first; `None` if it is not known.
    pub line: Option<u64>,
    /// Largest distance from what their neighbours lead to, units of the channel.
    pub off: f64,
    /// The same in standard deviations of a sample.
    pub sigmas: f64,
}

impl Record {
    /// The record with the bad samples of its last periods interpolated, and these; `None` if there are
    /// none.
    pub(super) fn without_bad_samples(
        &self,
        periods: Periods,
        kind: ResponseKind,
    ) -> Option<(Self, Vec<BadSample>)> {
        let mut mended = self.clone();
        let mut bad = mend(&mut mended.input, Channel::Input, periods, false);
        let is_smooth = kind != ResponseKind::Acceleration;
        bad.extend(mend(&mut mended.output, Channel::Response, periods, is_smooth));
        for one in &mut bad {
            one.time_s = self.time_s.get(one.first).copied().unwrap_or_default();
        }
        (!bad.is_empty()).then_some((mended, bad))
    }
}

/// Interpolates the bad samples of the last periods of a channel, and returns them. Without enough periods
/// of whole samples only a channel is looked at that is smooth.
fn mend(values: &mut [f64], channel: Channel, periods: Periods, is_smooth: bool) -> Vec<BadSample> {
    let Periods { samples, count } = periods;
    let length = samples as usize;
    let periodic = samples.fract() == 0.0 && count >= FEWEST_PERIODS;
    if !periodic && !is_smooth {
        return Vec::new();
    }
    let begin = values.len().saturating_sub((samples * count as f64).round() as usize);
    let usual = if periodic { median_period(&values[begin..], length) } else { vec![0.0] };
    let place = |index: usize| (index - begin) % usual.len();
    let mut left: Vec<f64> =
        (begin..values.len()).map(|index| values[index] - usual[place(index)]).collect();
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let suspects = Suspects::of(&left, resolution::step(values).max(ARITHMETIC_SHARE * largest));
    // A jump that comes a sample earlier or later is off by its height.
    let height = |index: usize| {
        let near = (0..=2 * SAME_PLACE).map(|shift| {
            let at = (place(index) + usual.len() + shift - SAME_PLACE % usual.len()) % usual.len();
            (usual[(at + 1) % usual.len()] - usual[at]).abs()
        });
        near.fold(0.0, f64::max)
    };
    let mut found: Vec<BadSample> = suspects
        .mend(&mut left)
        .into_iter()
        .map(|one| BadSample {
            channel,
            first: begin + one.first,
            count: one.count,
            time_s: 0.0,
            line: None,
            off: one.off,
            sigmas: one.off / suspects.std,
        })
        .filter(|one| one.off > BEYOND_JUMP * height(one.first))
        .collect();
    if periodic {
        let places: Vec<usize> = found.iter().map(|one| place(one.first)).collect();
        let is_accident = |this: usize| {
            let others = places.iter().enumerate().filter(|(other, _)| *other != this);
            let mut apart = others.map(|(_, other)| {
                let distance = other.abs_diff(places[this]);
                distance.min(length - distance)
            });
            apart.all(|apart| apart > SAME_PLACE)
        };
        let accidents: Vec<bool> = (0..found.len()).map(is_accident).collect();
        let mut accidents = accidents.into_iter();
        found.retain(|_| accidents.next().unwrap_or(true));
    }
    let all: usize = found.iter().map(|one| one.count).sum();
    if all > MOST_ALWAYS.max((MOST_SHARE * values.len() as f64) as usize) {
        return Vec::new();
    }
    for one in &found {
        for index in one.first..one.first + one.count {
            values[index] = left[index - begin] + usual[place(index)];
        }
    }
    found
}

/// The median over the periods at each of their samples.
fn median_period(values: &[f64], length: usize) -> Vec<f64> {
    let median = |place: usize| {
        let mut all: Vec<f64> = values.iter().skip(place).step_by(length).copied().collect();
        let middle = all.len() / 2;
        *all.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    (0..length).map(median).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const LENGTH: usize = 400;
    const NOISE: f64 = 1e-3;

    fn noise(count: usize, seed: u64) -> impl Iterator<Item = f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        (0..count).map(move |_| NOISE * Distribution::<f64>::sample(&StandardNormal, &mut rng))
    }

    /// Periods of a square wave and of a smooth response, both with noise.
    fn record(periods: usize, seed: u64) -> Record {
        let angle = |n: usize| TAU * (n % LENGTH) as f64 / LENGTH as f64;
        let all = || 0..periods * LENGTH;
        let square = |n: usize| if angle(n).sin() >= 0.0 { 1.0 } else { -1.0 };
        let smooth = |n: usize| (angle(n) - 0.3).cos() + 0.2 * (3.0 * angle(n)).sin();
        Record {
            time_s: all().map(|n| 1e-3 * n as f64).collect(),
            input: all()
                .map(square)
                .zip(noise(periods * LENGTH, seed))
                .map(|(x, e)| x + e)
                .collect(),
            output: all()
                .map(smooth)
                .zip(noise(periods * LENGTH, seed + 1))
                .map(|(x, e)| x + e)
                .collect(),
            run: None,
        }
    }

    fn periods(record: &Record) -> Periods {
        Periods { samples: LENGTH as f64, count: record.output.len() / LENGTH }
    }

    fn found(record: &Record) -> Vec<(Channel, usize, usize)> {
        let bad = record.without_bad_samples(periods(record), ResponseKind::Velocity);
        let bad = bad.map_or(Vec::new(), |(_, bad)| bad);
        bad.iter().map(|one| (one.channel, one.first, one.count)).collect()
    }

    #[test]
    fn a_spike_and_a_dropout_are_found_where_they_are_and_interpolated_to_the_noise() {
        for periods in [1, 2, 4] {
            let sound = record(periods, 1);
            let mut record = sound.clone();
            record.output[70] += 0.05;
            record.output[199..203].fill(0.0);
            let (mended, bad) =
                record.without_bad_samples(self::periods(&record), ResponseKind::Velocity).unwrap();
            assert_eq!(found(&record), [(Channel::Response, 70, 1), (Channel::Response, 199, 4)]);
            assert!((bad[0].time_s - 0.07).abs() < 1e-12);
            // Noise of the sample, and of what it is compared with.
            assert!((bad[0].off - 0.05).abs() < 5.0 * NOISE, "{}", bad[0].off);
            for index in [70, 199, 200, 201, 202] {
                // Noise of the four neighbours, and up to 1.5 times that inside a gap of four.
                let error = mended.output[index] - sound.output[index];
                assert!(error.abs() < 10.0 * NOISE, "{periods} {index} {error}");
            }
        }
    }

    #[test]
    fn an_input_may_jump_but_differs_from_its_other_periods_only_where_it_is_disturbed() {
        let mut record = record(4, 3);
        assert_eq!(found(&record), []);
        record.input[2 * LENGTH + 30] = 0.0;
        assert_eq!(found(&record), [(Channel::Input, 2 * LENGTH + 30, 1)]);
    }

    #[test]
    fn a_jump_that_comes_a_sample_later_is_no_bad_sample() {
        let mut record = record(4, 5);
        record.input[LENGTH] = -1.0;
        record.input[2 * LENGTH + LENGTH / 2] = 1.0;
        record.input[3 * LENGTH + LENGTH / 2] = 1.0;
        assert_eq!(found(&record), []);
    }

    #[test]
    fn what_happens_at_the_same_place_of_two_periods_is_no_accident() {
        let mut record = record(4, 7);
        record.output[100] += 0.05;
        record.output[2 * LENGTH + 101] += 0.05;
        assert_eq!(found(&record), []);
    }

    #[test]
    fn periods_that_are_not_used_are_not_looked_at() {
        let mut record = record(4, 15);
        record.input[30] += 0.5;
        record.output[50] += 0.5;
        let last = |count| {
            let periods = Periods { samples: LENGTH as f64, count };
            record.without_bad_samples(periods, ResponseKind::Velocity).map(|(_, bad)| bad.len())
        };
        assert_eq!((last(4), last(3), last(1)), (Some(2), None, None));
    }

    #[test]
    fn a_response_that_jumps_is_no_bad_sample() {
        for periods in [1, 4] {
            let mut record = record(periods, 9);
            record.output[150..].iter_mut().for_each(|value| *value += 0.3);
            assert_eq!(found(&record), []);
        }
    }

    #[test]
    fn samples_on_a_coarse_grid_belong() {
        let mut record = record(2, 11);
        record.output.iter_mut().for_each(|value| *value = (*value / 0.05).round() * 0.05);
        assert_eq!(found(&record), []);
        record.output[77] = 5.0;
        assert_eq!(found(&record), [(Channel::Response, 77, 1)]);
    }

    #[test]
    fn where_many_samples_are_bad_none_is() {
        let mut record = record(4, 13);
        (10..4 * LENGTH - 10).step_by(53).for_each(|index| record.output[index] += 0.1);
        assert_eq!(found(&record), []);
    }

    // The largest of 4000 values with the density of exp(−|x|) is 9.0 on average.
    #[test]
    fn noise_with_many_large_values_has_no_bad_samples() {
        for seed in 0..20 {
            let mut record = record(1, seed);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            for value in &mut record.output {
                let draw = |rng: &mut ChaCha8Rng| -> f64 { rand_distr::Exp1.sample(rng) };
                *value += NOISE * (draw(&mut rng) - draw(&mut rng));
            }
            assert_eq!(found(&record), [], "{seed}");
        }
    }
}
