//! Spikes, gaps, and what looks like them.

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
        input: all().map(square).zip(noise(periods * LENGTH, seed)).map(|(x, e)| x + e).collect(),
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
    found_in(record, ResponseKind::Velocity)
}

fn found_in(record: &Record, kind: ResponseKind) -> Vec<(Channel, usize, usize)> {
    let bad = record.without_bad_samples(periods(record), kind);
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
fn a_spike_in_a_position_that_moves_on_from_period_to_period_is_found() {
    let mut record = record(4, 23);
    for (index, value) in record.output.iter_mut().enumerate() {
        *value += 0.5 * index as f64 / LENGTH as f64;
    }
    assert_eq!(found_in(&record, ResponseKind::Position), []);
    record.output[3 * LENGTH + 150] -= 1.6;
    record.output[3 * LENGTH + 350] += 0.7;
    let expected = [3 * LENGTH + 150, 3 * LENGTH + 350].map(|at| (Channel::Response, at, 1));
    assert_eq!(found_in(&record, ResponseKind::Position), expected);
}

#[test]
fn an_input_may_jump_but_differs_from_its_other_periods_only_where_it_is_disturbed() {
    let mut record = record(4, 3);
    assert_eq!(found(&record), []);
    record.input[2 * LENGTH + 30] = 0.0;
    assert_eq!(found(&record), [(Channel::Input, 2 * LENGTH + 30, 1)]);
}

#[test]
fn a_spike_in_an_input_without_other_periods_is_found_but_an_input_of_pulses_has_none() {
    let smooth = |n: usize| (TAU * n as f64 / 40.0).sin();
    let mut record = record(1, 21);
    assert_eq!(found(&record), [], "a square wave");
    record.input = (0..LENGTH).map(smooth).collect();
    record.input[130] += 2.0;
    assert_eq!(found(&record), [(Channel::Input, 130, 1)]);
    record.input.iter_mut().for_each(|value| *value *= 0.2);
    record.input[130] += 1.6;
    assert_eq!(found(&record), [], "half of the energy is in a pulse");
    record.input.fill(0.0);
    record.input[130..134].fill(1.0);
    assert_eq!(found(&record), []);
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

#[test]
fn where_more_is_disturbed_than_a_few_samples_the_shortest_disturbances_are_no_bad_samples() {
    let mut record = record(4, 17);
    record.input[2 * LENGTH + 330] += 0.5;
    assert_eq!(found(&record), [(Channel::Input, 2 * LENGTH + 330, 1)]);
    for at in [30, LENGTH + 250] {
        let burst = |n: usize| if n.is_multiple_of(3) { 0.5 } else { -0.25 };
        (0..10).for_each(|n| record.input[at + n] += burst(n));
    }
    assert_eq!(found(&record), []);
}

// Eight samples in each cycle: with the spike, the signal is still between what it is a sample before and
// after.
#[test]
fn a_spike_in_a_fast_input_is_found_by_its_other_periods() {
    let mut record = record(4, 19);
    for (index, value) in record.input.iter_mut().enumerate() {
        *value = (TAU * index as f64 / 8.0).sin() + 1e-3 * *value;
    }
    record.input[LENGTH + 33] -= 0.4;
    assert_eq!(found(&record), [(Channel::Input, LENGTH + 33, 1)]);
}

#[test]
fn the_top_of_a_wave_that_was_cut_off_is_no_bad_sample() {
    let angle = |n: usize| TAU * n as f64 / LENGTH as f64;
    // Of eight waves two are cut off, for six samples and for two.
    let wave = |n: usize| (1.0 + 0.8 * angle(n).cos()) * (8.0 * angle(n)).sin();
    let read = |(n, noise): (usize, f64)| (wave(n) + noise).min(1.647);
    let input: Vec<f64> = (0..LENGTH).zip(noise(LENGTH, 5)).map(read).collect();
    let mut record = Record { input, ..record(1, 1) };
    assert_eq!(found(&record), []);
    record.input[250] += 0.3;
    assert_eq!(found(&record), [(Channel::Input, 250, 1)]);
}
