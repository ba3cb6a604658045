//! Columns by the names that instruments give them.

use super::*;

/// 200 samples of a current and a motion, every column from a function of the sample.
fn samples(header: &str, row: impl Fn(f64, f64, f64) -> String) -> String {
    let mut text = format!("{header}\n");
    for n in 0..200 {
        let angle = std::f64::consts::TAU * f64::from(n) / 50.0;
        text += &row(f64::from(n) * 1e-3, angle.cos(), (angle - 0.5).cos());
        text.push('\n');
    }
    text
}

fn given(entries: &[(&str, &str)], text: &str) -> Result<Measurement, ParseError> {
    let mut given = Given::default();
    entries.iter().try_for_each(|(key, value)| given.set(key, value))?;
    let stated = given.text().unwrap_or_default();
    let mut sources = vec![Source { name: "test.csv", bytes: text.as_bytes() }];
    if !stated.is_empty() {
        sources.push(Source { name: Given::NAME, bytes: stated.as_bytes() });
    }
    read(&sources)
}

#[test]
fn a_record_with_other_names_and_units_is_the_record_of_the_contract() {
    let plain = ok(&samples("time_s,input,output", |t, u, y| format!("{t:.3},{u},{y}")));
    let m = ok(&samples("Zeit [ms];Motorstrom (A);Ist-Position [mm];Temperatur (K)", |t, u, y| {
        format!("{:.0};{u};{y};293", t * 1e3).replace('.', ",")
    }));
    assert_eq!(m.experiments(), plain.experiments());
    let metadata = m.metadata();
    assert_eq!((metadata.input.name.as_str(), metadata.input.unit.as_str()), ("current", "A"));
    assert_eq!(metadata.response_kind, ResponseKind::Position);
    assert_eq!(metadata.response.unit, "mm");
    for words in ["`Zeit [ms]` is time_s", "column Temperatur (K) is unknown and not used"] {
        assert!(m.notes().iter().any(|note| note.contains(words)), "{:?}", m.notes());
    }
}

#[test]
fn the_symbols_of_a_force_and_a_torque_are_inputs_by_their_units() {
    let plain = ok(&samples("time_s,input,output", |t, u, y| format!("{t:.3},{u},{y}")));
    for (header, input, unit) in [
        ("t [s];F [N];x [mm]", "force", "N"),
        ("t [s];T [Nm];x [mm]", "torque", "Nm"),
        ("t / s;T / Nm;x [mm]", "torque", "Nm"),
    ] {
        let m = ok(&samples(header, |t, u, y| format!("{t:.3};{u};{y}")));
        assert_eq!(m.experiments(), plain.experiments(), "{header}");
        let read = &m.metadata().input;
        assert_eq!((read.name.as_str(), read.unit.as_str()), (input, unit));
    }
    // A temperature is no second time.
    let m = ok(&samples("t [s];T [°C];I [A];x [mm]", |t, u, y| format!("{t:.3};20;{u};{y}")));
    assert!(m.notes().iter().any(|note| note.contains("column T [°C] is unknown")));
}

#[test]
fn omega_beside_a_time_is_a_velocity_and_beside_a_gain_a_frequency() {
    let plain = ok(&samples("time_s,input,output", |t, u, y| format!("{t:.3},{u},{y}")));
    for header in ["Time (s),Torque (Nm),omega (rad/s)", "time_s,Torque (Nm),omega_rad_s"] {
        let m = ok(&samples(header, |t, u, y| format!("{t:.3},{u},{y}")));
        assert_eq!(m.experiments(), plain.experiments(), "{header}");
        assert_eq!(m.metadata().response_kind, ResponseKind::Velocity);
        assert_eq!(m.metadata().response.unit, "rad/s");
    }
    let both = |t: f64, u: f64, y: f64| format!("{t:.3},{u},{y},{y}");
    let two = samples("Time (s),Torque (Nm),theta (rad),omega (rad/s)", both);
    refused(&two, 1, "omega (rad/s)", "may both be the response");
    let m = given(&[("response", "position")], &two).unwrap();
    assert_eq!(m.metadata().response.unit, "rad");
    let table = "# response: velocity rad/s\n# magnitude: 1\n\
        Time (s),omega (rad/s),Gain (dB),Phase (deg)\n0,2,-6,-45\n9,20,-26,-90\n";
    assert_eq!(ok(table).experiments()[1].omega_rad_s, 20.0);
}

