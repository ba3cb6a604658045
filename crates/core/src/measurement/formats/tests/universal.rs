//! Universal files, in the variants that programs write.

use super::*;

/// A dataset up to its numbers: function, data type, count, spacing, abscissa, numerator.
fn header(function: u32, form: [u32; 3], start: [f64; 2], axes: [(u32, &str, &str); 3]) -> String {
    let mut text = "Résonance\nNONE\nNONE\n01-JAN-26\nNONE\n".to_owned();
    text += &format!("{function:5}{:10}{:5}{:10} NONE {:13}{:4}\n", 0, 0, 0, 1, 3);
    let [kind, count, spacing] = form;
    text += &format!(
        "{kind:10}{count:10}{spacing:10}{:13.5e}{:13.5e}{:13.5e}\n",
        start[0], start[1], 0.0
    );
    for (quantity, label, unit) in axes.into_iter().chain([(0, "NONE", "NONE")]) {
        text += &format!("{quantity:10}{:5}{:5}{:5} {label:20} {unit:20}\n", 0, 0, 0);
    }
    text
}

const OF_RESPONSE: [(u32, &str, &str); 3] =
    [(18, "Frequency", "Hz"), (11, "Velocity", "m/s"), (13, "Force", "N")];

fn file(datasets: &[String]) -> String {
    datasets.iter().map(|data| format!("    -1\n    58\n{data}    -1\n")).collect()
}

fn with_magnitude(bytes: &[u8]) -> Result<Measurement, String> {
    let given = Source { name: "given", bytes: b"# given with the upload\n# magnitude: 2\n" };
    read(&[Source { name: "x.uff", bytes }, given]).map_err(|error| error.to_string())
}

/// 4 lines from 0 to 1.5 Hz; the last line of the numbers is not filled.
pub(super) fn response() -> String {
    let head = header(4, [5, 4, 1], [0.0, 0.5], OF_RESPONSE);
    file(&[format!("{head} 1.0E+00 0.0E+00 5.0E-01-2.5E-01 2.5E-01-1.25E-01\n 1.0D-01-5.0D-02\n")])
}

#[test]
fn a_frequency_response_is_read_whatever_its_line_ends_and_encoding() {
    let text = response();
    let plain = with_magnitude(text.as_bytes()).unwrap();
    let experiment = &plain.experiments()[0];
    assert_eq!(plain.experiments().len(), 3);
    assert_eq!(experiment.omega_rad_s, 0.5 * std::f64::consts::TAU);
    assert_eq!(experiment.response[0].value, Complex::new(1.0, -0.5));
    let metadata = plain.metadata();
    assert_eq!((metadata.input.unit.as_str(), metadata.response.unit.as_str()), ("N", "m/s"));
    assert!(plain.notes().iter().any(|note| note.contains("0 Hz")));
    for end in ["\r\n", "\r", "\r\r\n"] {
        let ended = text.replace('\n', end);
        assert_eq!(with_magnitude(ended.as_bytes()).unwrap().experiments(), plain.experiments());
    }
    let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
    assert_eq!(with_magnitude(&latin).unwrap().experiments(), plain.experiments());
    let error = read(&[Source { name: "x", bytes: text.as_bytes() }]).unwrap_err();
    assert!(error.reason.contains("--magnitude"), "{error}");
}

