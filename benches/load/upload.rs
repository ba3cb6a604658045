//! Uploads as large as the default limits allow.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::io::Write as _;

use flate2::Compression;
use flate2::write::GzEncoder;

/// Bytes of a mebibyte.
const MIB: usize = 1 << 20;

/// Samples a second, and a period.
const RATE: usize = 1000;

/// Each with its name, its `Content-Encoding` and its bytes.
pub fn largest() -> [(&'static str, Option<&'static str>, Vec<u8>); 2] {
    let plain = record(64 * MIB, 12);
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(&record(128 * MIB, 27)).expect("memory");
    let packed = packed.finish().expect("memory");
    assert!(packed.len() <= 64 * MIB, "{} bytes", packed.len());
    [
        ("a time record of 64 MiB", None, plain),
        ("a time record of 128 MiB, packed", Some("gzip"), packed),
    ]
}

/// A time record of at most so many bytes, its samples with so many decimals.
fn record(bytes: usize, decimals: usize) -> Vec<u8> {
    let mut text = String::with_capacity(bytes);
    text.push_str("# input: current A\n# response: velocity rad/s\n# period_s: 1\n");
    text.push_str("time_s,input,output\n");
    for sample in 0.. {
        let before = text.len();
        let time_s = sample as f64 / RATE as f64;
        let (input, output) = ((TAU * time_s).cos(), 0.7 * (TAU * time_s - 0.6).cos());
        let written = writeln!(text, "{time_s:.3},{input:.decimals$},{output:.decimals$}");
        written.expect("memory");
        // Whole periods; a line may be longer than the ones before.
        if text.len() > bytes {
            text.truncate(before);
            break;
        }
    }
    text.into_bytes()
}
