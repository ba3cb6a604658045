//! Samples of a record that do not belong to the rest: single values, or a few in a row, that a
//! disturbance of the wires or of the transmission replaced.
//!
//! A channel with three or more periods is compared with the median over the periods. Otherwise it is
//! looked at as it is, but for an acceleration, which may jump. So may an input, and it may consist of
//! pulses: what stands out of it must be a small part of it. Samples are bad if their neighbours on both
//! sides do not lead to them, and if the channel is as smooth as elsewhere once they are interpolated. A
//! channel that is disturbed for longer at more places than these has none: something acts on it now and
//! then.

mod jumps;
mod suspect;
#[cfg(test)]
mod tests;

use super::clipping::CutOff;
use super::spectrum::Periods;
use super::{Experiment, Record, ResponseKind, resolution};
use crate::answers::Channel;
use jumps::Jumps;
use suspect::Suspects;

/// Fewest periods whose median tells what belongs.
const FEWEST_PERIODS: usize = 3;

/// Largest share of the samples of a record that can be bad, and number that always can.
const MOST_SHARE: f64 = 0.01;
const MOST_ALWAYS: usize = 8;

/// Samples at nearly the same place of two periods, within so many samples, are no accident: what
/// happens there varies from period to period.
const SAME_PLACE: usize = 3;

/// Largest share of the energy of an input, Σ(u − mean)², that bad samples can have where no other periods
/// tell that they do not belong. Of an input of pulses these are all.
const MOST_ENERGY: f64 = 0.05;

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
        if kind != ResponseKind::Acceleration || is_periodic(periods) {
            let moves_on = kind == ResponseKind::Position;
            bad.extend(mend(&mut mended.output, Channel::Response, periods, moves_on));
        }
        for one in &mut bad {
            one.time_s = self.time_s.get(one.first).copied().unwrap_or_default();
        }
        (!bad.is_empty()).then_some((mended, bad))
    }
}

/// Whether there are enough periods, of whole samples, to compare with each other.
fn is_periodic(Periods { samples, count }: Periods) -> bool {
    samples.fract() == 0.0 && count >= FEWEST_PERIODS
}

/// Interpolates the bad samples of the last periods of a channel, and returns them. A channel that
/// `moves_on` may end a period elsewhere than it began.
fn mend(values: &mut [f64], channel: Channel, periods: Periods, moves_on: bool) -> Vec<BadSample> {
    let Periods { samples, count } = periods;
    let length = samples as usize;
    let periodic = is_periodic(periods);
    let begin = values.len().saturating_sub((samples * count as f64).round() as usize);
    let drift = if periodic && moves_on { drift(&values[begin..], length) } else { 0.0 };
    let moved_on = |index: usize| drift * (index - begin) as f64;
    let mut left: Vec<f64> =
        (begin..values.len()).map(|index| values[index] - moved_on(index)).collect();
    let usual = if periodic { median_period(&left, length) } else { vec![0.0] };
    let place = |index: usize| (index - begin) % usual.len();
    (begin..values.len()).zip(&mut left).for_each(|(index, left)| *left -= usual[place(index)]);
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let suspects = Suspects::of(&left, resolution::step(values).max(ARITHMETIC_SHARE * largest));
    let rough = suspects.mend(&mut left);
    let mut found: Vec<BadSample> = rough
        .rows
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
        .collect();
    let mut others = rough.longer;
    // Where the channel cut off a few samples, they have two edges as those of a disturbance do.
    let cut = CutOff::of(&values[begin..]);
    found.retain(|one| !cut.is_at_limit(values, one.first..one.first + one.count));
    if periodic {
        let jumps = Jumps::of(&usual);
        found.retain(|one| {
            let samples = one.first..one.first + one.count;
            let samples: Vec<f64> = samples.map(|index| values[index] - moved_on(index)).collect();
            !jumps.explain(&samples, place(one.first), suspects.std)
        });
        let accidents = accidents(&found, |one| place(one.first), length);
        others += found.len() - accidents.len();
        found = accidents;
    }
    if !periodic && channel == Channel::Input && !is_small_part(&found, &values[begin..]) {
        return Vec::new();
    }
    let all: usize = found.iter().map(|one| one.count).sum();
    // Where more is disturbed, and for longer, these are the shortest of such disturbances.
    if others > found.len() || all > MOST_ALWAYS.max((MOST_SHARE * values.len() as f64) as usize) {
        return Vec::new();
    }
    for one in &found {
        for index in one.first..one.first + one.count {
            values[index] = left[index - begin] + usual[place(index)] + moved_on(index);
        }
    }
    found
}

/// Whether bad samples have little of the energy of an input.
fn is_small_part(found: &[BadSample], input: &[f64]) -> bool {
    let mean = input.iter().sum::<f64>() / input.len().max(1) as f64;
    let energy: f64 = input.iter().map(|value| (value - mean).powi(2)).sum();
    let theirs: f64 = found.iter().map(|one| one.count as f64 * one.off.powi(2)).sum();
    theirs <= MOST_ENERGY * energy
}

/// Those of bad samples that have no others near their place of the period in another period.
fn accidents(
    found: &[BadSample],
    place: impl Fn(&BadSample) -> usize,
    length: usize,
) -> Vec<BadSample> {
    let are_near = |one: &BadSample, other: &BadSample| {
        let distance = place(one).abs_diff(place(other));
        distance.min(length - distance) <= SAME_PLACE
    };
    let is_alone =
        |one: &&BadSample| found.iter().filter(|other| are_near(one, other)).count() == 1;
    found.iter().filter(is_alone).cloned().collect()
}

/// By how much a channel moves on from one sample to the next: the median of its differences over a
/// period, per sample.
fn drift(values: &[f64], length: usize) -> f64 {
    let further = values.iter().skip(length);
    median(values.iter().zip(further).map(|(before, after)| after - before)) / length as f64
}

/// The median over the periods at each of their samples.
fn median_period(values: &[f64], length: usize) -> Vec<f64> {
    let at = |place: usize| values.iter().skip(place).step_by(length).copied();
    (0..length).map(|place| median(at(place))).collect()
}

/// The upper median; 0 if there are no values.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut all: Vec<f64> = values.collect();
    let middle = all.len() / 2;
    if all.is_empty() { 0.0 } else { *all.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
