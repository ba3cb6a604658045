//! An example of every request and every answer, made by the types that make the real ones.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Value, json};
use servoscope_core::answers::{
    ConvergenceRow, Detectability, DetectableEffect, EffectSize, HistoryRow, IdentifyOptions,
    Inspection, JobKind, Method, NoiseSource, PlantRequest, Progress, ResultRow, SizedParameter,
    Verdict, sample,
};

use crate::http::mappings::MappingView;
use crate::http::previews::PreviewView;
use crate::http::views::{Axis, Convergence, JobView, MeasurementView};
use crate::service::{
    ColumnLook, FileLook, Job, JobRequest, Look, Mapping, Measured, Preview, Quantities, Quantity,
    TableLook,
};
use crate::store::{AxisRow, JobRow, MeasurementRow, Priority, Status};

use super::{batches, keys, webhooks};

pub(super) const MEASUREMENT: &str = "019a9c1e-7d20-7c55-9f3a-5e0d3b1c2a44";
pub(super) const JOB: &str = "019a9c1e-8b31-7d06-8a4e-2f9c6d7e1b55";
/// 2026-03-04T10:20:00Z
pub(super) const AT_MS: i64 = 1_772_619_600_000;
const AT: &str = "2026-03-04T10:20:00Z";

const TABLE: &str = "# input: current A\n# response: velocity rad/s\n\
    magnitude,omega_rad_s,harmonic,re,im,std\n1,2,0,-0.0351,0,0.0007\n\
    1,2,1,0.4416,-0.0415,0.0007\n";
const RESULTS: &str = "at,job_id,measurement_id,name,machine,axis,kind,verdict,causes,confidence,\
    ratio,ratio_low95,ratio_high95,base_nrmse,nrmse,chi2_per_dof,adequate,tested\n";
const HISTORY: &str = "at,parameter,name,value,std,low95,high95,unit,change,changed,causes,machine,\
    axis,measurement_id,job_id\n";
const COMPARISON: &str = "experiment,magnitude [A],omega [rad/s],run,harmonic,u_re [A],u_im [A],\
    measured_re [rad/s],measured_im [rad/s],std [rad/s],std_estimated,base_re [rad/s],\
    base_im [rad/s],extended_re [rad/s],extended_im [rad/s]\n\
    0,1.0,2.0,,1,1.0,0.0,0.4416,-0.0415,0.0007,0,0.4402,-0.0409,,\n";
const SVG: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 800 600\"></svg>";
const COLUMN_NAMES: &str = "Time (ms); Current (A); ; Position (mm)";
const LAYOUT: &str = "2e0ce1505acbafd16c4617961720ced3";

/// What a request may send; `None` for bytes that no text can show.
pub(super) fn request(operation: &str, media_type: &str) -> Option<Value> {
    let upload = matches!(operation, "add_measurement" | "preview_measurement");
    Some(match (operation, media_type) {
        (_, "text/csv") if upload => json!(TABLE),
        (_, "text/plain") if upload => {
            json!("Zeit [ms];Strom (A);Lage [mm]\n0;1,0;0,25\n1;0,99;0,31\n")
        }
        (_, "text/tab-separated-values") if upload => {
            json!("Time (s)\tCurrent (A)\tSpeed (rad/s)\n0\t1\t0.25\n0.001\t0.99\t0.31\n")
        }
        (_, "application/json") if upload => json!(
            "{\"input\": \"current A\", \"response\": \"velocity rad/s\", \"rows\": [{\"magnitude\": \
             1, \"omega_rad_s\": 2, \"harmonic\": 1, \"re\": 0.4416, \"im\": -0.0415}]}"
        ),
        (_, "multipart/form-data") if upload => {
            json!({"file": [TABLE], "response": "velocity rad/s"})
        }
        ("submit_job", _) => json!({
            "measurement_id": MEASUREMENT, "kind": "diagnose", "options": {"seed": 1},
        }),
        ("validate", _) => json!({"job_id": JOB, "measurement_id": MEASUREMENT}),
        ("plan" | "plan_excitation" | "plan_figure", _) => json!({
            "axis": {"pole": -10.0, "constant": 10.0, "fc_plus": 0.5, "fc_minus": 0.4},
            "budget_s": 80.0,
        }),
        ("describe_measurement", _) => json!({"name": "before the repair", "machine": "press 4"}),
        ("read_again" | "preview_reading", _) => json!({"given": {"response": "position mm"}}),
        ("put_mapping", _) => json!({
            "settings": {"column_names": COLUMN_NAMES}, "layout": LAYOUT,
        }),
        _ => {
            let others = webhooks::request(operation).or_else(|| keys::request(operation));
            return others.or_else(|| batches::request(operation));
        }
    })
}

