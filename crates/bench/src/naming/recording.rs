//! Records of a machine, in place of a table: multisines whose response is a velocity or a position, and
//! a trajectory in a position loop.

#[cfg(test)]
mod fixtures;
mod motions;
mod record;

use std::fmt;

use serde::Serialize;
use servoscope_core::measurement::ResponseKind;

use crate::machines::records::Sampling;
pub(super) use record::{Recorded, Wanted};

/// Samples of a record, over all its periods.
const SAMPLES: usize = 8192;
/// Periods, but for records of a single one.
const PERIODS: usize = 4;

/// How a machine is recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Recording {
    /// 200 lines of equal size and random phases, with a response that is a velocity.
    Multisine {
        /// Number of levels, 1 or 2.
        levels: usize,
    },
    /// The multisine at one level as the command of a converter, which holds each sample until the
    /// next. The record does not say so.
    Held,
    /// The multisine at one level with a response that is a position. Nothing holds the axis, so it
    /// moves on where it is not symmetric.
    Position {
        /// Number of periods, 1 or 4, with as many samples in all.
        periods: usize,
    },
    /// The lines of a multisine with the phases of M. R. Schroeder (1970,
    /// doi:10.1109/TIT.1970.1054411), which make a sweep of it, with a response that is a velocity.
    Sweep,
    /// Four periods of a position that a sensor rounds to its resolution.
    Rounded,
    /// A trajectory in a closed position loop: the response is a position, and the input is
    /// measured with noise.
    Trajectory,
}

/// `trajectory`, `multisine at 2 levels`.
impl fmt::Display for Recording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Multisine { levels: 1 } => f.write_str("multisine at 1 level"),
            Self::Multisine { levels } => write!(f, "multisine at {levels} levels"),
            Self::Held => f.write_str("multisine, held between samples"),
            Self::Position { periods: 1 } => f.write_str("one period of a position"),
            Self::Position { periods } => write!(f, "{periods} periods of a position"),
            Self::Sweep => f.write_str("sweep"),
            Self::Rounded => f.write_str("position, rounded by its sensor"),
            Self::Trajectory => f.write_str("trajectory in a position loop"),
        }
    }
}

impl Recording {
    /// All of them.
    pub(super) const ALL: [Self; 8] = [
        Self::Multisine { levels: 1 },
        Self::Multisine { levels: 2 },
        Self::Trajectory,
        Self::Position { periods: PERIODS },
        Self::Position { periods: 1 },
        Self::Held,
        Self::Sweep,
        Self::Rounded,
    ];

    fn kind(self) -> ResponseKind {
        match self {
            Self::Multisine { .. } | Self::Held | Self::Sweep => ResponseKind::Velocity,
            Self::Position { .. } | Self::Rounded | Self::Trajectory => ResponseKind::Position,
        }
    }

    fn sampling(self) -> Sampling {
        let periods = match self {
            Self::Position { periods } => periods,
            _ => PERIODS,
        };
        Sampling { samples: SAMPLES / periods, periods }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recording_is_drawn_and_says_what_it_is() {
        let expected = [
            "multisine at 1 level",
            "multisine at 2 levels",
            "trajectory in a position loop",
            "4 periods of a position",
            "one period of a position",
            "multisine, held between samples",
            "sweep",
            "position, rounded by its sensor",
        ];
        assert_eq!(Recording::ALL.map(|recording| recording.to_string()), expected);
    }
}
