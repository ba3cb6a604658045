//! Files as they are documented, and what is refused of them.

use super::super::{Given, Source, read};
use crate::measurement::{Complex, Measurement};

const FIRST: u32 = 1 << 1 | 1 << 2 | 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const NEVER: u64 = u64::MAX;

fn string(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

fn number(name: &str, value: f64) -> Vec<u8> {
    [string(name), 10_u32.to_le_bytes().to_vec(), value.to_le_bytes().to_vec()].concat()
}

fn text(name: &str, value: &str) -> Vec<u8> {
    [string(name), 0x20_u32.to_le_bytes().to_vec(), string(value)].concat()
}

/// A channel of doubles in a group: its index of raw data, and its properties.
fn object(name: &str, count: usize, properties: &[Vec<u8>]) -> Vec<u8> {
    let index = [20_u32, 10, 1].map(u32::to_le_bytes).concat();
    let count = (count as u64).to_le_bytes().to_vec();
    let length = (properties.len() as u32).to_le_bytes().to_vec();
    let path = string(&format!("/'run 1'/'{name}'"));
    [path, index, count, length, properties.concat()].concat()
}

fn segment(contents: u32, objects: &[Vec<u8>], values: &[f64], length: Option<u64>) -> Vec<u8> {
    let count = (objects.len() as u32).to_le_bytes().to_vec();
    let meta = match contents & 1 << 1 {
        0 => Vec::new(),
        _ => [count, objects.concat()].concat(),
    };
    let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
    let length = length.unwrap_or((meta.len() + data.len()) as u64);
    [
        b"TDSm".to_vec(),
        [contents, 4713].map(u32::to_le_bytes).concat(),
        [length, meta.len() as u64].map(u64::to_le_bytes).concat(),
        meta,
        data,
    ]
    .concat()
}

fn parsed(bytes: &[u8]) -> Result<Measurement, String> {
    read(&[Source { name: "a.tdms", bytes }]).map_err(|error| error.to_string())
}

/// Half of two periods of an input, and of a response of half its size, from sample `from` on.
fn halves(from: usize) -> [Vec<f64>; 2] {
    [2.0, 1.0].map(|size| {
        let value = |n: usize| size * (std::f64::consts::TAU * n as f64 / 64.0).cos();
        (from..from + 64).map(value).collect()
    })
}

fn channels() -> [Vec<u8>; 2] {
    let step = number("wf_increment", 1.0 / 64.0);
    [
        object("Motor current", 64, &[step.clone(), text("unit_string", "A")]),
        object("Velocity", 64, &[step, text("unit_string", "rad/s")]),
    ]
}

/// A file that can be read.
pub(crate) fn readable() -> Vec<u8> {
    let [first, second] = [halves(0), halves(64)].map(|halves| halves.concat());
    let segments = [segment(FIRST, &channels(), &first, None), segment(1 << 3, &[], &second, None)];
    segments.concat()
}

fn half(measurement: &Measurement) -> bool {
    let experiment = &measurement.experiments()[0];
    let ratio = experiment.harmonic(1).unwrap().value / experiment.input[1];
    (ratio - Complex::new(0.5, 0.0)).norm() < 1e-9
}

#[test]
fn channels_over_several_segments_are_a_record_with_its_units() {
    let [first, second] = [halves(0), halves(64)].map(|halves| halves.concat());
    let whole = [
        segment(FIRST, &channels(), &first, None),
        // As in the segment before: no objects are said.
        segment(1 << 3, &[], &second, None),
    ]
    .concat();
    let measurement = parsed(&whole).unwrap();
    assert!(half(&measurement));
    assert_eq!(measurement.metadata().input.unit, "A");
    // Both halves as two chunks of one segment, and interleaved.
    let chunks = segment(FIRST, &channels(), &[first, second].concat(), None);
    assert_eq!(parsed(&chunks).unwrap().experiments(), measurement.experiments());
    let [input, output] = [0, 1].map(|k| [halves(0), halves(64)].map(|h| h[k].clone()).concat());
    let mixed: Vec<f64> = input.iter().zip(&output).flat_map(|(u, y)| [*u, *y]).collect();
    let interleaved = segment(FIRST | INTERLEAVED, &channels(), &mixed, None);
    assert_eq!(parsed(&interleaved).unwrap().experiments(), measurement.experiments());
}

#[test]
fn a_recording_that_was_never_closed_is_read_as_far_as_it_goes() {
    let values = [halves(0), halves(64)].map(|halves| halves.concat()).concat();
    let mut open = segment(FIRST, &channels(), &values, Some(NEVER));
    assert!(half(&parsed(&open).unwrap()));
    open.extend([0; 100]);
    assert!(half(&parsed(&open).unwrap()));
}

#[test]
fn without_a_time_between_samples_it_is_asked_for() {
    let values = [halves(0), halves(64)].map(|halves| halves.concat()).concat();
    let bare = [object("current", 64, &[]), object("velocity", 64, &[])];
    let bytes = segment(FIRST, &bare, &values, None);
    assert!(parsed(&bytes).unwrap_err().contains("sample_s"));
    let mut given = Given::default();
    given.set("sample_s", "0.015625").unwrap();
    let text = given.text().unwrap();
    let stated = Source { name: Given::NAME, bytes: text.as_bytes() };
    assert!(half(&read(&[Source { name: "a.tdms", bytes: &bytes }, stated]).unwrap()));
}

#[test]
fn what_is_damaged_or_unscaled_is_refused_and_nothing_panics() {
    let values = halves(0).concat();
    let whole = segment(FIRST, &channels(), &values, None);
    for end in 1..whole.len() {
        assert!(parsed(&whole[..end]).is_err(), "{end}");
    }
    for at in 0..whole.len().min(400) {
        let mut wrong = whole.clone();
        wrong[at] = 0xff;
        let _ = parsed(&wrong);
    }
    let unscaled = segment(FIRST | 1 << 7, &channels(), &values, None);
    assert!(parsed(&unscaled).unwrap_err().contains("scaling"));
}