/// What an operation answers where nothing is wrong.
pub(super) fn answer(operation: &str, media_type: &str) -> Option<Value> {
    let rows = |rows: Value| json!({"rows": rows});
    let list = |item: Value| json!({"items": [item], "next": null});
    Some(match (operation, media_type) {
        ("live" | "ready", _) => json!("ok\n"),
        ("metrics", _) => json!("# TYPE servoscope_jobs_queued gauge\nservoscope_jobs_queued 0\n"),
        ("openapi_document", _) => json!({"openapi": "3.1.0"}),
        ("add_measurement" | "get_measurement" | "describe_measurement" | "read_again", _) => {
            shown(MeasurementView::from(measured()))
        }
        ("list_measurements", _) => list(shown(MeasurementView::from(measured()))),
        ("preview_measurement" | "preview_reading", _) => preview(),
        ("get_mapping" | "put_mapping", "application/json") => shown(MappingView::from(mapping())),
        ("get_mapping" | "get_mapping_toml", _) => json!(mapping().toml()),
        ("list_mappings", _) => list(shown(MappingView::from(mapping()))),
        ("get_measurement_csv", _) => json!(TABLE),
        ("get_measurement_json", _) => json!({
            "metadata": {"input": "current A", "response": "velocity rad/s"},
            "experiments": [{"magnitude": 1.0, "omega_rad_s": 2.0, "harmonics":
                [{"harmonic": 1, "re": 0.4416, "im": -0.0415, "std": 0.0007}]}],
        }),
        ("inspect_measurement", _) => shown(inspection()),
        ("plan", _) => shown(sample::plan()),
        ("plan_excitation", _) => json!("time_s,input,segment\n0.0,1.0,0\n0.001,0.999,0\n"),
        ("submit_job", _) => shown(JobView::from(job(Status::Queued))),
        ("get_job", _) => shown(JobView::from(job(Status::Running))),
        ("cancel_job", _) => shown(JobView::from(job(Status::Cancelled))),
        ("list_jobs", _) => list(shown(JobView::from(job(Status::Succeeded)))),
        ("get_result", _) => identified(),
        ("get_convergence", _) => shown(Convergence { rows: vec![convergence()] }),
        ("get_convergence_csv", _) => {
            json!("stage,cycle,evaluations,best,mean,elapsed_s\ncolony,1,40,1520.5,2210.25,0.8\n")
        }
        ("follow_job", _) => json!(
            "event: convergence\nid: 1\ndata: {\"stage\":\"colony\",\"cycle\":1,\
             \"evaluations\":40,\"best\":1520.5,\"mean\":2210.25,\"elapsed_s\":0.8}\n\n"
        ),
        ("get_parameters_csv", _) => json!(
            "model,parameter,value,std,low95,high95,unit\nbase,pole,-10.02,0.031,-10.08,-9.96,rad/s\n"
        ),
        ("get_comparison_csv", _) => json!(COMPARISON),
        ("get_measurement_figure" | "get_plot" | "get_history_figure" | "plan_figure", _) => {
            json!(SVG)
        }
        ("get_report", _) => json!("<!DOCTYPE html>\n<html lang=\"en\">…</html>\n"),
        ("validate", _) => shown(sample::validation()),
        ("list_results", _) => rows(json!([result()])),
        ("list_results_csv", _) => json!(format!(
            "{RESULTS}{AT},{JOB},{MEASUREMENT},,press 4,Y,diagnose,explained,static_friction,0.99,\
             31.5,28.2,35.1,0.021,0.0007,1.01,true\n"
        )),
        ("list_axes", _) => list(shown(Axis::from(axis()))),
        ("get_history", _) => rows(json!([history()])),
        ("get_history_csv", _) => json!(format!(
            "{HISTORY}{AT},pole,Pole,-10.02,0.031,-10.08,-9.96,rad/s,,false,,press 4,Y,\
             {MEASUREMENT},{JOB}\n"
        )),
        _ => {
            let others = webhooks::answer(operation).or_else(|| keys::answer(operation));
            return others.or_else(|| batches::answer(operation));
        }
    })
}

fn identified() -> Value {
    let mut result = shown(sample::identification());
    result["headline"] = json!("ADEQUATE: The model explains the measurement to within its noise.");
    result
}

