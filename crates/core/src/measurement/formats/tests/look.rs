//! What is seen of files before they are read, and names given for what was not understood.

use super::*;

/// 200 samples of columns with names of no vocabulary.
fn foreign(header: &str, cell: impl Fn(f64) -> String) -> String {
    let mut text = format!("Rig 7\n\n{header}\n");
    for n in 0..200 {
        let angle = std::f64::consts::TAU * f64::from(n) / 50.0;
        let (u, y) = (cell(angle.cos()), cell((angle - 0.5).cos()));
        text += &format!("{n};{u};on;{y}\n");
    }
    text
}

fn sources<'a>(text: &'a str, given: &'a str) -> Vec<Source<'a>> {
    let file = Source { name: "rig.txt", bytes: text.as_bytes() };
    let stated = Source { name: Given::NAME, bytes: given.as_bytes() };
    if given.is_empty() { vec![file] } else { vec![file, stated] }
}

fn table(text: &str, given: &str) -> TableLook {
    let mut seen = look(&sources(text, given));
    assert_eq!(seen.files.len(), 1);
    seen.files.remove(0).table.unwrap()
}

fn given(entries: &[(&str, &str)]) -> String {
    let mut given = Given::default();
    entries.iter().for_each(|(key, value)| given.set(key, value).unwrap());
    given.text().unwrap()
}

#[test]
fn a_file_that_is_understood_shows_what_each_column_is_used_as() {
    let text = "Zeit [ms];Motorstrom (A);Ist-Position [mm];Colour\n0;1,5;2,5;3\n1;1,5;2,5;3\n";
    let seen = table(text, "");
    let columns = seen.columns.iter();
    let columns: Vec<_> = columns.map(|c| (c.quantity, c.unit.as_str(), c.used_as)).collect();
    assert_eq!(
        columns,
        [
            (Some("time"), "ms", Some("time_s")),
            (Some("current"), "A", Some("input")),
            (Some("position"), "mm", Some("output")),
            (None, "", None),
        ]
    );
    assert_eq!((seen.delimiter, seen.decimal), (Some("semicolons"), Some("comma")));
    assert_eq!(seen.rows[0], ["0", "1,5", "2,5", "3"]);
}

#[test]
fn a_file_that_is_refused_shows_what_is_known_of_it_and_says_what_it_lacks() {
    let text = foreign("tick;chan a;state;Lage (mm)", |value| format!("{value:.4}"));
    let error = read(&sources(&text, "")).unwrap_err();
    assert_eq!(error.lacks.iter().map(|lack| lack.key).collect::<Vec<_>>(), ["column_names"]);
    let seen = table(&text, "");
    assert_eq!(seen.preamble, ["Rig 7"]);
    assert_eq!(seen.line, Some(3));
    let quantities: Vec<_> = seen.columns.iter().map(|column| column.quantity).collect();
    assert_eq!(quantities, [None, None, None, Some("position")]);
    assert_eq!(seen.rows.len(), 20);
}

#[test]
fn names_for_its_columns_have_it_read_though_a_column_without_one_has_words() {
    let text = foreign("tick;chan a;state;chan b", |value| format!("{value:.4}"));
    let names = given(&[("column_names", "Time (ms); Current (A); ; Position (mm)")]);
    let m = read(&sources(&text, &names)).unwrap();
    assert_eq!(
        (m.metadata().input.unit.as_str(), m.metadata().response.unit.as_str()),
        ("A", "mm")
    );
    let seen = table(&text, &names);
    let used: Vec<_> = seen.columns.iter().map(|column| column.used_as).collect();
    assert_eq!(used, [Some("time_s"), Some("input"), None, Some("output")]);
    assert_eq!(seen.columns[1].name, "chan a");
}

#[test]
fn one_layout_is_known_again_whatever_is_given_and_measured() {
    let one = foreign("tick;chan a;state;chan b", |value| format!("{value:.4}"));
    let other = foreign("tick;chan a;state;chan b", |value| format!("{:.4}", 2.0 * value));
    let layout = |text: &str, given: &str| look(&sources(text, given)).layout;
    let names = given(&[("column_names", "Time (ms); Current (A); ; Position (mm)")]);
    assert!(layout(&one, "").is_some());
    assert_eq!(layout(&one, ""), layout(&other, &names));
    assert_ne!(layout(&one, ""), layout(&one.replace("chan b", "chan c"), ""));
    assert_eq!(layout("1 2 3\n4 5 6\n", ""), layout("7 8 9\n", ""));
    assert_ne!(layout("1 2 3\n4 5 6\n", ""), layout("1 2\n4 5\n", ""));
    assert_eq!(layout("{\"rows\": []}", ""), None);
}

#[test]
fn an_instrument_gives_its_columns_another_meaning() {
    let seen = table(
        "Frequency (Hz), V1 (Vrms), V2 (Vrms), θ (deg), Y1, Y2\n\
        1, 0.5, 0.25, -45, 0, 0\n10, 0.7, 0.1, -90, 0, 0\n",
        "",
    );
    let quantities: Vec<_> = seen.columns.iter().map(|column| column.quantity).collect();
    let expected =
        [Some("frequency"), Some("magnitude"), Some("amplitude"), Some("phase"), None, None];
    assert_eq!(quantities, expected);
}

#[test]
fn whatever_bytes_come_looking_at_them_ends() {
    for bytes in [
        &b""[..],
        b"\xff\xfe",
        b"PK\x03\x04",
        b"TDSm",
        b"    -1\n    58\n",
        b"\0\0\0",
        b"1",
        b"#\n#",
    ] {
        let seen = look(&[Source { name: "x", bytes }]);
        assert!(seen.files[0].table.as_ref().is_none_or(|table| table.rows.len() <= 20));
    }
}
