//! Experiments planned before anything is measured.

use super::*;
use crate::service::{PlanFor, ServiceError};

fn asked() -> Value {
    let axis = json!({"pole": -10, "constant": 10, "fc_plus": 0.5, "fc_minus": 0.4});
    json!({"axis": axis, "budget_s": 30})
}

fn ask(server: &Server, path: &str, body: &Value) -> Response<Body> {
    let json = [("content-type", "application/json")];
    server.post(path, &json, body.to_string().as_bytes())
}

#[test]
fn a_plan_is_made_drawn_and_written_as_samples() {
    let server = Server::start();
    let plan = json_of(ask(&server, "/v1/plans", &asked()), 200);
    assert_eq!(plan["experiments"].as_array().unwrap().len(), 12);
    let mut figure = ask(&server, "/v1/plans/plan.svg", &asked());
    assert_eq!(header(&figure, "content-type"), "image/svg+xml");
    assert!(figure.body_mut().read_to_string().unwrap().contains("planned, run 0"));
    let mut samples = ask(&server, "/v1/plans/excitation.csv", &asked());
    assert_eq!(header(&samples, "content-type"), "text/csv");
    assert!(samples.body_mut().read_to_string().unwrap().contains("time_s,input,segment"));
}

#[test]
fn what_cannot_be_planned_is_refused_by_its_member() {
    let server = Server::start();
    let refused = |change: &dyn Fn(&mut Value)| {
        let mut asked = asked();
        change(&mut asked);
        problem(ask(&server, "/v1/plans", &asked), 422)
    };
    let neither = refused(&|asked| {
        asked.as_object_mut().unwrap().remove("axis");
    });
    assert!(neither["detail"].as_str().unwrap().contains("job_id"), "{neither}");
    let both = refused(&|asked| asked["job_id"] = json!("x"));
    assert_eq!(both["member"], "axis");
    let unknown = refused(&|asked| asked["options"] = json!({"magnitude": 3}));
    assert!(unknown["detail"].as_str().unwrap().contains("largest_magnitude"), "{unknown}");
    let kind = ask(&server, "/v1/plans/excitation.csv?kind=chirp", &asked());
    assert_eq!(problem(kind, 422)["member"], "kind");
}

#[test]
fn a_plan_that_would_compute_for_longer_than_a_job_may_is_refused_with_what_to_do() {
    let server = Server::start();
    let strict = server.service.clone().accepting(Duration::from_secs(10));
    let plan = |budget_s: f64| {
        let axis = serde_json::from_value(asked()["axis"].clone()).unwrap();
        let options = Default::default();
        let question = PlanFor { axis: Some(axis), job_id: None, budget_s, options };
        server.runtime.block_on(strict.plan(question))
    };
    assert!(plan(30.0).is_ok());
    let refused = plan(100_000.0).unwrap_err();
    assert!(matches!(refused, ServiceError::TooCostly { .. }), "{refused}");
    let text = refused.to_string();
    assert!(text.contains("the 10 seconds that a job may") && text.contains("budget_s"), "{text}");
}
