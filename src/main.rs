//! servoscope
fn main() {}
