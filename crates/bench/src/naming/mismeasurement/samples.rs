//! Faults of the samples of records: wrong values, and channels that clip.

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use servoscope_core::answers::Channel;
use servoscope_core::measurement::{Measurement, Record};

use super::bad_row::DETECTABLE_SIGMAS;
use super::{Mismeasurement, Mistake, Sort};
use crate::machines::draw::log_uniform;
use crate::machines::noise::NoiseLaw;
use crate::naming::build_case::Made;
use crate::naming::recording::Recording;

/// Most places at which samples are bad, and most of them in a row.
const MOST_PLACES: usize = 5;
const MOST_IN_A_ROW: usize = 4;
/// Smallest and largest spike, as a share of the largest value of its channel.
const SPIKE: [f64; 2] = [0.1, 1.0];
/// Smallest and largest limit of a channel that clips, as a share of its largest value.
const LIMIT: [f64; 2] = [0.6, 0.95];

/// Samples in a row with a wrong value.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spoilt {
    /// Index of the experiment, from 0.
    pub experiment: usize,
    /// The channel.
    pub channel: Channel,
    /// Index of the first sample.
    pub first: usize,
    /// Number of samples.
    pub count: usize,
    /// What they read, units of the channel.
    pub value: f64,
}

impl Mistake {
    /// Draws a fault of the samples of records; returns it and what the records then are. `None` if
    /// they cannot be read.
    pub(in crate::naming) fn in_samples(
        sort: Sort,
        made: &Made,
        recording: Recording,
        rng: &mut ChaCha8Rng,
    ) -> Option<(Self, Measurement)> {
        let fault = match sort {
            Sort::ClippedInput => clipped(Channel::Input, &made.records, rng),
            Sort::ClippedResponse => clipped(Channel::Response, &made.records, rng),
            _ => Mismeasurement::BadSamples(spoilt(&made.records, rng)),
        };
        let records: Vec<Record> = made
            .records
            .iter()
            .enumerate()
            .map(|(index, record)| {
                let mut record = record.clone();
                fault.spoil_samples(index, &mut record);
                record
            })
            .collect();
        let sound = &made.measurement;
        let fundamentals = sound.experiments().iter().map(|one| one.omega_rad_s);
        let faulty = recording.read(&records, fundamentals)?;
        let shows = match &fault {
            Mismeasurement::BadSamples(all) => are_detectable(all, &made.records, &made.noise),
            _ => fault.shows(sound, &faulty, &made.noise),
        };
        Some((Self { sort, fault, shows, sound: sound.clone() }, faulty))
    }
}

impl Mismeasurement {
    fn spoil_samples(&self, index: usize, record: &mut Record) {
        match self {
            Self::BadSamples(all) => {
                for one in all.iter().filter(|one| one.experiment == index) {
                    values(record, one.channel)[one.first..one.first + one.count].fill(one.value);
                }
            }
            Self::Clipped { channel, limit, .. } => {
                for value in values(record, *channel) {
                    *value = value.clamp(-limit, *limit);
                }
            }
            _ => {}
        }
    }
}

fn values(record: &mut Record, channel: Channel) -> &mut [f64] {
    match channel {
        Channel::Input => &mut record.input,
        Channel::Response => &mut record.output,
    }
}

fn read(record: &Record, channel: Channel) -> &[f64] {
    match channel {
        Channel::Input => &record.input,
        Channel::Response => &record.output,
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| largest.max(value.abs()))
}

/// One to five places: spikes of one sample, and gaps of up to four that read zero.
fn spoilt(records: &[Record], rng: &mut ChaCha8Rng) -> Vec<Spoilt> {
    let count = rng.random_range(1..=MOST_PLACES);
    let one = |_| {
        let experiment = rng.random_range(0..records.len());
        let channel = *[Channel::Input, Channel::Response].choose(rng).unwrap_or(&Channel::Input);
        let values = read(&records[experiment], channel);
        let first = rng.random_range(0..values.len() - MOST_IN_A_ROW);
        if rng.random() {
            let size = log_uniform(SPIKE[0], SPIKE[1], rng) * largest(values);
            let value = values[first] + if rng.random() { size } else { -size };
            return Spoilt { experiment, channel, first, count: 1, value };
        }
        let count = rng.random_range(1..=MOST_IN_A_ROW);
        Spoilt { experiment, channel, first, count, value: 0.0 }
    };
    (0..count).map(one).collect()
}

