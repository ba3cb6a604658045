//! Examples of jobs, and of what comes of them.

use servoscope_core::answers::{
    ConvergenceRow, HistoryRow, IdentifyOptions, JobKind, Method, PlantRequest, Progress,
    ResultRow, Verdict,
};

use crate::service::{Job, JobRequest};
use crate::store::{AxisRow, JobRow, Priority, Status};

use super::{AT, AT_MS, JOB, MEASUREMENT};

/// What a job asks for.
pub(in crate::http::document) fn asked() -> JobRequest {
    JobRequest {
        kind: JobKind::Diagnose,
        plant: Some(PlantRequest { actuator_order: 0 }),
        method: Method::AbcAnn,
        options: IdentifyOptions::default(),
        validation_measurement_id: None,
        priority: Priority::Normal,
        estimated_s: Some(4.5),
    }
}

pub(super) fn job(status: Status) -> Job {
    let row = JobRow {
        id: JOB.into(),
        measurement_id: MEASUREMENT.into(),
        kind: "diagnose".into(),
        request: String::new(),
        status,
        progress: None,
        attempt: i64::from(status != Status::Queued),
        cancel_requested: status == Status::Cancelled,
        created_at_ms: AT_MS,
        started_at_ms: (status != Status::Queued).then_some(AT_MS + 12),
        finished_at_ms: status.is_final().then_some(AT_MS + 4200),
        failure: None,
        batch_id: None,
    };
    let progress = (status == Status::Running).then(|| Progress {
        stage: "searching".into(),
        done: 120,
        total: 400,
        fraction: 0.3,
        remaining_s: Some(2.5),
    });
    Job { row, request: asked(), progress, failure: None }
}

pub(super) fn convergence() -> ConvergenceRow {
    ConvergenceRow {
        stage: "colony".into(),
        cycle: 1,
        evaluations: 40,
        best: 1520.5,
        mean: Some(2210.25),
        elapsed_s: 0.8,
    }
}

pub(super) fn result() -> ResultRow {
    ResultRow {
        at: AT.into(),
        job_id: JOB.into(),
        measurement_id: MEASUREMENT.into(),
        name: None,
        machine: Some("press 4".into()),
        axis: Some("Y".into()),
        kind: JobKind::Diagnose,
        verdict: Some(Verdict::Explained),
        causes: Some("static_friction".into()),
        confidence: Some(0.99),
        ratio: Some(31.5),
        ratio_low95: Some(28.2),
        ratio_high95: Some(35.1),
        base_nrmse: 0.021,
        nrmse: 0.0007,
        chi2_per_dof: Some(1.01),
        adequate: Some(true),
        tested: Some(true),
    }
}

pub(super) fn history() -> HistoryRow {
    HistoryRow {
        at: AT.into(),
        parameter: "pole".into(),
        name: "Pole".into(),
        value: -10.02,
        std: Some(0.031),
        low95: Some(-10.08),
        high95: Some(-9.96),
        unit: "rad/s".into(),
        change: None,
        changed: false,
        causes: None,
        machine: Some("press 4".into()),
        axis: Some("Y".into()),
        measurement_id: MEASUREMENT.into(),
        job_id: JOB.into(),
    }
}

pub(super) fn axis() -> AxisRow {
    AxisRow {
        machine: "press 4".into(),
        axis: "Y".into(),
        measurements: 3,
        results: 2,
        first_ms: AT_MS,
        last_ms: AT_MS + 1_209_600_000,
    }
}