/// The JSON of a view. Numbers and text only: it cannot fail.
pub(super) fn shown(view: impl Serialize) -> Value {
    serde_json::to_value(view).unwrap_or_default()
}

fn measured() -> Measured {
    let row = MeasurementRow {
        id: MEASUREMENT.into(),
        created_at_ms: AT_MS,
        name: Some("stepped sine".into()),
        machine: Some("press 4".into()),
        axis: Some("Y".into()),
        operator: Some("Ada".into()),
        measured_at: Some(AT.into()),
        labels: String::new(),
        sha256: "9acce10255ee0080c236607c559852ad2a5a72352215e8641117972aeba3b441".into(),
        experiments: 27,
        highest_harmonic: 5,
        magnitude_min: 1.0,
        magnitude_max: 3.0,
        omega_min_rad_s: 1.0,
        omega_max_rad_s: 100.0,
        notes: String::new(),
        quantities: None,
        files: String::new(),
        simulation_s: None,
        diagnosis_s: None,
    };
    let quantity = |name: &str, unit: &str| Quantity { name: name.into(), unit: unit.into() };
    let quantities = Quantities {
        input: quantity("current", "A"),
        response: quantity("velocity", "rad/s"),
        response_kind: "velocity".into(),
        r#loop: Some("open".into()),
    };
    let labels = BTreeMap::from([("site".to_owned(), "north".to_owned())]);
    let notes = vec!["column temperature is unknown and not used".to_owned()];
    let files = vec!["press-4-y.csv".to_owned()];
    Measured { row, labels, quantities: Some(quantities), notes, files }
}

fn mapping() -> Mapping {
    Mapping {
        name: "rig 7".into(),
        settings: [("column_names".to_owned(), COLUMN_NAMES.to_owned())].into(),
        layout: Some(LAYOUT.into()),
        updated_at_ms: AT_MS,
    }
}

fn preview() -> Value {
    let column = |name: &str, quantity, unit: &str, used_as| ColumnLook {
        name: name.into(),
        quantity: Some(quantity),
        unit: unit.into(),
        used_as: Some(used_as),
    };
    let table = TableLook {
        delimiter: Some("semicolons"),
        decimal: Some("comma"),
        preamble: vec!["Rig 7".into()],
        line: Some(2),
        columns: vec![
            column("tick", "time", "ms", "time_s"),
            column("chan a", "current", "A", "input"),
        ],
        rows: vec![vec!["0".into(), "1,0".into()]],
        sheets: Vec::new(),
    };
    let file = FileLook {
        name: "rig.txt".into(),
        format: "text in columns",
        encoding: None,
        table: Some(table),
    };
    let preview = Preview {
        look: Look { files: vec![file], layout: Some(LAYOUT.into()) },
        given: mapping().settings,
        mapping: Some("rig 7".into()),
        read: Ok(measured()),
    };
    shown(PreviewView::from(preview))
}

fn inspection() -> Inspection {
    let size = |value: f64| EffectSize {
        parameters: [("fs_plus".to_owned(), SizedParameter { value, unit: "A".into() })]
            .into_iter()
            .collect(),
        set_by: vec!["fs_plus".into()],
        change: 0.004,
    };
    let effect = DetectableEffect {
        effect: "static_friction".into(),
        title: "static friction".into(),
        detected_from: Some(size(0.52)),
        named_from: Some(size(0.55)),
        closest_imitator: Some("stribeck".into()),
        reason: None,
    };
    let detectability = Detectability {
        noise: NoiseSource::Given,
        nrmse: 0.0007,
        chi2_per_dof: Some(1.01),
        least_excess: 20.0,
        effects: vec![effect],
    };
    Inspection { doubts: Vec::new(), detectability: Some(detectability), obstacle: None }
}

/// What a job asks for.
pub(super) fn asked() -> JobRequest {
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

fn job(status: Status) -> Job {
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

fn convergence() -> ConvergenceRow {
    ConvergenceRow {
        stage: "colony".into(),
        cycle: 1,
        evaluations: 40,
        best: 1520.5,
        mean: Some(2210.25),
        elapsed_s: 0.8,
    }
}

fn result() -> ResultRow {
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

fn history() -> HistoryRow {
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

fn axis() -> AxisRow {
    AxisRow {
        machine: "press 4".into(),
        axis: "Y".into(),
        measurements: 3,
        results: 2,
        first_ms: AT_MS,
        last_ms: AT_MS + 1_209_600_000,
    }
}