/// A limit that is the same for all records.
fn clipped(channel: Channel, records: &[Record], rng: &mut ChaCha8Rng) -> Mismeasurement {
    let all = || records.iter().flat_map(|record| read(record, channel));
    let most = records.iter().map(|record| largest(read(record, channel))).fold(0.0, f64::max);
    let limit = rng.random_range(LIMIT[0]..LIMIT[1]) * most;
    let cut = all().filter(|value| value.abs() > limit).count();
    let share = cut as f64 / all().count().max(1) as f64;
    Mismeasurement::Clipped { channel, limit, share }
}

/// Whether any sample is off by more than five standard deviations of the response's noise, or is of
/// an input, which has none or little.
fn are_detectable(all: &[Spoilt], records: &[Record], law: &NoiseLaw) -> bool {
    all.iter().any(|one| {
        let values = read(&records[one.experiment], one.channel);
        let std = match one.channel {
            Channel::Input => 0.0,
            // The standard deviation of a line of N samples is √(2/N) of that of a sample.
            Channel::Response => law.floor * (0.5 * values.len() as f64).sqrt(),
        };
        let row = &values[one.first..one.first + one.count];
        row.iter().any(|value| (value - one.value).abs() > DETECTABLE_SIGMAS * std)
    })
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    fn record() -> Record {
        let values = |factor: f64| (0..400).map(|n| factor * (0.1 * f64::from(n)).sin()).collect();
        let time_s = (0..400).map(f64::from).collect();
        Record { time_s, input: values(1.0), output: values(3.0), run: None }
    }

    #[test]
    fn bad_samples_change_their_channel_alone_by_spikes_and_gaps_of_zeros() {
        let rng = &mut ChaCha8Rng::seed_from_u64(3);
        let (mut spikes, mut gaps) = (0, 0);
        for _ in 0..50 {
            let all = spoilt(&[record()], rng);
            assert!((1..=MOST_PLACES).contains(&all.len()));
            for one in all {
                let mut after = record();
                Mismeasurement::BadSamples(vec![one]).spoil_samples(0, &mut after);
                let changed = |channel| {
                    let pairs = read(&record(), channel).to_vec().into_iter();
                    pairs.zip(read(&after, channel)).filter(|(a, b)| a != *b).count()
                };
                let [here, there] = match one.channel {
                    Channel::Input => [changed(Channel::Input), changed(Channel::Response)],
                    Channel::Response => [changed(Channel::Response), changed(Channel::Input)],
                };
                assert!((1..=one.count).contains(&here) && there == 0, "{one:?}");
                match one.value == 0.0 {
                    true => gaps += 1,
                    false => spikes += 1,
                }
            }
        }
        assert!(spikes > 20 && gaps > 20, "{spikes} {gaps}");
    }

    #[test]
    fn a_channel_that_clips_reads_nothing_beyond_its_limit() {
        let rng = &mut ChaCha8Rng::seed_from_u64(5);
        let fault = clipped(Channel::Response, &[record()], rng);
        let Mismeasurement::Clipped { limit, share, .. } = fault else { panic!("{fault:?}") };
        let mut after = record();
        fault.spoil_samples(0, &mut after);
        assert_eq!((largest(&after.output), after.input), (limit, record().input));
        // A sine is above 0.95 of its largest value for a fifth of the time, above 0.6 for 59 %.
        assert!((0.19..0.6).contains(&share) && limit > 1.7, "{share} {limit}");
    }

    #[test]
    fn samples_are_detectable_where_they_are_beyond_the_noise() {
        let records = [record()];
        let row = |value| Spoilt {
            experiment: 0,
            channel: Channel::Response,
            first: 63,
            count: 1,
            value: records[0].output[63] + value,
        };
        // A line of 400 samples has √(2/400) of the noise of a sample, which is 0.01.
        let law = NoiseLaw::uniform(0.01 / 200.0_f64.sqrt());
        assert!(!are_detectable(&[row(0.049)], &records, &law));
        assert!(are_detectable(&[row(0.051)], &records, &law));
    }
}
