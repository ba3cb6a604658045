//! Files of level 5 as they are documented, and what is refused of them.

use std::io::Write as _;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::super::{Given, Source, read};
use crate::measurement::{Complex, Measurement};

/// An element with its tag, padded.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn doubles(values: &[f64]) -> Vec<u8> {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    element(9, &bytes)
}

fn head(class: u32, dimensions: [u32; 2], name: &str) -> Vec<u8> {
    let flags = element(6, &[class.to_le_bytes(), [0; 4]].concat());
    let dimensions = element(5, &dimensions.map(u32::to_le_bytes).concat());
    [flags, dimensions, element(1, name.as_bytes())].concat()
}

/// A column vector of doubles.
fn vector(name: &str, values: &[f64]) -> Vec<u8> {
    let head = head(6, [values.len() as u32, 1], name);
    element(14, &[head, doubles(values)].concat())
}

/// A complex one.
fn complex(name: &str, values: &[Complex]) -> Vec<u8> {
    let head = head(6 | 0x0800, [values.len() as u32, 1], name);
    let parts = [|z: &Complex| z.re, |z: &Complex| z.im].map(|part| {
        let values: Vec<f64> = values.iter().map(part).collect();
        doubles(&values)
    });
    element(14, &[head, parts.concat()].concat())
}

/// A structure of vectors.
fn structure(name: &str, fields: &[(&str, Vec<f64>)]) -> Vec<u8> {
    let mut names = Vec::new();
    for (field, _) in fields {
        let mut padded = field.as_bytes().to_vec();
        padded.resize(8, 0);
        names.extend(padded);
    }
    // A length of four bytes stands in its tag.
    let length = [5_u32 | 4 << 16, 8].map(u32::to_le_bytes).concat();
    let values: Vec<u8> = fields.iter().flat_map(|(_, values)| vector("", values)).collect();
    element(14, &[head(2, [1, 1], name), length, element(1, &names), values].concat())
}

fn compressed(element: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(element).unwrap();
    let packed = encoder.finish().unwrap();
    [15_u32.to_le_bytes().to_vec(), (packed.len() as u32).to_le_bytes().to_vec(), packed].concat()
}

fn file(elements: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file, written for a test".to_vec();
    bytes.resize(124, b' ');
    bytes.extend([0, 1, b'I', b'M']);
    bytes.extend(elements.concat());
    bytes
}

fn parsed(bytes: &[u8]) -> Result<Measurement, String> {
    read(&[Source { name: "a.mat", bytes }]).map_err(|error| error.to_string())
}

/// A file with something stated beside it.
fn stating(entries: &[(&str, &str)], bytes: &[u8]) -> Measurement {
    let mut given = Given::default();
    entries.iter().for_each(|(key, value)| given.set(key, value).unwrap());
    let text = given.text().unwrap();
    let stated = Source { name: Given::NAME, bytes: text.as_bytes() };
    read(&[Source { name: "a.mat", bytes }, stated]).unwrap()
}

/// Elements of a file that can be read.
pub(crate) fn readable() -> Vec<u8> {
    let [times, input, output] = samples();
    [
        vector("time", &times),
        structure("run", &[("current", input), ("velocity", output)]),
        complex("Y", &[Complex::new(0.5, -0.25); 4]),
    ]
    .concat()
}

/// One element that a record is read from.
pub(crate) fn one_element() -> Vec<u8> {
    let [times, input, output] = samples();
    structure("run", &[("time", times), ("current", input), ("velocity", output)])
}

/// A file of elements as they are.
pub(crate) fn plain(elements: &[u8]) -> Vec<u8> {
    file(&[elements.to_vec()])
}

/// A file of one packed element.
pub(crate) fn packed(element: &[u8]) -> Vec<u8> {
    file(&[compressed(element)])
}

/// Samples of two periods of an input and of a response of half its size.
fn samples() -> [Vec<f64>; 3] {
    let times: Vec<f64> = (0..128).map(|n| f64::from(n) / 64.0).collect();
    let wave = |size: f64| times.iter().map(|t| size * (std::f64::consts::TAU * t).cos()).collect();
    [times.clone(), wave(2.0), wave(1.0)]
}

fn half(measurement: &Measurement) -> bool {
    let experiment = &measurement.experiments()[0];
    let ratio = experiment.harmonic(1).unwrap().value / experiment.input[1];
    (ratio - Complex::new(0.5, 0.0)).norm() < 1e-9
}

#[test]
fn vectors_with_known_names_are_a_record_packed_or_not_and_others_are_named() {
    let [times, input, output] = samples();
    let vectors = [
        vector("time", &times),
        vector("current", &input),
        vector("velocity", &output),
        vector("fs", &[64.0]),
    ];
    let plain = parsed(&file(&vectors)).unwrap();
    let packed = parsed(&file(&vectors.map(|vector| compressed(&vector)))).unwrap();
    assert!(half(&plain) && plain.experiments() == packed.experiments());
    let note = &plain.notes()[0];
    assert!(note.contains("`fs` have another length") && note.contains("time [s]"), "{note}");
}

#[test]
fn the_fields_of_a_structure_are_vectors_with_their_own_names() {
    let [times, input, output] = samples();
    let log = structure("log", &[("time", times), ("current", input), ("velocity", output)]);
    assert!(half(&parsed(&file(&[log])).unwrap()));
}

#[test]
fn columns_of_unknown_names_are_named_beside_the_file() {
    let [times, input, output] = samples();
    let vectors = [vector("x1", &times), vector("x2", &input), vector("x3", &output)];
    let refused = parsed(&file(&vectors)).unwrap_err();
    assert!(refused.contains("x1, x2, x3") && refused.contains("column_names"), "{refused}");
    let names = "time [s]; current [A]; velocity [rad/s]";
    assert!(half(&stating(&[("column_names", names)], &file(&vectors))));
}

#[test]
fn a_complex_vector_is_a_frequency_response() {
    let response = [Complex::new(0.5, -0.25), Complex::new(0.25, -0.5)];
    let vectors = [vector("f", &[1.0, 2.0]), complex("H", &response)];
    let measurement = stating(&[("magnitude", "2"), ("response", "velocity")], &file(&vectors));
    let values: Vec<Complex> =
        measurement.experiments().iter().map(|e| e.harmonic(1).unwrap().value).collect();
    assert_eq!(values, response.map(|ratio| 2.0 * ratio));
}

#[test]
fn a_file_that_is_cut_off_anywhere_is_refused_and_none_panics() {
    let [times, input, output] = samples();
    let log = structure("log", &[("time", times), ("current", input), ("velocity", output)]);
    let whole = file(&[log]);
    for end in 0..whole.len() {
        assert!(parsed(&whole[..end]).is_err(), "{end}");
    }
    // A length that reaches beyond the file, and one beyond the address space.
    for length in [u32::MAX, 0x7fff_ffff] {
        let mut wrong = whole.clone();
        wrong[132..136].copy_from_slice(&length.to_le_bytes());
        assert!(parsed(&wrong).unwrap_err().contains("cut off"));
    }
}

#[test]
fn a_file_of_level_7_3_is_refused_with_what_to_do() {
    let refused = parsed(b"MATLAB 7.3 MAT-file, Platform: GLNXA64").unwrap_err();
    assert!(refused.contains("-v7"), "{refused}");
}
