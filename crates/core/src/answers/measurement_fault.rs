//! Faults of a measurement, as opposed to those of the machine.

use serde::{Deserialize, Serialize};

/// What is wrong with a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// Rows that do not belong to the rest.
    BadRows,
    /// The stated standard deviation is wrong by a factor.
    StdFactor,
    /// One magnitude was measured with another gain than the others.
    LevelGain,
    /// One magnitude was measured with another phase than the others.
    LevelPhase,
    /// One experiment was measured with another gain than the others.
    RunGain,
    /// One experiment was measured with another phase than the others.
    RunPhase,
    /// The imaginary parts have the wrong sign.
    Conjugated,
    /// The response has the wrong sign.
    ReversedSign,
    /// Harmonics refer to a sine, not to a cosine.
    SineReference,
    /// The response is another quantity than stated: a position called velocity, and the like.
    ResponseKind,
    /// Harmonics are rms or peak-to-peak values, not peak values.
    AmplitudeConvention,
    /// The response is ahead of the input by a constant time.
    ChannelSkew,
    /// Between its samples the input of a record is held, as behind a converter.
    HeldInput,
    /// Between its samples the input of a record runs straight.
    StraightInput,
    /// What the channel of the input of a record reads is cut off at the end of its range.
    ClippedInput,
    /// The same of the response.
    ClippedResponse,
    /// Samples of a record do not belong to the rest.
    BadSamples,
}

impl FaultKind {
    /// Every kind.
    pub const ALL: [Self; 17] = [
        Self::BadRows,
        Self::StdFactor,
        Self::LevelGain,
        Self::LevelPhase,
        Self::RunGain,
        Self::RunPhase,
        Self::Conjugated,
        Self::ReversedSign,
        Self::SineReference,
        Self::ResponseKind,
        Self::AmplitudeConvention,
        Self::ChannelSkew,
        Self::HeldInput,
        Self::StraightInput,
        Self::ClippedInput,
        Self::ClippedResponse,
        Self::BadSamples,
    ];

    /// The name used on the wire.
    pub fn name(self) -> &'static str {
        match self {
            Self::BadRows => "bad_rows",
            Self::StdFactor => "std_factor",
            Self::LevelGain => "level_gain",
            Self::LevelPhase => "level_phase",
            Self::RunGain => "run_gain",
            Self::RunPhase => "run_phase",
            Self::Conjugated => "conjugated",
            Self::ReversedSign => "reversed_sign",
            Self::SineReference => "sine_reference",
            Self::ResponseKind => "response_kind",
            Self::AmplitudeConvention => "amplitude_convention",
            Self::ChannelSkew => "channel_skew",
            Self::HeldInput => "held_input",
            Self::StraightInput => "straight_input",
            Self::ClippedInput => "clipped_input",
            Self::ClippedResponse => "clipped_response",
            Self::BadSamples => "bad_samples",
        }
    }
}

/// A row that was left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct LeftOutRow {
    /// Index of the experiment in the measurement, from 0.
    pub experiment: usize,
    /// Harmonic.
    pub harmonic: usize,
    /// Which repeat, in the order of the file, from 0; null if the experiment has none.
    pub repeat: Option<usize>,
    /// Line of the file; null if it is not known.
    pub line: Option<u64>,
    /// Distance from the model, or from the other repeats, relative to their value.
    pub off: f64,
    /// The same in standard deviations.
    pub sigmas: f64,
}

/// A channel of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// That of the input.
    Input,
    /// That of the response.
    Response,
}

/// Samples of a record, in a row, that were interpolated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct InterpolatedSamples {
    /// Index of the experiment in the measurement, from 0.
    pub experiment: usize,
    /// The channel.
    pub channel: Channel,
    /// Time of the first of them, s.
    pub time_s: f64,
    /// Line of the file of the first; null if it is not known.
    pub line: Option<u64>,
    /// Number of samples.
    pub count: usize,
    /// Largest distance from what their neighbours lead to, units of the channel.
    pub off: f64,
    /// The same in standard deviations of a sample.
    pub sigmas: f64,
}

/// A fault of the measurement. The answer is for the measurement with this corrected.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct MeasurementFault {
    /// What is wrong.
    pub fault: FaultKind,
    /// One sentence that says where and by how much.
    pub sentence: String,
    /// How to correct it: the line, flag or column.
    pub remedy: String,
    /// The rows that were left out; empty for other faults.
    pub left_out: Vec<LeftOutRow>,
    /// The samples that were interpolated; empty for other faults.
    #[serde(default)]
    pub interpolated: Vec<InterpolatedSamples>,
    /// The magnitude concerned, input units; null if it is not one magnitude.
    pub magnitude: Option<f64>,
    /// Index of the experiment concerned, from 0; null if it is not one.
    pub experiment: Option<usize>,
    /// Its size: a factor (of the stated standard deviation, the gain or the amplitudes), an angle
    /// of the fundamental in degrees, a time in seconds, or the share of the samples that are cut
    /// off; null if it has none.
    pub value: Option<f64>,
    /// 95 % interval of `value`.
    pub interval95: Option<[f64; 2]>,
    /// What the response really is: velocity, position or acceleration; null for other faults.
    pub response: Option<String>,
}

impl MeasurementFault {
    /// A fault of which only the kind is known.
    pub fn of(fault: FaultKind) -> Self {
        Self {
            fault,
            sentence: String::new(),
            remedy: String::new(),
            left_out: Vec::new(),
            interpolated: Vec::new(),
            magnitude: None,
            experiment: None,
            value: None,
            interval95: None,
            response: None,
        }
    }
}

/// The answer to the measurement as it is, with its faults.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct AsMeasured {
    /// NRMSE of the base model.
    pub nrmse: f64,
    /// χ² per degree of freedom of the base model; null if the noise is unknown.
    pub chi2_per_dof: Option<f64>,
    /// The effects that would be named; empty, too, if none were tried before the fault was found.
    pub causes: Vec<String>,
    /// NRMSE of the model with these effects; null if there are none.
    pub nrmse_with_causes: Option<f64>,
}
