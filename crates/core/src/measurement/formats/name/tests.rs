//! The names of columns, with their units.

use super::*;
use crate::measurement::ResponseKind::{Acceleration, Position, Velocity};

#[track_caller]
fn means(written: &str, holds: Holds, unit: &str) {
    let name = Name::of(written, None);
    assert_eq!((name.holds, name.unit.as_str()), (Some(holds), unit), "{written}");
}

#[test]
fn names_are_understood_with_their_units() {
    means("Frequency (Hz)", Holds::Frequency, "Hz");
    means("f [kHz]", Holds::Frequency, "kHz");
    means("f/Hz", Holds::Frequency, "Hz");
    means("Frequenz in Hz", Holds::Frequency, "Hz");
    means("ω", Holds::AngularFrequency, "");
    means("Magnitude (dB)", Holds::Gain, "dB");
    means("Gain, dB", Holds::Gain, "dB");
    means("Betrag (dB)", Holds::Gain, "dB");
    means("|H|", Holds::LinearGain, "");
    means("abs(H)", Holds::LinearGain, "");
    means("Phase (°)", Holds::Phase, "°");
    means("phase_rad", Holds::Phase, "rad");
    means("Time [ms]", Holds::Time, "ms");
    means("time_ms", Holds::Time, "ms");
    means("Zeit / s", Holds::Time, "s");
    means("Current (A)", Holds::Input("current"), "A");
    means("motor_current_a", Holds::Input("current"), "A");
    means("Drehmoment [Nm]", Holds::Input("torque"), "Nm");
    means("Torque N m", Holds::Input("torque"), "N m");
    means("Pos. actual value", Holds::Motion(Position), "");
    means("Lage (mm)", Holds::Motion(Position), "mm");
    means("Geschwindigkeit [rad/s]", Holds::Motion(Velocity), "rad/s");
    means("vel_rad_s", Holds::Motion(Velocity), "rad/s");
    means("Beschleunigung in m/s²", Holds::Motion(Acceleration), "m/s²");
    means("Drehzahl U/min", Holds::Motion(Velocity), "U/min");
    means("Speed 1/min", Holds::Motion(Velocity), "1/min");
    means("vel m / s", Holds::Motion(Velocity), "m / s");
    means("Drehzahl / 1/min", Holds::Motion(Velocity), "1/min");
    means("Channel 3 (N)", Holds::Input("force"), "N");
    means("Channel 4 [mm]", Holds::Motion(Position), "mm");
}

#[test]
fn set_points_and_errors_are_not_taken_for_what_was_measured() {
    for written in ["Position set point", "Position error (mm)", "Sollwert Lage", "Colour", ""] {
        assert_eq!(Name::of(written, None).holds, None, "{written}");
    }
    for name in
        ["Following error", "Schleppfehler", "Lagesollwert", "Setpoint", "Reference", "Vorgabe"]
            .into_iter()
            .chain(["Desired position", "Nominal pos", "planned", "TargetPosition", "Axis.SetPos"])
            .chain(["Regelabweichung", "Sollwert", "Schleppabstand"])
    {
        for unit in ["mm", "rad", "mm/s"] {
            assert_eq!(Name::of(&format!("{name} ({unit})"), None).holds, None, "{name}");
            assert_eq!(Name::of(name, Some(unit)).holds, None, "{name}");
        }
    }
    means("Lageistwert [mm]", Holds::Motion(Position), "mm");
    // The set point of the current is what drives the axis.
    means("Current set point (A)", Holds::Input("current"), "A");
    // Two quantities in one name.
    assert_eq!(Name::of("Position / Velocity", None).holds, None);
}

#[test]
fn a_symbol_beside_the_unit_of_another_quantity_means_that_quantity() {
    means("F [N]", Holds::Input("force"), "N");
    means("F/N", Holds::Input("force"), "N");
    means("T [Nm]", Holds::Input("torque"), "Nm");
    means("f [Hz]", Holds::Frequency, "Hz");
    means("t [ms]", Holds::Time, "ms");
    means("T", Holds::Time, "");
    means("omega (rad/s)", Holds::AngularFrequency, "rad/s");
    means("θ [mm]", Holds::Motion(Position), "mm");
    assert_eq!(Name::of("T", Some("[Nm]")).holds, Some(Holds::Input("torque")));
    for written in ["T [°C]", "t_a", "f_n", "φ (V s)"] {
        assert_eq!(Name::of(written, None).holds, None, "{written}");
    }
    // A word says what it says, and a unit that contradicts it is refused.
    means("Frequency (furlong)", Holds::Frequency, "furlong");
}

#[test]
fn a_unit_in_a_row_below_is_the_unit() {
    let name = Name::of("Zeit", Some("[ms]"));
    assert_eq!((name.holds, name.unit.as_str()), (Some(Holds::Time), "ms"));
    assert!(is_unit("(mm/s)") && is_unit("°") && is_unit("dB") && !is_unit("Zeit"));
}

#[test]
fn every_name_and_unit_of_the_vocabulary_is_in_its_spelling_and_given_once() {
    let mut seen = std::collections::HashSet::new();
    for name in NAMES.iter().chain(WORDS).flat_map(|(_, names)| *names) {
        assert_eq!(in_one_spelling(name), *name);
        assert!(seen.insert(*name), "{name} is given twice");
    }
    for name in SYMBOLS.iter().chain(NOT_MEASURED).chain(PARTS_NOT_MEASURED) {
        assert_eq!(in_one_spelling(name), *name);
    }
    let mut seen = std::collections::HashSet::new();
    for name in UNITS.iter().flat_map(|unit| unit.names) {
        assert!(seen.insert(*name), "{name} is given twice");
    }
    for (_, unit) in SUFFIXES {
        assert!(is_unit(unit), "{unit}");
    }
}
