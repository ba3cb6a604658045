//! The names of columns that are known beside those of the contract; those of units are in `units`.
//!
//! To teach the reader another name, add it here. Names are written in lower case, with single
//! blanks in place of `.`, `_`, `-` and `:`.

mod units;

use crate::measurement::ResponseKind;
pub(super) use units::{Measures, SUFFIXES, UNITS, Unit};

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holds {
    Time,
    /// Number of the sample, from which the time follows.
    Sample,
    /// In hertz or revolutions per time, or in rad/s, as the unit says.
    Frequency,
    /// ω: always in rad/s.
    AngularFrequency,
    /// Amplitude of the input at each frequency.
    Magnitude,
    /// Ratio of response to input, linear or in dB, as the unit says.
    Gain,
    /// The same in a notation that means the linear ratio.
    LinearGain,
    /// Real part of the ratio of response to input.
    GainRe,
    /// Imaginary part of the ratio of response to input.
    GainIm,
    /// Real part, of the ratio or of the response.
    RealPart,
    /// Imaginary part, of the ratio or of the response.
    ImaginaryPart,
    Phase,
    Coherence,
    Averages,
    /// Standard deviation of the gain.
    GainDeviation,
    /// Standard deviation of the phase.
    PhaseDeviation,
    /// The input, with the name of its quantity, if that is known.
    Input(&'static str),
    /// A motion: a response.
    Motion(ResponseKind),
    /// The response, of whatever kind.
    Output,
}

/// Whole names.
pub(super) const NAMES: &[(Holds, &[&str])] = &[
    (Holds::Time, &["time", "t", "zeit", "zeitstempel", "timestamp", "relative time", "x time"]),
    (Holds::Sample, &["sample", "sample number", "index"]),
    (
        Holds::Frequency,
        &["frequency", "freq", "f", "frequenz", "excitation frequency", "anregungsfrequenz"],
    ),
    (Holds::AngularFrequency, &["omega", "ω", "w", "angular frequency", "kreisfrequenz"]),
    (
        Holds::Magnitude,
        &[
            "drive amplitude",
            "drive level",
            "source amplitude",
            "source level",
            "excitation amplitude",
            "input amplitude",
            "anregungsamplitude",
            "eingangsamplitude",
        ],
    ),
    (
        Holds::Gain,
        &[
            "gain",
            "magnitude",
            "mag",
            "amplitude",
            "amplitude ratio",
            "amplitude response",
            "frequency response magnitude",
            "frf magnitude",
            "betrag",
            "amplitudengang",
            "amplitudenverhältnis",
            "verstärkung",
            "verstaerkung",
        ],
    ),
    (
        Holds::LinearGain,
        &["|h|", "|g|", "|h(f)|", "|g(f)|", "|h(jω)|", "|g(jω)|", "abs(h)", "abs(g)"],
    ),
    (Holds::GainRe, &["re(h)", "re(g)", "real(h)", "real(g)", "gain real", "frf real"]),
    (
        Holds::GainIm,
        &["im(h)", "im(g)", "imag(h)", "imag(g)", "gain imag", "gain imaginary", "frf imag"],
    ),
    (Holds::RealPart, &["real", "real part", "realteil"]),
    (Holds::ImaginaryPart, &["imag", "imaginary", "imaginary part", "imaginärteil"]),
    (
        Holds::Phase,
        &[
            "phase",
            "phi",
            "φ",
            "θ",
            "theta",
            "phase angle",
            "phase shift",
            "phase response",
            "frf phase",
            "arg(h)",
            "arg(g)",
            "angle(h)",
            "angle(g)",
            "phasengang",
            "phasenwinkel",
            "phasenlage",
            "phasenverschiebung",
        ],
    ),
    (Holds::Coherence, &["coherence", "coh", "kohärenz", "kohaerenz", "γ²", "γ2"]),
    (Holds::Averages, &["number of averages", "mittelungen"]),
    (Holds::GainDeviation, &["gain std", "gain deviation", "magnitude std", "std gain"]),
    (Holds::PhaseDeviation, &["phase std", "phase deviation", "std phase"]),
    (
        Holds::Input(""),
        &["input", "u", "excitation", "stimulus", "command", "eingang", "anregung", "stellgröße"],
    ),
    (Holds::Output, &["output", "y", "response", "ausgang", "antwort"]),
];

/// Words of which one in a name tells what the column holds.
pub(super) const WORDS: &[(Holds, &[&str])] = &[
    (
        Holds::Input("current"),
        &["current", "curr", "strom", "motorstrom", "stromistwert", "iststrom", "sollstrom", "iq"],
    ),
    (
        Holds::Input("torque"),
        &["torque", "trq", "moment", "drehmoment", "motormoment", "momentenistwert", "istmoment"],
    ),
    (Holds::Input("force"), &["force", "kraft", "motorkraft"]),
    (Holds::Input("voltage"), &["voltage", "volt", "volts", "spannung", "motorspannung"]),
    (
        Holds::Motion(ResponseKind::Position),
        &[
            "position",
            "pos",
            "lage",
            "weg",
            "winkel",
            "angle",
            "displacement",
            "istposition",
            "istlage",
            "lageistwert",
            "positionsistwert",
            "drehwinkel",
        ],
    ),
    (
        Holds::Motion(ResponseKind::Velocity),
        &[
            "velocity",
            "vel",
            "speed",
            "geschwindigkeit",
            "istgeschwindigkeit",
            "geschwindigkeitsistwert",
            "drehzahl",
            "istdrehzahl",
            "drehzahlistwert",
            "winkelgeschwindigkeit",
        ],
    ),
    (
        Holds::Motion(ResponseKind::Acceleration),
        &["acceleration", "accel", "acc", "beschleunigung", "istbeschleunigung"],
    ),
];

/// Words beside which a motion is a set point, a limit or an error: not what was measured.
pub(super) const NOT_MEASURED: &[&str] = &[
    "set", "setpos", "setvelo", "setacc", "posdiff", "ref", "cmd", "goal", "err", "lag", "max",
    "min",
];

/// Parts of words that mean the same, wherever in a name they stand: `Schleppfehler`, `Lagesollwert`,
/// `TargetPosition`.
pub(super) const PARTS_NOT_MEASURED: &[&str] = &[
    "setpoint",
    "soll",
    "vorgabe",
    "target",
    "command",
    "reference",
    "demand",
    "desired",
    "nominal",
    "planned",
    "error",
    "deviation",
    "abweichung",
    "fehler",
    "schleppabstand",
    "limit",
    "grenz",
];

/// Whole names that stand for a physical quantity, which their unit tells: `F [N]` is a force, `T
/// [Nm]` a torque.
pub(super) const SYMBOLS: &[&str] = &["t", "f", "w", "ω", "omega", "phi", "φ", "θ", "theta"];
