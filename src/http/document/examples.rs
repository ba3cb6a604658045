//! An example of every request and every answer, made by the types that make the real ones.

mod jobs;
mod measurements;

use serde::Serialize;
use serde_json::{Value, json};
use servoscope_core::answers::sample;

use crate::http::mappings::MappingView;
use crate::http::views::{Axis, Convergence, JobView, MeasurementView};
use crate::store::Status;

use super::{batches, keys, webhooks};
use jobs::{axis, convergence, history, job, result};
use measurements::{inspection, mapping, measured, preview};

pub(super) use jobs::asked;

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
