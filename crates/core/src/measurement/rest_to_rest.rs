//! A motion that begins and ends at rest, as one period of a periodic one.
//!
//! If such a motion were repeated, every repeat would begin in the state in which the first one did, and
//! be the same. So its harmonics are those of a periodic motion whose period is the whole record, and
//! models can be fitted to it.

use std::borrow::Cow;

use super::record::{Record, RecordStatement};
use super::{Intersample, Loop, Measurement, Metadata, ResponseKind, Transient};

/// Blocks at the end of a motion in which the axis must rest, and their length as a share of the
/// motion: 2 % in all.
const RESTING_BLOCKS: usize = 4;
const BLOCK_SHARE: f64 = 0.005;

/// Fewest samples of a block.
const FEWEST_IN_BLOCK: usize = 4;

/// Largest velocity at rest, as a share of the largest, and largest change between the ends of a motion
/// of the input, and of a position that is held, as a share of its range. Set by hand.
const AT_REST: f64 = 0.02;
const RETURNED: f64 = 0.01;

/// Standard deviations of noise that a mean over a block may be off.
const NOISE_DEVIATIONS: f64 = 4.0;

impl Transient {
    /// Whether the axis rests at both ends, under the same input. A position that a controller holds
    /// must also be the same. An acceleration does not tell rest from steady motion.
    pub(super) fn rests(&self, metadata: &Metadata) -> bool {
        let count = self.output.len();
        let block = ((BLOCK_SHARE * count as f64) as usize).max(FEWEST_IN_BLOCK);
        let is_position = metadata.response_kind == ResponseKind::Position;
        let blocks = count / block;
        if metadata.response_kind == ResponseKind::Acceleration || blocks < 4 * RESTING_BLOCKS {
            return false;
        }
        let response = Blocks::of(&self.output, block);
        let input = Blocks::of(&self.input, block);
        // Of a position, its change from block to block is the velocity.
        let velocity = if is_position { response.changes() } else { response.clone() };
        let slow = (AT_REST * velocity.largest()).max(NOISE_DEVIATIONS * velocity.std);
        let is_still = |mean: &f64| mean.abs() <= slow;
        let ends = velocity.means.len() - (RESTING_BLOCKS - 1);
        let returns = |blocks: &Blocks| {
            let [least, most] = blocks.range();
            let allowed = (RETURNED * (most - least)).max(NOISE_DEVIATIONS * blocks.std);
            let first = blocks.means[0];
            let last = &blocks.means[blocks.means.len() - (RESTING_BLOCKS - 1)..];
            most > least && last.iter().all(|mean| (mean - first).abs() <= allowed)
        };
        let is_held = is_position && metadata.feedback == Some(Loop::Closed);
        is_still(&velocity.means[0])
            && velocity.means[ends..].iter().all(is_still)
            && returns(&input)
            && (!is_held || returns(&response))
    }

    /// The motion as a record.
    fn record(&self) -> Record {
        Record {
            time_s: (0..self.input.len()).map(|i| i as f64 * self.step_s).collect(),
            input: self.input.clone(),
            output: self.output.clone(),
            run: self.run,
        }
    }
}

/// Means over blocks of samples; the samples that are left over at the beginning are not used.
#[derive(Clone)]
struct Blocks {
    means: Vec<f64>,
    /// Standard deviation of the mean of the last block from its scatter.
    std: f64,
}

impl Blocks {
    fn of(samples: &[f64], block: usize) -> Self {
        let used = &samples[samples.len() % block..];
        let mean = |samples: &[f64]| samples.iter().sum::<f64>() / samples.len() as f64;
        let means: Vec<f64> = used.chunks_exact(block).map(mean).collect();
        let (last, at) = (&used[used.len() - block..], means.last().copied().unwrap_or(0.0));
        let squares: f64 = last.iter().map(|value| (value - at) * (value - at)).sum();
        let std = (squares / (block - 1) as f64 / block as f64).sqrt();
        Self { means, std }
    }

    fn changes(&self) -> Self {
        let means = self.means.windows(2).map(|pair| pair[1] - pair[0]).collect();
        Self { means, std: self.std * std::f64::consts::SQRT_2 }
    }

