//! The committed OpenAPI document.

use crate::process::{repository, servoscope};

#[test]
fn the_committed_document_is_what_the_program_prints() {
    let printed = servoscope(&["openapi"]);
    assert!(printed.status.success());
    let committed = std::fs::read_to_string(repository("openapi.yaml")).unwrap();
    let printed = String::from_utf8(printed.stdout).unwrap();
    assert!(printed == committed, "run: cargo run -- openapi > openapi.yaml");
}
