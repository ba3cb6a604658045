//! What the columns of a table may be, as a choice for whoever names them.

use super::columns::Column;
use super::name::Name;
use super::vocabulary::Holds;
use crate::measurement::ResponseKind;

/// A quantity that a column may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QuantityChoice {
    /// Its key.
    pub key: &'static str,
    /// What it is, in words.
    pub title: &'static str,
    /// The name that `column_names` has for it; the unit follows in brackets.
    pub name: &'static str,
    /// Usual units; empty if it has none to be said.
    pub units: &'static [&'static str],
}

const fn choice(
    key: &'static str,
    title: &'static str,
    name: &'static str,
    units: &'static [&'static str],
) -> QuantityChoice {
    QuantityChoice { key, title, name, units }
}

const DECIBEL_OR_ONE: &[&str] = &["dB", "1"];
const ANGLES: &[&str] = &["deg", "rad", "mrad"];

/// Every quantity, in the order in which they are offered.
pub const QUANTITIES: &[QuantityChoice] = &[
    choice("time", "time", "Time", &["s", "ms", "µs", "ns", "min"]),
    choice("sample", "number of the sample", "Sample", &[]),
    choice("frequency", "frequency", "Frequency", &["Hz", "kHz", "mHz", "rad/s", "rpm"]),
    choice("current", "input: current", "Current", &["A", "mA", "Arms"]),
    choice("torque", "input: torque", "Torque", &["N m", "mN m", "N cm"]),
    choice("force", "input: force", "Force", &["N", "mN", "kN"]),
    choice("voltage", "input: voltage", "Voltage", &["V", "mV"]),
    choice("input", "input: another quantity", "Input", &[]),
    choice(
        "position",
        "response: position",
        "Position",
        &["m", "mm", "µm", "rad", "mrad", "deg", "counts"],
    ),
    choice(
        "velocity",
        "response: velocity",
        "Velocity",
        &["m/s", "mm/s", "mm/min", "rad/s", "deg/s", "rpm", "counts/s"],
    ),
    choice(
        "acceleration",
        "response: acceleration",
        "Acceleration",
        &["m/s²", "mm/s²", "rad/s²", "deg/s²"],
    ),
    choice("response", "response, as said below", "Response", &[]),
    choice("gain", "ratio of response to input", "Gain", DECIBEL_OR_ONE),
    choice("phase", "phase", "Phase", ANGLES),
    choice("gain_re", "real part of the ratio", "gain_re", &[]),
    choice("gain_im", "imaginary part of the ratio", "gain_im", &[]),
    choice("re", "real part of the response", "re", &[]),
    choice("im", "imaginary part of the response", "im", &[]),
    choice("amplitude", "amplitude of the response", "amplitude", &[]),
    choice("magnitude", "amplitude of the input", "magnitude", &[]),
    choice("u_re", "real part of the input", "u_re", &[]),
    choice("u_im", "imaginary part of the input", "u_im", &[]),
    choice("bias", "constant added to the input", "bias", &[]),
    choice("harmonic", "number of the harmonic", "harmonic", &[]),
    choice("coherence", "coherence", "Coherence", &[]),
    choice("averages", "number of averages", "averages", &[]),
    choice("std", "standard deviation of the response", "std", &[]),
    choice("gain_std", "standard deviation of the ratio", "Gain std", DECIBEL_OR_ONE),
    choice("phase_std", "standard deviation of the phase", "Phase std", ANGLES),
    choice("experiment", "number of the experiment", "experiment", &[]),
    choice("repeat", "number of the repeat", "repeat", &[]),
    choice("run", "order of acquisition", "run", &[]),
    choice("segment", "number of the segment", "segment", &[]),
];

/// Key of the quantity that a name means, and its unit; `None` if the name is not understood.
pub(super) fn of(name: &Name) -> Option<(&'static str, String)> {
    let of_unit = |key, unit: &str| {
        let written = name.unit.as_str();
        Some((key, if written.is_empty() { unit } else { written }.to_owned()))
    };
    if let Some(column) = name.contract {
        return match column {
            Column::TimeS => of_unit("time", "s"),
            Column::FrequencyHz => of_unit("frequency", "Hz"),
            Column::OmegaRadS => of_unit("frequency", "rad/s"),
            Column::PhaseDeg => of_unit("phase", "deg"),
            Column::Gain => of_unit("gain", "1"),
            Column::GainDb => of_unit("gain", "dB"),
            Column::GainStd => of_unit("gain_std", "1"),
            Column::GainDbStd => of_unit("gain_std", "dB"),
            Column::PhaseStdDeg => of_unit("phase_std", "deg"),
            Column::Output => of_unit("response", ""),
            other => of_unit(other.name(), ""),
        };
    }
    match name.holds? {
        Holds::Time => of_unit("time", ""),
        Holds::Sample => of_unit("sample", ""),
        Holds::Frequency => of_unit("frequency", ""),
        Holds::AngularFrequency => of_unit("frequency", "rad/s"),
        Holds::Magnitude => of_unit("magnitude", ""),
        Holds::Gain => of_unit("gain", ""),
        Holds::LinearGain => of_unit("gain", "1"),
        Holds::GainRe => of_unit("gain_re", ""),
        Holds::GainIm => of_unit("gain_im", ""),
        // Of the ratio or of the response: whoever names the columns says which.
        Holds::RealPart | Holds::ImaginaryPart => None,
        Holds::Phase => of_unit("phase", ""),
        Holds::Coherence => of_unit("coherence", ""),
        Holds::Averages => of_unit("averages", ""),
        Holds::GainDeviation => of_unit("gain_std", ""),
        Holds::PhaseDeviation => of_unit("phase_std", ""),
        Holds::Input("") => of_unit("input", ""),
        Holds::Input(quantity) => of_unit(quantity, ""),
        Holds::Motion(ResponseKind::Position) => of_unit("position", ""),
        Holds::Motion(ResponseKind::Velocity) => of_unit("velocity", ""),
        Holds::Motion(ResponseKind::Acceleration) => of_unit("acceleration", ""),
        Holds::Output => of_unit("response", ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_written_as_a_name_means_itself() {
        for QuantityChoice { key, name, units, .. } in QUANTITIES {
            let bare = of(&Name::of(name, None));
            assert_eq!(bare.map(|(key, _)| key), Some(*key), "{name}");
            for unit in *units {
                let written = format!("{name} ({unit})");
                let meant = of(&Name::of(&written, None));
                assert_eq!(meant, Some((*key, (*unit).to_owned())), "{written}");
            }
        }
    }
}