    fn range(&self) -> [f64; 2] {
        let least = self.means.iter().copied().fold(f64::INFINITY, f64::min);
        [least, self.means.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
    }

    fn largest(&self) -> f64 {
        self.range()[0].abs().max(self.range()[1].abs())
    }
}

impl Measurement {
    /// The measurement as a fit takes it: motions that begin and end at rest as one period each. Other
    /// motions are left out, with a remark; where none rests, nothing is changed.
    pub fn repeated(&self) -> Cow<'_, Self> {
        if self.transients().is_empty() {
            return Cow::Borrowed(self);
        }
        let metadata = self.metadata();
        let (mut experiments, mut notes) = (Vec::new(), self.notes().to_vec());
        for (index, motion) in self.transients().iter().enumerate() {
            let number = index + 1;
            let duration_s = motion.step_s * motion.input.len() as f64;
            let stated = RecordStatement {
                kind: metadata.response_kind,
                feedback: metadata.feedback,
                intersample: Some(motion.intersample).filter(|way| *way == Intersample::Hold),
                ..RecordStatement::default()
            };
            if !motion.rests(metadata) {
                let left_out = "does not begin and end at rest: it is left out";
                notes.push(format!("motion {number} {left_out}"));
                continue;
            }
            let (experiment, remarks) = motion.record().one_period(stated, duration_s);
            experiments.push(experiment);
            notes.extend(remarks.into_iter().map(|text| format!("motion {number}: {text}")));
        }
        let sha256 = self.sha256().to_owned();
        let repeated = Self::new(metadata.clone(), experiments, notes, sha256);
        repeated.map_or(Cow::Borrowed(self), Cow::Owned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 4000 samples: a sweep between two rests, of which the last is as long as `rest` samples; the
    /// axis ends at `end`.
    fn motion(rest: usize, end: f64) -> Transient {
        let moving = 200..4000 - rest;
        let share = |i: usize| (i - moving.start) as f64 / moving.len() as f64;
        let swing = |i: usize| (60.0 * share(i) * share(i)).sin() * (1.0 - share(i)).min(0.1);
        let sample = |i: usize| if moving.contains(&i) { swing(i) } else { 0.0 };
        // Noise of a thousandth of the motion.
        let noise = |i: usize| 1e-4 * (1.7 * (i * i % 97) as f64).sin();
        let left = |i: usize| if i < moving.end { 0.0 } else { end };
        Transient {
            step_s: 1e-3,
            input: (0..4000).map(sample).collect(),
            output: (0..4000).map(|i| sample(i) + left(i) + noise(i)).collect(),
            ..Transient::default()
        }
    }

    fn metadata(response_kind: ResponseKind, feedback: Option<Loop>) -> Metadata {
        Metadata { response_kind, feedback, ..Metadata::default() }
    }

    #[test]
    fn a_motion_rests_where_it_is_still_at_both_ends_under_the_same_input() {
        let velocity = metadata(ResponseKind::Velocity, None);
        assert!(motion(400, 0.0).rests(&velocity));
        assert!(!motion(0, 0.0).rests(&velocity), "it has moved until the end");
        assert!(!motion(400, 0.05).rests(&velocity), "it runs on");
        let mut held = motion(400, 0.0);
        held.input[3600..].fill(0.05);
        assert!(!held.rests(&velocity), "the input differs");
        let still = Transient { input: vec![0.0; 4000], ..motion(400, 0.0) };
        assert!(!still.rests(&velocity), "nothing drives it");
    }

    #[test]
    fn a_position_may_end_elsewhere_unless_a_controller_holds_it() {
        let of = |feedback| metadata(ResponseKind::Position, feedback);
        assert!(motion(400, 0.05).rests(&of(None)));
        assert!(!motion(400, 0.05).rests(&of(Some(Loop::Closed))));
        assert!(motion(400, 0.0).rests(&of(Some(Loop::Closed))));
        assert!(!motion(400, 0.0).rests(&metadata(ResponseKind::Acceleration, None)));
    }

    #[test]
    fn motions_at_rest_are_fitted_as_one_period_each_and_others_are_left_out() {
        let all = vec![motion(400, 0.0), motion(0, 0.0)];
        let measured =
            Measurement::of_transients(Metadata::default(), all, Vec::new(), String::new())
                .unwrap();
        let repeated = measured.repeated();
        assert_eq!((repeated.experiments().len(), repeated.transients().len()), (1, 0));
        let omega = repeated.experiments()[0].omega_rad_s;
        assert!((omega - std::f64::consts::TAU / 4.0).abs() < 1e-9, "{omega}");
        let says = |words: &str| repeated.notes().iter().any(|note| note.contains(words));
        assert!(
            says("motion 1: one whole period") && says("motion 2 does not begin and end at rest")
        );
        let moving = vec![motion(0, 0.0)];
        let moving =
            Measurement::of_transients(Metadata::default(), moving, Vec::new(), String::new());
        let moving = moving.unwrap();
        assert_eq!(*moving.repeated(), moving);
    }
}
