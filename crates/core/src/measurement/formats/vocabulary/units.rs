//! The names of units that are known beside those of the contract, except those of motions.
//!
//! To teach the reader another unit, add it here.

use std::f64::consts::PI;

/// What a unit measures, as far as it tells one column from another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Measures {
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
pub(in super::super) struct Unit {
    pub(in super::super) measures: Measures,
    pub(in super::super) names: &'static [&'static str],
    pub(in super::super) times: f64,
    pub(in super::super) over: f64,
}

const fn unit(measures: Measures, names: &'static [&'static str], times: f64, over: f64) -> Unit {
    Unit { measures, names, times, over }
}

/// The units of times, frequencies, angles, ratios and inputs. Upper and lower case differ. Those
/// of motions are in [`crate::measurement::units`].
pub(in super::super) const UNITS: &[Unit] = &[
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
pub(in super::super) const SUFFIXES: &[(&str, &str)] = &[
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
