//! Faults of a measurement, drawn at random and applied to a measurement that has none.

mod apply;
mod bad_row;
mod draw;
#[cfg(test)]
mod fixtures;
mod samples;
mod sort;

use std::fmt;

use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use servoscope_core::answers::Channel;
use servoscope_core::measurement::{InvalidMeasurement, Measurement};

use crate::machines::noise::NoiseLaw;
pub use bad_row::BadRow;
pub use samples::Spoilt;
pub use sort::{Sort, drawn_fault};

/// What is wrong with a measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mismeasurement {
    /// These rows have wrong values.
    BadRows(Vec<BadRow>),
    /// The stated standard deviations are `factor` times the true ones.
    StdFactor {
        /// Stated over true standard deviation.
        factor: f64,
    },
    /// One magnitude was measured with another gain.
    LevelGain {
        /// The magnitude, input units.
        magnitude: f64,
        /// Measured over true response.
        factor: f64,
    },
    /// One magnitude was measured with another phase.
    LevelPhase {
        /// The magnitude, input units.
        magnitude: f64,
        /// Angle by which the fundamental is ahead; harmonic k is ahead by k times that. Degrees.
        degrees: f64,
    },
    /// One experiment was measured with another gain.
    RunGain {
        /// Its index, from 0.
        experiment: usize,
        /// Measured over true response.
        factor: f64,
    },
    /// One experiment was measured with another phase.
    RunPhase {
        /// Its index, from 0.
        experiment: usize,
        /// Angle by which the fundamental is ahead; harmonic k is ahead by k times that. Degrees.
        degrees: f64,
    },
    /// The imaginary parts have the wrong sign.
    Conjugated,
    /// Harmonics refer to a sine: harmonic k ≥ 1 is turned by −(k−1)·90°.
    SineReference,
    /// The response has the wrong sign.
    ReversedSign,
    /// The response is the position, without a mean, but is called a velocity.
    PositionCalledVelocity,
    /// Harmonics from the first on are rms values, but are called peak values.
    RmsCalledPeak,
    /// Harmonics from the first on are peak-to-peak values, but are called peak values.
    PeakToPeakCalledPeak,
    /// The response is ahead of the input by a constant time.
    ChannelSkew {
        /// The time, s.
        seconds: f64,
    },
    /// These samples of records have wrong values.
    BadSamples(Vec<Spoilt>),
    /// A channel of records reads no value beyond a limit of either sign.
    Clipped {
        /// The channel.
        channel: Channel,
        /// The limit, units of the channel.
        limit: f64,
        /// Share of the samples that are cut off.
        share: f64,
    },
}

impl Mismeasurement {
    /// The rows with wrong values; none of other faults.
    pub fn bad_rows(&self) -> &[BadRow] {
        match self {
            Self::BadRows(rows) => rows,
            _ => &[],
        }
    }

    /// The only experiment with wrong values, from 0; `None` if there are several.
    pub fn experiment(&self) -> Option<usize> {
        match self {
            Self::RunGain { experiment, .. } | Self::RunPhase { experiment, .. } => {
                Some(*experiment)
            }
            _ => None,
        }
    }

    /// The only magnitude with wrong values, input units; `None` if there are several.
    pub fn magnitude(&self) -> Option<f64> {
        match self {
            Self::LevelGain { magnitude, .. } | Self::LevelPhase { magnitude, .. } => {
                Some(*magnitude)
            }
            _ => None,
        }
    }
}

/// What is wrong, in a few words: `gain × 1.043 at magnitude 3.2`.
impl fmt::Display for Mismeasurement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadRows(rows) => {
                let detectable = rows.iter().filter(|row| row.is_detectable()).count();
                write!(f, "bad rows: {}, detectable {detectable}", rows.len())
            }
            Self::StdFactor { factor } => write!(f, "stated standard deviations × {factor:.3}"),
            Self::LevelGain { magnitude, factor } => {
                write!(f, "gain × {factor:.3} at magnitude {magnitude:.4}")
            }
            Self::LevelPhase { magnitude, degrees } => {
                write!(f, "phase {degrees:+.2}° at magnitude {magnitude:.4}")
            }
            Self::RunGain { experiment, factor } => {
                write!(f, "gain × {factor:.3} in experiment {experiment}")
            }
            Self::RunPhase { experiment, degrees } => {
                write!(f, "phase {degrees:+.2}° in experiment {experiment}")
            }
            Self::Conjugated => f.write_str("imaginary parts with the wrong sign"),
            Self::SineReference => f.write_str("harmonics that refer to a sine"),
            Self::ReversedSign => f.write_str("a response with the wrong sign"),
            Self::PositionCalledVelocity => f.write_str("a position called velocity"),
            Self::RmsCalledPeak => f.write_str("rms values called peak values"),
            Self::PeakToPeakCalledPeak => f.write_str("peak-to-peak values called peak values"),
            Self::ChannelSkew { seconds } => write!(f, "a response ahead by {seconds:.3e} s"),
            Self::BadSamples(all) => write!(f, "bad samples at {} places", all.len()),
            Self::Clipped { channel, share, .. } => {
                let channel = match channel {
                    Channel::Input => "input",
                    Channel::Response => "response",
                };
                write!(
                    f,
                    "the channel of the {channel} cuts off {:.1} % of the samples",
                    100.0 * share
                )
            }
        }
    }
}

/// A fault in the measurement of a draw.
#[derive(Debug, Clone, PartialEq)]
pub struct Mistake {
    /// Its sort.
    pub sort: Sort,
    /// The fault.
    pub fault: Mismeasurement,
    /// Whether it moves a row by more than five true standard deviations, or misstates these.
    pub shows: bool,
    /// The measurement without it.
    pub sound: Measurement,
}

impl Mistake {
    /// Draws a fault of this sort in a measurement, of which `exact` has no noise; returns it and the
    /// measurement with it.
    ///
    /// # Errors
    /// See [`Mismeasurement::apply`].
    pub(super) fn make(
        sort: Sort,
        sound: Measurement,
        exact: &Measurement,
        law: &NoiseLaw,
        rng: &mut ChaCha8Rng,
    ) -> Result<(Self, Measurement), InvalidMeasurement> {
        let fault = Mismeasurement::draw(sort, [&sound, exact], law, rng);
        let faulty = fault.apply(&sound)?;
        let shows = fault.shows(&sound, &faulty, law);
        Ok((Self { sort, fault, shows, sound }, faulty))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_text_says_what_is_wrong_where_and_by_how_much() {
        let row = |sigmas| BadRow { experiment: 0, harmonic: 1, repeat: None, factor: 1.1, sigmas };
        for (fault, text) in [
            (Mismeasurement::BadRows(vec![row(4.9), row(5.1)]), "bad rows: 2, detectable 1"),
            (Mismeasurement::StdFactor { factor: 0.5 }, "stated standard deviations × 0.500"),
            (
                Mismeasurement::LevelPhase { magnitude: 2.5, degrees: 4.0 },
                "phase +4.00° at magnitude 2.5000",
            ),
            (
                Mismeasurement::RunGain { experiment: 7, factor: 0.95 },
                "gain × 0.950 in experiment 7",
            ),
            (Mismeasurement::ChannelSkew { seconds: 0.001 }, "a response ahead by 1.000e-3 s"),
        ] {
            assert_eq!(fault.to_string(), text);
        }
    }
}
