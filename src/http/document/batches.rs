//! Examples of requests about batches, and of their answers.

use serde_json::{Value, json};

use crate::http::batches::{BatchJobView, BatchView};
use crate::service::{Batch, BatchJob, BatchState, Counts};
use crate::store::{BatchRow, MemberRow, Status};

use super::examples::{AT_MS, JOB, MEASUREMENT, asked, shown};

const ID: &str = "019a9c1e-9c42-7e17-9b5f-3a0d7e8f2c66";
const OTHER_MEASUREMENT: &str = "019a9c1e-7d21-7b66-8c4b-6f1e4c2d3b55";
const TABLE: &str = "measurement_id,file,job_id,state,verdict,cause,confidence,problem,tested\n";

/// What a request may send; `None` for operations that have nothing to do with batches.
pub(super) fn request(operation: &str) -> Option<Value> {
    (operation == "submit_batch").then(|| {
        json!({
            "name": "press hall, March", "kind": "diagnose",
            "measurement_ids": [MEASUREMENT, OTHER_MEASUREMENT],
        })
    })
}

/// What an operation answers where nothing is wrong; `None` as above.
pub(super) fn answer(operation: &str) -> Option<Value> {
    let list = |item: Value| json!({"items": [item], "next": null});
    let waiting = Counts { queued: 2, ..Counts::default() };
    let half = Counts { running: 1, succeeded: 1, ..Counts::default() };
    let stopped = Counts { cancelled: 1, succeeded: 1, ..Counts::default() };
    Some(match operation {
        "submit_batch" => batch(BatchState::Queued, waiting),
        "get_batch" => batch(BatchState::Running, half),
        "cancel_batch" => batch(BatchState::Ended, stopped),
        "list_batches" => list(batch(BatchState::Running, half)),
        "list_batch_results" => list(shown(BatchJobView::from(row()))),
        "list_batch_results_csv" => json!(format!(
            "{TABLE}{MEASUREMENT},press-4-y.csv,{JOB},succeeded,explained,static_friction,0.99,,true\n"
        )),
        _ => return None,
    })
}

fn batch(state: BatchState, counts: Counts) -> Value {
    let row = BatchRow {
        id: ID.into(),
        created_at_ms: AT_MS,
        name: Some("press hall, March".into()),
        kind: "diagnose".into(),
        request: String::new(),
        jobs: 2,
    };
    let found = |name: &str| (counts.succeeded > 0).then(|| (name.to_owned(), counts.succeeded));
    shown(BatchView::from(Batch {
        row,
        request: asked(),
        state,
        counts,
        started_ms: (state != BatchState::Queued).then_some(AT_MS + 12),
        ended_ms: (state == BatchState::Ended).then_some(AT_MS + 4200),
        verdicts: found("explained").into_iter().collect(),
        causes: found("static_friction").into_iter().collect(),
        failures: Vec::new(),
    }))
}

fn row() -> BatchJob {
    let row = MemberRow {
        measurement_id: MEASUREMENT.into(),
        file: Some("press-4-y.csv".into()),
        job_id: JOB.into(),
        status: Some(Status::Succeeded),
        verdict: Some("explained".into()),
        cause: Some("static_friction".into()),
        confidence: Some(0.99),
        failure: None,
    };
    BatchJob { row, tested: Some(true), problem: None }
}