#[test]
fn a_set_point_or_an_error_is_not_the_response() {
    for name in ["Following error (mm)", "Schleppfehler [mm]", "Lagesollwert [mm]", "Setpoint (mm)"]
    {
        let with = |t: f64, u: f64, y: f64| format!("{t:.3},{u},{y},{y}");
        let m = ok(&samples(&format!("Time (s),Current (A),{name},Ist-Position (mm)"), with));
        assert!(m.notes().iter().any(|note| note.contains(&format!("column {name} is unknown"))));
        let alone =
            samples(&format!("Time (s),Current (A),{name}"), |t, u, y| format!("{t:.3},{u},{y}"));
        refused(&alone, 1, "output", "none is known as the response");
    }
}

#[test]
fn a_bode_table_asks_for_the_response_and_the_magnitude_at_once() {
    let text = "\"Frequency (Hz)\",\"Magnitude (dB)\",\"Phase (deg)\"\n0.5,0,-90\n5,-20,-180\n";
    let error = of(text).unwrap_err();
    assert_eq!(error.line, Some(1));
    for part in ["--response", "--magnitude 0.5", "`# magnitude: 0.5`", "query parameter"] {
        assert!(error.reason.contains(part), "{error}");
    }
    let m = given(&[("response", "velocity rad/s"), ("magnitude", "2")], text).unwrap();
    let plain = ok("magnitude,frequency_hz,gain_db,phase_deg\n2,0.5,0,-90\n2,5,-20,-180\n");
    assert_eq!(m.experiments(), plain.experiments());
    assert_eq!(m.metadata().response.unit, "rad/s");
    assert_ne!(
        m.sha256(),
        given(&[("response", "position m"), ("magnitude", "2")], text).unwrap().sha256()
    );
}

#[test]
fn frequencies_and_phases_are_converted() {
    let settings = "# response: velocity m/s\n# magnitude: 1\n";
    let plain = ok("magnitude,frequency_hz,gain,phase_deg\n1,1500,2,90\n");
    let turns = [
        ("f [kHz];|H|;Phase (°)", "1,5;2;90"),
        ("Frequenz (1/min);|G|;phase_deg", "90000;2,0;90"),
        ("freq_hz;abs(H);Phasenlage in mrad", "1500;2;1570,7963267948966"),
    ];
    for (header, row) in turns {
        let m = ok(&format!("{settings}{header}\n{row}\n"));
        assert_eq!(m.experiments()[0].omega_rad_s, plain.experiments()[0].omega_rad_s);
        // Rounding of π in the last digit that is written.
        assert!((y(&m, 0, 1) - y(&plain, 0, 1)).norm() < 1e-15, "{header}");
    }
    let m = ok(&format!("{settings}omega,Re(H),Im(H)\n3,0.5,-0.25\n"));
    assert_eq!((y(&m, 0, 1), m.experiments()[0].omega_rad_s), (Complex::new(0.5, -0.25), 3.0));
}

#[test]
fn what_could_be_two_things_is_refused_and_asked_for() {
    let two = samples("Time (s),Current (A),Position (mm),Velocity (mm/s)", |t, u, y| {
        format!("{t:.3},{u},{y},{y}")
    });
    refused(&two, 1, "Velocity (mm/s)", "may both be the response");
    let m = given(&[("response", "velocity")], &two).unwrap();
    assert_eq!(m.metadata().response.unit, "mm/s");
    let m = given(&[("column_names", "Time (s); Current (A); Position (mm);")], &two).unwrap();
    assert_eq!(m.metadata().response_kind, ResponseKind::Position);
    let settings = "# response: velocity m/s\n# magnitude: 1\n";
    for (header, column, word) in [
        ("Frequency,Gain (dB),Phase (deg)", "Frequency", "`Frequency` has no unit"),
        ("Frequency (Hz),Mag,Phase (deg)", "Mag", "Mag (dB)"),
        ("Frequency (Hz),Gain (dB),Phase", "Phase", "Phase (deg)"),
        ("Frequency (Hz),Real,Imag", "Real", "gain_re"),
        ("Frequency (furlong),Gain (dB),Phase (deg)", "Frequency (furlong)", "furlong"),
    ] {
        refused(&format!("{settings}{header}\n1,2,3\n"), 3, column, word);
    }
}

