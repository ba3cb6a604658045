//! Brings entries at unequal times to equal ones, as BAM itself does before a fit.
//!
//! Input and response are read on straight lines between the entries, at the same times. What that
//! takes from their fast parts it takes from both alike, so that their ratio stays.

use std::ops::Range;

use super::entries::{POSITION, TIME, place};
use crate::measurement::formats::fault::Fault;
use crate::measurement::record_error::RecordError;
use crate::measurement::sampling;

/// Distance of a position from that of the entry before that no servo covers meanwhile, rad.
const JUMP_RAD: f64 = 1.0;

/// Of so many entries at most one may be a dropout.
const ENTRIES_PER_DROPOUT: usize = 20;

/// Longest time between two entries that is bridged by a line, in median times. A dropout leaves 2.
const LONGEST_GAP: f64 = 2.5;

/// The signals of a log, one number for every entry.
#[derive(Clone, Copy)]
pub(super) struct Signals<'a> {
    /// Times, s.
    pub(super) time_s: &'a [f64],
    /// Positions, rad.
    pub(super) position: &'a [f64],
    /// Input, input units.
    pub(super) input: &'a [f64],
    /// Response, rad or rad/s.
    pub(super) output: &'a [f64],
    /// Whether input or response is made of the position.
    pub(super) uses_position: bool,
}

/// Entries that follow each other, at equal times.
pub(super) struct Even {
    /// Times, s.
    pub(super) time_s: Vec<f64>,
    /// Input, input units.
    pub(super) input: Vec<f64>,
    /// Response, rad or rad/s.
    pub(super) output: Vec<f64>,
    /// Entries that are left out because their position jumps and returns.
    pub(super) dropouts: Vec<usize>,
    /// Shortest and longest time between the entries, and the equal time that stands for them, s;
    /// `None` if they were equal.
    pub(super) steps_s: Option<[f64; 3]>,
}

impl Signals<'_> {
    /// These entries at equal times.
    ///
    /// # Errors
    /// If time does not increase, entries are too far apart, dropouts are many, or a position that
    /// is used jumps and stays there.
    pub(super) fn even(&self, entries: Range<usize>) -> Result<Even, Fault> {
        let kept = kept(self.position, &entries);
        let dropouts: Vec<usize> =
            entries.clone().filter(|entry| kept.binary_search(entry).is_err()).collect();
        if let [first, ..] = dropouts.as_slice()
            && dropouts.len() * ENTRIES_PER_DROPOUT > entries.len()
        {
            let reason = format!(
                "in {} of {} entries the position jumps by more than {JUMP_RAD} rad and returns, \
                 first here: it is not the position of the axis",
                dropouts.len(),
                entries.len(),
            );
            return Err(place(*first, POSITION, reason));
        }
        if self.uses_position {
            self.check_position(&kept)?;
        }
        let range = self.check_times(&kept)?;
        let of = |values: &[f64]| kept.iter().map(|entry| values[*entry]).collect::<Vec<_>>();
        let (time_s, input, output) = (of(self.time_s), of(self.input), of(self.output));
        let is_even = dropouts.is_empty() && sampling::step_s(&time_s).is_ok();
        let Some([shortest_s, longest_s]) = range.filter(|_| !is_even) else {
            return Ok(Even { time_s, input, output, dropouts, steps_s: None });
        };
        let count = entries.len();
        let step_s = (time_s[time_s.len() - 1] - time_s[0]) / (count - 1) as f64;
        let grid: Vec<f64> = (0..count).map(|n| time_s[0] + n as f64 * step_s).collect();
        Ok(Even {
            input: on_lines(&time_s, &input, &grid),
            output: on_lines(&time_s, &output, &grid),
            time_s: grid,
            dropouts,
            steps_s: Some([shortest_s, longest_s, step_s]),
        })
    }

    fn check_position(&self, kept: &[usize]) -> Result<(), Fault> {
        let jump = |pair: &&[usize]| jumps(self.position[pair[0]], self.position[pair[1]]);
        let Some(pair) = kept.windows(2).find(jump) else { return Ok(()) };
        let [before, here] = [self.position[pair[0]], self.position[pair[1]]];
        let reason = format!(
            "the position jumps from {before} rad to {here} rad and does not return with the next \
             entry: where it was wrapped into one turn, unwrap it; leave out false readings at the \
             beginning and at the end"
        );
        Err(place(pair[1], POSITION, reason))
    }

    /// The shortest and the longest time between entries, s; `None` where there are fewer than three
    /// entries.
    fn check_times(&self, kept: &[usize]) -> Result<Option<[f64; 2]>, Fault> {
        let mut steps_s = Vec::new();
        for pair in kept.windows(2) {
            let [before_s, time_s] = [self.time_s[pair[0]], self.time_s[pair[1]]];
            if time_s <= before_s {
                let reason = RecordError::NotIncreasing { sample: pair[1], time_s, before_s };
                return Err(place(pair[1], TIME, reason.to_string()));
            }
            steps_s.push(time_s - before_s);
        }
        let mut sorted = steps_s.clone();
        sorted.sort_by(f64::total_cmp);
        let [shortest_s, .., longest_s] = sorted[..] else { return Ok(None) };
        let usual_s = sorted[sorted.len() / 2];
        match steps_s.iter().position(|step_s| *step_s > LONGEST_GAP * usual_s) {
            Some(gap) => {
                let reason = format!(
                    "{:.6} s pass since the entry before, where {usual_s:.6} s are usual: too long \
                     for a straight line between the two. Write the entries up to there and those \
                     from there on as two logs",
                    steps_s[gap]
                );
                Err(place(kept[gap + 1], TIME, reason))
            }
            None => Ok(Some([shortest_s, longest_s])),
        }
    }
}

fn jumps(from: f64, to: f64) -> bool {
    (to - from).abs() > JUMP_RAD
}

/// The entries without those of which the position jumps away from that of the entry before and is
/// back with the next one. The first and the last are always among them.
fn kept(position: &[f64], entries: &Range<usize>) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for entry in entries.clone() {
        let next = (entry + 1 < entries.end).then(|| position[entry + 1]);
        let dropout = kept.last().zip(next).is_some_and(|(before, next)| {
            let before = position[*before];
            jumps(before, position[entry]) && jumps(position[entry], next) && !jumps(before, next)
        });
        if !dropout {
            kept.push(entry);
        }
    }
    kept
}

/// The values at other times, which increase, on straight lines between at least two.
fn on_lines(time_s: &[f64], values: &[f64], at_s: &[f64]) -> Vec<f64> {
    let mut line = 0;
    let value = |at: &f64| {
        while line + 2 < time_s.len() && time_s[line + 1] < *at {
            line += 1;
        }
        let share = (at - time_s[line]) / (time_s[line + 1] - time_s[line]);
        values[line] + share.clamp(0.0, 1.0) * (values[line + 1] - values[line])
    };
    at_s.iter().map(value).collect()
}
