//! The input of a plan as samples in CSV, which a generator or a drive can play.
//!
//! Once a column `output` is added, the file is a time record that servoscope reads: every experiment is a
//! segment, and rows without a segment (ramps and settling) belong to none.

mod crest_factor;
mod multisine;
mod stepped_sine;

use std::fmt::Write as _;

use crate::answers::Plan;
use crate::measurement::formats::MAX_ROWS;

use super::design::sample_s;
use super::error::PlanError;
use super::setting::Setting;

/// Decimals of a time: rounding is a ten-thousandth of a sample at most.
const TIME_DIGITS: i32 = 4;

/// Which input is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExcitationKind {
    /// Every experiment of the plan, one after the other.
    SteppedSine,
    /// Odd lines over the whole band at once, at up to three magnitudes.
    Multisine,
}

impl std::str::FromStr for ExcitationKind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "stepped-sine" => Ok(Self::SteppedSine),
            "multisine" => Ok(Self::Multisine),
            other => {
                Err(format!("`{other}` is not an excitation; there are stepped-sine and multisine"))
            }
        }
    }
}

/// Why an excitation cannot be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExcitationError {
    /// The request of the plan cannot be used.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// It has more samples than a file may have.
    #[error(
        "the excitation has {samples} samples, more than the {MAX_ROWS} of a file: lower the highest \
         frequency or the budget"
    )]
    TooLong {
        /// Number of samples.
        samples: usize,
    },
    /// A multisine does not fit.
    #[error(
        "a multisine from {lowest_rad_s:.4} rad/s up does not fit: {reason}; raise the lowest \
         frequency or the budget, or take the stepped sine"
    )]
    NoMultisine {
        /// Its lowest frequency, rad/s.
        lowest_rad_s: f64,
        /// Why.
        reason: String,
    },
}

/// Samples of an input.
struct Samples {
    /// Time between two, s.
    step_s: f64,
    /// Input, and the segment that it belongs to.
    values: Vec<(f64, Option<usize>)>,
    /// Comments for the reader of the file.
    comments: Vec<String>,
}

/// The input of a plan as CSV: `time_s`, `input` and `segment`, with comments in front.
///
/// # Errors
/// See [`ExcitationError`].
pub fn excitation(plan: &Plan, kind: ExcitationKind) -> Result<String, ExcitationError> {
    let setting = Setting::of(&plan.request)?;
    // Before the samples are made: they take as much memory as there are.
    let fewest = match kind {
        ExcitationKind::SteppedSine => plan.duration_s / sample_s(&setting),
        ExcitationKind::Multisine => multisine::fewest_samples(&setting),
    };
    if fewest > MAX_ROWS as f64 {
        return Err(ExcitationError::TooLong { samples: fewest as usize });
    }
    let samples = match kind {
        ExcitationKind::SteppedSine => stepped_sine::samples(plan, &setting),
        ExcitationKind::Multisine => multisine::samples(&setting)?,
    };
    match samples.values.len() {
        count if count > MAX_ROWS => Err(ExcitationError::TooLong { samples: count }),
        _ => Ok(csv(&samples)),
    }
}

fn csv(samples: &Samples) -> String {
    let mut text = String::with_capacity(32 * samples.values.len());
    for comment in &samples.comments {
        let _ = writeln!(text, "# {comment}");
    }
    text.push_str("# blank_segments: unused\ntime_s,input,segment\n");
    let digits = (TIME_DIGITS - samples.step_s.log10().floor() as i32).max(0) as usize;
    for (index, (value, segment)) in samples.values.iter().enumerate() {
        let time_s = index as f64 * samples.step_s;
        let _ = write!(text, "{time_s:.digits$},{value:.9e},");
        match segment {
            Some(segment) => {
                let _ = writeln!(text, "{segment}");
            }
            None => text.push('\n'),
        }
    }
    text
}
