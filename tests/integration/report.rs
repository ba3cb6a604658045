//! The report: one page, from the command line and from the service.

use roxmltree::{Document, ParsingOptions};
use serde_json::json;

use crate::process::{Server, servoscope, simulated};

/// A machine whose name must not be obeyed.
const MACHINE: &str = "<script>RT & Co</script>";

/// A noisy measurement of an axis that sticks harder than it slides.
fn sticky() -> Vec<u8> {
    let arguments = ["--fs-plus", "0.8", "--fs-minus", "0.6", "--noise-db", "60"];
    let table = simulated(&arguments);
    [format!("# machine: {MACHINE}\n# axis: C\n").as_bytes(), &table].concat()
}

/// What both ways to a report must hold to.
fn check(page: &str) {
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(page, options).unwrap();
    let named = |name: &str| document.descendants().filter(|n| n.has_tag_name(name)).count();
    // The page's own, which asks nobody for anything.
    assert_eq!(named("script"), 1);
    // Bode (and once more for a phone), residuals and spectrum before and after, friction, linearity,
    // convergence.
    assert_eq!(named("figure"), 9);
    assert_eq!(named("details"), 8);
    let title = document.descendants().find(|node| node.has_tag_name("h1")).unwrap();
    assert_eq!(title.text(), Some(format!("Diagnosis of {MACHINE}, axis C").as_str()));
    for part in ["The simulation lacks static friction", "all but certain", "What to do next"] {
        assert!(page.contains(part), "{part}");
    }
}

#[test]
fn diagnose_writes_its_report_and_says_where() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(path("sticky.csv"), sticky()).unwrap();
    let (file, report) = (path("sticky.csv"), path("out.html"));
    let output = servoscope(&["diagnose", &file, "--actuator-order", "0", "--report", &report]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && error.contains(&report), "{error}");
    check(&std::fs::read_to_string(&report).unwrap());
}

#[test]
fn identify_writes_its_report_and_refuses_a_file_it_cannot_write() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let (file, report) = (path("sticky.csv"), path("out.html"));
    std::fs::write(&file, sticky()).unwrap();
    let output = servoscope(&["identify", &file, "--actuator-order", "0", "--report", &report]);
    assert!(output.status.success());
    let page = std::fs::read_to_string(&report).unwrap();
    assert!(page.contains("The residual of the model is larger than the noise."), "{page}");
    let nowhere = path("no/folder/out.html");
    let begun = std::time::Instant::now();
    let output = servoscope(&["diagnose", &file, "--report", &nowhere]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains(&nowhere));
    // It is found before anything is computed: a diagnosis of this file takes seconds.
    assert!(begun.elapsed().as_secs_f64() < 1.0);
}

#[test]
fn the_service_gives_the_same_page() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    let measurement = server.post("/v1/measurements", "text/csv", &sticky());
    assert_eq!(measurement.status, 201, "{}", measurement.text);
    let job = server.submit(&json!({
        "measurement_id": measurement.json()["id"], "kind": "diagnose",
        "plant": {"actuator_order": 0},
    }));
    let ended = server.ended(&job);
    assert_eq!(ended["status"], "succeeded", "{ended}");
    let report = server.get(&format!("{job}/report.html"));
    assert_eq!(report.content_type, "text/html; charset=utf-8");
    check(&report.text);
}
