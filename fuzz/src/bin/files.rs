//! Files of every format, which is found from their bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| servoscope_fuzz::is_read_or_refused(bytes));
