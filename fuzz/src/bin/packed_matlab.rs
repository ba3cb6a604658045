//! Elements of a MATLAB file, packed as MATLAB writes them: a mutated packed file unpacks to nothing.
#![no_main]

use std::io::Write as _;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use libfuzzer_sys::fuzz_target;

/// Kind of an element that is packed.
const PACKED: u32 = 15;

fuzz_target!(|element: &[u8]| {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::none());
    encoder.write_all(element).expect("a vector takes everything");
    let packed = encoder.finish().expect("a vector takes everything");
    let mut file = b"MATLAB 5.0 MAT-file".to_vec();
    file.resize(124, b' ');
    file.extend([0, 1, b'I', b'M']);
    file.extend([PACKED.to_le_bytes(), (packed.len() as u32).to_le_bytes()].concat());
    file.extend(packed);
    servoscope_fuzz::is_read_or_refused(&file);
});
