//! The names of columns and of units that are known beside those of the contract.
//!
//! To teach the reader another name, add it here. Names are written in lower case, with single
//! blanks in place of `.`, `_`, `-` and `:`.

use crate::measurement::ResponseKind;

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

/// What a unit measures, as far as it tells one column from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Measures {
    /// Converted to s.
    Time,
    /// Converted to Hz.
    Frequency,
    /// Converted to rad/s.
    AngularFrequency,
    /// Converted to degrees.
    Angle,
    Decibel,
    /// A plain ratio.
    One,
    /// A quantity that drives an axis.
    Drive(&'static str),
}

/// A unit: what it measures, its spellings, and what turns a number with it into one with the unit
/// of the contract: a factor and a divisor, because 1/1000 has no exact binary form.
pub(super) struct Unit {
    pub(super) measures: Measures,
    pub(super) names: &'static [&'static str],
    pub(super) times: f64,
    pub(super) over: f64,
}

const fn unit(measures: Measures, names: &'static [&'static str], times: f64, over: f64) -> Unit {
    Unit { measures, names, times, over }
}

use std::f64::consts::PI;

/// The units of times, frequencies, angles, ratios and inputs. Upper and lower case differ. Those
/// of motions are in [`crate::measurement::units`].
pub(super) const UNITS: &[Unit] = &[
    unit(Measures::Time, &["s", "sec", "seconds", "Sekunden"], 1.0, 1.0),
    unit(Measures::Time, &["ms", "msec", "milliseconds"], 1.0, 1e3),
    unit(Measures::Time, &["µs", "μs", "us", "usec", "microseconds"], 1.0, 1e6),
    unit(Measures::Time, &["ns"], 1.0, 1e9),
    unit(Measures::Time, &["min"], 60.0, 1.0),
    unit(Measures::Frequency, &["Hz", "HZ", "hz", "Hertz", "hertz"], 1.0, 1.0),
    unit(Measures::Frequency, &["mHz"], 1.0, 1e3),
    unit(Measures::Frequency, &["kHz", "KHz", "khz"], 1e3, 1.0),
    unit(Measures::Frequency, &["MHz"], 1e6, 1.0),
    unit(
        Measures::Frequency,
        &["rpm", "1/min", "min-1", "min^-1", "min⁻¹", "rev/min", "U/min"],
        1.0,
        60.0,
    ),
    unit(
        Measures::AngularFrequency,
        &["rad/s", "rad/sec", "rad s-1", "rad·s⁻¹", "1/s", "s^-1"],
        1.0,
        1.0,
    ),
    unit(Measures::Angle, &["deg", "°", "degree", "degrees", "Deg", "DEG", "Grad"], 1.0, 1.0),
    unit(Measures::Angle, &["rad", "Rad", "radian", "radians"], 180.0, PI),
    unit(Measures::Angle, &["mrad"], 0.18, PI),
    unit(Measures::Decibel, &["dB", "db", "DB", "decibel"], 1.0, 1.0),
    unit(Measures::One, &["1", "-", "abs", "lin", "linear", "ratio", "V/V"], 1.0, 1.0),
    unit(Measures::Drive("current"), &["A", "Arms", "mA", "A_rms", "kA"], 1.0, 1.0),
    unit(Measures::Drive("voltage"), &["V", "mV", "Volt", "Volts", "kV"], 1.0, 1.0),
    unit(Measures::Drive("force"), &["N", "mN", "kN"], 1.0, 1.0),
    unit(
        Measures::Drive("torque"),
        &["N m", "Nm", "N·m", "N*m", "N.m", "mN m", "mNm", "mN·m", "kNm", "Ncm", "N cm"],
        1.0,
        1.0,
    ),
];

/// Units as they are written after an underscore: `time_ms`, `vel_rad_s`.
pub(super) const SUFFIXES: &[(&str, &str)] = &[
    ("s", "s"),
    ("sec", "s"),
    ("ms", "ms"),
    ("us", "µs"),
    ("ns", "ns"),
    ("hz", "Hz"),
    ("khz", "kHz"),
    ("rpm", "rpm"),
    ("rad_s", "rad/s"),
    ("deg_s", "deg/s"),
    ("m_s", "m/s"),
    ("mm_s", "mm/s"),
    ("mm_min", "mm/min"),
    ("rad_s2", "rad/s²"),
    ("m_s2", "m/s²"),
    ("mm_s2", "mm/s²"),
    ("deg", "deg"),
    ("rad", "rad"),
    ("mrad", "mrad"),
    ("m", "m"),
    ("mm", "mm"),
    ("um", "µm"),
    ("a", "A"),
    ("ma", "mA"),
    ("v", "V"),
    ("mv", "mV"),
    ("n", "N"),
    ("n_m", "N m"),
    ("db", "dB"),
];
