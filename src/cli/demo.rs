//! A stranger's first ten minutes: a measurement of the project's own, diagnosed.

use std::time::Duration;

use servoscope_core::answers::Answer;

use crate::report;
use crate::service::{Service, ServiceError, Submission, Upload};
use crate::store::FileRow;

use super::terminal;

/// What `servoscope simulate --fs-plus 0.8 --fs-minus 0.6 --noise-db 60` prints: an
/// axis that sticks harder than it slides.
const MEASUREMENT: &[u8] = include_bytes!("demo/sticky_axis.csv");

/// Far more than the job takes.
const PATIENCE: Duration = Duration::from_secs(600);

/// Diagnoses the bundled measurement on a running service and prints the answer
/// and the addresses to open. Asked again, it shows the answer there is.
pub(super) async fn show(service: &Service, address: &str) -> Result<(), ServiceError> {
    let file = FileRow {
        name: "sticky_axis.csv".into(),
        content_type: "text/csv".into(),
        bytes: MEASUREMENT.to_vec(),
    };
    let upload =
        Upload { name: Some("demonstration".into()), files: vec![file], ..Upload::default() };
    let measured = service.add_measurement(upload, Some("demonstration".into())).await?.resource;
    let submission = Submission {
        measurement_id: measured.row.id.clone(),
        kind: "diagnose".into(),
        ..Submission::default()
    };
    let job = service.submit(&submission, Some("demonstration".into())).await?.resource.row.id;
    println!(
        "diagnosing a simulated axis that sticks harder than it slides …\n\
         watch it at {address}/jobs/{job}"
    );
    let ended = service.job_when_ended(&job, PATIENCE).await?;
    if !ended.row.status.is_final() {
        // The process was asked to stop.
        return Ok(());
    }
    let result = service.result(&job).await?;
    if let Ok(answer) = Answer::from_json(&result) {
        let text = report::summary(&answer, terminal::width());
        anstream::println!("\n{text}");
    }
    println!(
        "Look at it:\n  \
         {address}/jobs/{job}                      the answer, in the dashboard\n  \
         {address}/v1/jobs/{job}/report.html       the whole answer as a page to keep\n  \
         {address}/v1/jobs/{job}/result            the same as JSON\n  \
         {address}/v1/measurements/{}/data.csv     what was measured\n  \
         {address}/docs                            every request, to try\n\n\
         The server goes on until it is interrupted (Ctrl-C).",
        measured.row.id,
    );
    Ok(())
}