#[test]
fn a_name_that_contradicts_its_unit_or_the_metadata_is_refused() {
    let with = |header: &str| samples(header, |t, u, y| format!("{t:.3},{u},{y}"));
    refused(&with("Time (s),Current (A),Position (mm/s)"), 1, "Position (mm/s)", "velocity");
    refused(
        &with("Time (s),Current (N),Position (mm)"),
        1,
        "Current (N)",
        "not a unit of a current",
    );
    let velocity = format!("# response: velocity mm/s\n{}", with("Time (s),Current (A),Lage (mm)"));
    refused(&velocity, 2, "Lage (mm)", "correct the one or the other");
    refused(&with("Time (s),Current (A),Output (V)"), 1, "Output (V)", "--response");
    refused(&with("Time (s),Current (A),Position set point (mm)"), 1, "output", "--column-names");
}

#[test]
fn a_file_in_the_form_of_the_contract_is_read_by_its_names_alone() {
    let m = ok("magnitude,omega_rad_s,re,im,Phase (deg),Frequency (Hz)\n1,2,3,4,5,6\n");
    assert_eq!((m.experiments()[0].omega_rad_s, y(&m, 0, 1)), (2.0, Complex::new(3.0, 4.0)));
    assert_eq!(m.notes(), ["column Phase (deg) is not used", "column Frequency (Hz) is not used"]);
}

#[test]
fn an_error_below_names_the_column_as_the_file_does() {
    let text =
        samples("Time [ms],Current (A),Position (mm)", |t, u, y| format!("{:.0},{u},{y}", t * 1e3));
    refused(&text.replace("\n3,", "\n3x,"), 5, "Time [ms]", "not a number");
    refused(&text.replace("\n3,", "\n1,"), 5, "Time [ms]", "");
}

#[test]
fn a_record_without_times_has_those_of_its_samples() {
    let plain = ok(&samples("time_s,input,output", |t, u, y| format!("{t:.3},{u},{y}")));
    let settings = "# sample_s: 0.001\n# response: velocity\n";
    let bare = samples("", |_, u, y| format!("{u} {y}"));
    let names = "# column_names: input; output\n";
    let read = ok(&format!("{settings}{names}{bare}"));
    // Rounding of the products.
    let near = |m: &Measurement| {
        let ratio = m.experiments()[0].omega_rad_s / plain.experiments()[0].omega_rad_s;
        assert!((ratio - 1.0).abs() < 1e-9, "{ratio}");
    };
    near(&read);
    let numbered = samples("", |t, u, y| format!("{:.0} {u} {y}", t * 1e3 + 7.0));
    near(&ok(&format!("{settings}# column_names: sample; input; output\n{numbered}")));
    let overrun = numbered.replacen("\n17 ", "\noverrun\n17 ", 1);
    let text = format!("{settings}# column_names: sample; input; output\n{overrun}");
    refused(&text, 15, "", "fields");
}

#[test]
fn an_inverted_response_has_the_opposite_sign() {
    let text = "magnitude,omega_rad_s,re,im\n1,2,0.5,-0.25\n";
    assert_eq!(y(&ok(&format!("# inverted: yes\n{text}")), 0, 1), Complex::new(-0.5, 0.25));
    assert_eq!(y(&ok(&format!("# inverted: no\n{text}")), 0, 1), Complex::new(0.5, -0.25));
}
