//! Samples to which their neighbours do not lead.

use statrs::distribution::{ContinuousCDF, Normal};

/// A sample differs from its neighbours if it is further from the cubic through two on each side than
/// this many standard deviations of that distance. With the largest of a million normal values, five,
/// and twice that for noise with more large values than the normal distribution has.
const STANDS_OUT: f64 = 10.0;

/// Largest number of bad samples in a row.
const MOST_IN_A_ROW: usize = 8;

/// Bad samples are off by more than this many times what their two sides differ by: after a jump they
/// are as far off as the sides.
const BEYOND_JUMP: f64 = 2.0;

/// Weights of the neighbours of a cubic at distances of one and two, and the ratio of the standard
/// deviation of the distance from it to that of a sample: √(1 + 2·(2/3)² + 2·(1/6)²).
const NEAR: f64 = 2.0 / 3.0;
const FAR: f64 = -1.0 / 6.0;
const DISTANCE_STD: f64 = 1.394_433_4;

/// Largest number, and at least that share, of distances that bad samples may have changed.
const CHANGED: f64 = 40.0;
const CHANGED_SHARE: f64 = 0.01;

/// Largest share of distances that may have been changed.
const MOST_CHANGED: f64 = 0.5;

/// Samples in a row that do not belong.
#[derive(Clone)]
pub(super) struct InARow {
    /// Index of the first.
    pub first: usize,
    /// Number of samples.
    pub count: usize,
    /// Largest change by the interpolation.
    pub off: f64,
}

/// Where a channel is rougher than usual.
pub(super) struct Rough {
    /// Samples after whose interpolation it is as smooth as elsewhere.
    pub rows: Vec<InARow>,
    /// Number of places where more samples in a row would have to be interpolated than can be bad.
    pub longer: usize,
}

/// What is usual in a channel.
pub(super) struct Suspects {
    limit: f64,
    /// Standard deviation of a sample.
    pub std: f64,
}

impl Suspects {
    /// Of the samples of a channel, without what is known of them. No sample stands out by less than `least`.
    pub fn of(values: &[f64], least: f64) -> Self {
        let mut distances: Vec<f64> =
            (2..values.len().saturating_sub(2)).map(|at| distance(values, at).abs()).collect();
        let count = distances.len() as f64;
        let changed = (CHANGED / count).clamp(CHANGED_SHARE, MOST_CHANGED);
        // The standard deviation of normal values of which the share is smaller, of either sign.
        let mut std = |share: f64| {
            if distances.is_empty() {
                return 0.0;
            }
            let place = (share * count) as usize;
            let quantile = *distances.select_nth_unstable_by(place, f64::total_cmp).1;
            quantile / Normal::standard().inverse_cdf(0.5 * (1.0 + share))
        };
        let usual = std(0.5).max(std(1.0 - changed)).max(least);
        Self { limit: STANDS_OUT * usual, std: usual / DISTANCE_STD }
    }

    fn stands_out(&self, values: &[f64], at: usize) -> bool {
        distance(values, at).abs() > self.limit
    }

    /// Interpolates samples that do not belong, where that makes the channel as smooth as elsewhere.
    pub fn mend(&self, values: &mut [f64]) -> Rough {
        let (mut rows, mut longer) = (Vec::<InARow>::new(), 0);
        let end = values.len().saturating_sub(2);
        let mut at = 2;
        while at < end {
            if !self.stands_out(values, at) {
                at += 1;
                continue;
            }
            match self.mended_near(values, at) {
                Some(one) => {
                    at = one.first + one.count;
                    rows.push(one);
                }
                None => {
                    at += MOST_IN_A_ROW;
                    longer += 1;
                }
            }
        }
        // Rows so near to one another are one disturbance.
        let is_near = |a: &InARow, b: &InARow| b.first - (a.first + a.count) <= MOST_IN_A_ROW;
        let (short, long): (Vec<_>, Vec<_>) =
            rows.chunk_by(is_near).partition(|disturbance| disturbance.len() == 1);
        Rough { rows: short.into_iter().flatten().cloned().collect(), longer: longer + long.len() }
    }

    /// Interpolates the fewest samples near the first one that stands out, after which none does.
    fn mended_near(&self, values: &mut [f64], at: usize) -> Option<InARow> {
        let starts = at..=at + 2;
        let rows = (1..=MOST_IN_A_ROW).flat_map(|count| starts.clone().map(move |i| (i, count)));
        for (first, count) in rows {
            if first + count + 4 > values.len() {
                continue;
            }
            let before = values[first..first + count].to_vec();
            interpolate(values, first, count);
            let near = first.saturating_sub(4).max(2)..(first + count + 4).min(values.len() - 2);
            if near.into_iter().all(|at| !self.stands_out(values, at)) {
                let changes = before.iter().zip(&values[first..]).map(|(a, b)| (a - b).abs());
                let off = changes.fold(0.0, f64::max);
                if off > BEYOND_JUMP * jump(values, first, count) {
                    return Some(InARow { first, count, off });
                }
            }
            values[first..first + count].copy_from_slice(&before);
        }
        None
    }
}

/// Distance of a sample from the cubic through two neighbours on each side.
fn distance(values: &[f64], at: usize) -> f64 {
    let near = values[at - 1] + values[at + 1];
    let far = values[at - 2] + values[at + 2];
    values[at] - NEAR * near - FAR * far
}

/// By how much the two sides of samples differ beyond their slopes.
fn jump(values: &[f64], first: usize, count: usize) -> f64 {
    let [before, after] = [first - 1, first + count];
    let slope = 0.5 * (values[before] - values[before - 1] + values[after + 1] - values[after]);
    (values[after] - values[before] - slope * (count + 1) as f64).abs()
}

/// Replaces samples by the cubic through the two on each side of them.
fn interpolate(values: &mut [f64], first: usize, count: usize) {
    let known = [first - 2, first - 1, first + count, first + count + 1];
    let weight = |node: usize, at: f64| -> f64 {
        let others = known.iter().filter(|other| **other != node);
        others.map(|other| (at - *other as f64) / (node as f64 - *other as f64)).product()
    };
    for at in first..first + count {
        values[at] = known.iter().map(|node| weight(*node, at as f64) * values[*node]).sum();
    }
}