#[test]
fn a_binary_dataset_is_the_one_in_text() {
    let plain = with_magnitude(response().as_bytes()).unwrap();
    let values = [1.0, 0.0, 0.5, -0.25, 0.25, -0.125, 0.1, -0.05];
    for (order, kind) in [(1, 5), (2, 5), (1, 6), (2, 6)] {
        let bytes: Vec<u8> = values
            .iter()
            .flat_map(|value: &f64| match (order, kind) {
                (1, 5) => (*value as f32).to_le_bytes().to_vec(),
                (2, 5) => (*value as f32).to_be_bytes().to_vec(),
                (1, _) => value.to_le_bytes().to_vec(),
                _ => value.to_be_bytes().to_vec(),
            })
            .collect();
        let first = format!("    -1\n    58b{order:6}{:6}{:12}{:12}\n", 2, 11, bytes.len());
        let head = header(4, [kind, 4, 1], [0.0, 0.5], OF_RESPONSE);
        let file = [first.as_bytes(), head.as_bytes(), &bytes[..], b"\n    -1\n"].concat();
        let read = with_magnitude(&file).unwrap();
        for (a, b) in read.experiments().iter().zip(plain.experiments()) {
            // Rounding of 0.1 to single precision.
            assert!((a.response[0].value - b.response[0].value).norm() < 1e-8);
        }
        let cut = &file[..file.len() - 20];
        assert!(with_magnitude(cut).unwrap_err().contains("ends before"));
    }
}

/// A channel of a time record of 200 samples at uneven or even times.
fn channel(even: bool, axis: (u32, &str, &str), of: impl Fn(f64) -> f64) -> String {
    let axes = [(17, "Time", "s"), axis, (0, "NONE", "NONE")];
    let mut text = header(1, [4, 200, u32::from(even)], [0.0, 0.001], axes);
    for n in 0..200 {
        let time = f64::from(n) * 0.001;
        let value = of(std::f64::consts::TAU * f64::from(n) / 50.0);
        text += &if even {
            format!("{value:20.12e}\n")
        } else {
            format!("{time:13.5e}{value:20.12e}\n")
        };
    }
    text
}

#[test]
fn channels_of_one_time_are_a_record() {
    let force = channel(true, (13, "Shaker", "N"), f64::cos);
    let position = channel(true, (8, "Stage", "m"), |angle| (angle - 0.5).cos());
    let text = file(&[force.clone(), position]);
    let even = read(&[Source { name: "x.unv", bytes: text.as_bytes() }]).unwrap();
    assert_eq!(even.metadata().response_kind, ResponseKind::Position);
    assert!((even.experiments()[0].magnitude - 1.0).abs() < 1e-3);
    let uneven = file(&[
        channel(false, (13, "Shaker", "N"), f64::cos),
        channel(false, (8, "Stage", "m"), |angle| (angle - 0.5).cos()),
    ]);
    let uneven = read(&[Source { name: "x.unv", bytes: uneven.as_bytes() }]).unwrap();
    assert!(
        (uneven.experiments()[0].omega_rad_s / even.experiments()[0].omega_rad_s - 1.0).abs()
            < 1e-9
    );
    let alone = file(&[force]);
    let error = read(&[Source { name: "x", bytes: alone.as_bytes() }]).unwrap_err();
    assert!(error.reason.contains("response"), "{error}");
}

#[test]
fn what_is_not_read_is_refused_with_the_reason() {
    let power = file(&[header(9, [2, 1, 1], [0.0, 1.0], OF_RESPONSE) + "1.0\n"]);
    assert!(with_magnitude(power.as_bytes()).unwrap_err().contains("no phase"));
    let two = file(&[header(4, [5, 1, 1], [1.0, 1.0], OF_RESPONSE) + "1.0 0.0\n"]).repeat(2);
    assert!(with_magnitude(two.as_bytes()).unwrap_err().contains("2 frequency responses"));
    let short = response().replace(" 1.0D-01-5.0D-02\n", "");
    assert!(with_magnitude(short.as_bytes()).unwrap_err().contains("announces 8 numbers"));
    assert!(with_magnitude(b"    -1\n   151\nx\n    -1\n").unwrap_err().contains("no dataset 58"));
}

#[test]
fn a_mutated_universal_file_is_read_or_refused() {
    for valid in [response(), file(&[channel(false, (13, "F", "N"), f64::cos)])] {
        for at in (0..valid.len().min(2000)).step_by(3) {
            let mut bytes = valid.clone().into_bytes();
            bytes[at] ^= 1 << (at % 8);
            let _ = with_magnitude(&bytes);
            let _ = with_magnitude(&valid.as_bytes()[..at]);
        }
    }
}
