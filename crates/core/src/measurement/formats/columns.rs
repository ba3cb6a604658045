//! Names of the columns that an upload may have.

/// A known column, in a CSV header or as a JSON key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Column {
    Magnitude,
    OmegaRadS,
    FrequencyHz,
    Experiment,
    Harmonic,
    Re,
    Im,
    Amplitude,
    PhaseDeg,
    Gain,
    GainDb,
    GainRe,
    GainIm,
    Std,
    Coherence,
    Averages,
    GainStd,
    GainDbStd,
    PhaseStdDeg,
    Repeat,
    Run,
    Bias,
    URe,
    UIm,
    TimeS,
    Input,
    Output,
    Segment,
}

/// Columns of a harmonic table.
pub(super) const HARMONIC_TABLE: &[Column] = &[
    Column::Magnitude,
    Column::OmegaRadS,
    Column::FrequencyHz,
    Column::Experiment,
    Column::Harmonic,
    Column::Re,
    Column::Im,
    Column::Amplitude,
    Column::PhaseDeg,
    Column::Gain,
    Column::GainDb,
    Column::GainRe,
    Column::GainIm,
    Column::Std,
    Column::Coherence,
    Column::Averages,
    Column::GainStd,
    Column::GainDbStd,
    Column::PhaseStdDeg,
    Column::Repeat,
    Column::Run,
    Column::Bias,
    Column::URe,
    Column::UIm,
];

/// Columns in one of the forms of which a harmonic table has its response.
pub(super) const RESPONSE_FORMS: &[Column] =
    &[Column::Re, Column::Amplitude, Column::Gain, Column::GainDb, Column::GainRe];

/// Columns of a time record.
pub(super) const TIME_RECORD: &[Column] =
    &[Column::TimeS, Column::Input, Column::Output, Column::Segment];

impl Column {
    /// Number of columns.
    pub(super) const COUNT: usize = HARMONIC_TABLE.len() + TIME_RECORD.len();

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Magnitude => "magnitude",
            Self::OmegaRadS => "omega_rad_s",
            Self::FrequencyHz => "frequency_hz",
            Self::Experiment => "experiment",
            Self::Harmonic => "harmonic",
            Self::Re => "re",
            Self::Im => "im",
            Self::Amplitude => "amplitude",
            Self::PhaseDeg => "phase_deg",
            Self::Gain => "gain",
            Self::GainDb => "gain_db",
            Self::GainRe => "gain_re",
            Self::GainIm => "gain_im",
            Self::Std => "std",
            Self::Coherence => "coherence",
            Self::Averages => "averages",
            Self::GainStd => "gain_std",
            Self::GainDbStd => "gain_db_std",
            Self::PhaseStdDeg => "phase_std_deg",
            Self::Repeat => "repeat",
            Self::Run => "run",
            Self::Bias => "bias",
            Self::URe => "u_re",
            Self::UIm => "u_im",
            Self::TimeS => "time_s",
            Self::Input => "input",
            Self::Output => "output",
            Self::Segment => "segment",
        }
    }

    /// The column with this name, if it is one of `among`.
    pub(super) fn find(name: &str, among: &[Column]) -> Option<Column> {
        among.iter().copied().find(|column| column.name() == name)
    }
}
