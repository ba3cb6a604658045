//! Jobs, from their submission to their result, and results tried on other measurements.

use super::*;

#[test]
fn a_job_goes_from_upload_to_result() {
    let server = Server::start();
    let body = json!({
        "measurement_id": server.measurement(), "kind": "identify",
        "plant": {"actuator_order": 0}, "method": "abc-ann", "options": {"seed": SUCCEED},
    });
    let answer = server.submit(&body);
    let location = header(&answer, "location").to_owned();
    assert_eq!(header(&answer, "retry-after"), "1");
    let job = json_of(answer, 202);
    assert_eq!(location, format!("/v1/jobs/{}", string(&job, "id")));

    let job = json_of(server.get(&format!("{location}?wait=60")), 200);
    assert_eq!(job["status"], "succeeded");
    assert_eq!(job["plant"]["actuator_order"], 0);
    assert_eq!(job["progress"]["stage"], "searching");
    let result = json_of(server.get(&format!("{location}/result")), 200);
    assert_eq!(result["seed"], SUCCEED);
    let history = json_of(server.get(&format!("{location}/convergence")), 200);
    assert_eq!(history["rows"][0]["best"], 0.125);
    let mut table = server.get(&format!("{location}/convergence.csv"));
    let table = table.body_mut().read_to_string().unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("stage,cycle,evaluations,best,mean,elapsed_s"));
    assert!(lines.next().is_some_and(|line| line.starts_with("colony,1,20,0.125,,")), "{table}");
}

#[test]
fn a_diagnosis_is_a_job_of_its_own_kind_and_result() {
    let server = Server::start();
    let submit = |seed: u64| {
        let body = json!({
            "measurement_id": server.measurement(), "kind": "diagnose", "options": {"seed": seed},
        });
        string(&json_of(server.submit(&body), 202), "id")
    };
    let id = submit(SUCCEED);
    let job = server.ended(&id);
    assert_eq!((&job["kind"], &job["status"]), (&json!("diagnose"), &json!("succeeded")));
    let result = json_of(server.get(&format!("/v1/jobs/{id}/result")), 200);
    assert_eq!(result["verdict"], "unexplained");
    assert_eq!((&result["causes"], &result["extended"]), (&json!([]), &Value::Null));
    assert_eq!(result["base"]["seed"], SUCCEED);
    let headline = string(&result, "headline");
    assert!(headline.starts_with("UNEXPLAINED: The simulation is wrong"), "{headline}");
    let failed = server.ended(&submit(UNUSABLE));
    assert!(string(&failed["failure"], "reason").contains("one frequency only"));
}

#[test]
fn a_diagnosis_is_tried_on_its_second_measurement() {
    let server = Server::start();
    let second = server.measurement();
    let body = json!({
        "measurement_id": server.measurement(), "kind": "diagnose",
        "validation_measurement_id": second,
    });
    let id = string(&json_of(server.submit(&body), 202), "id");
    let job = server.ended(&id);
    assert_eq!(job["status"], "succeeded", "{job}");
    assert_eq!(job["validation_measurement_id"], second.as_str());
    let result = json_of(server.get(&format!("/v1/jobs/{id}/result")), 200);
    assert_eq!(result["validation"]["data_sha256"], "11ee");
}

#[test]
fn a_result_is_tried_on_another_measurement() {
    let server = Server::start();
    let measurement = server.measurement();
    let validate = |job: &str, measurement: &str| {
        let body = json!({"job_id": job, "measurement_id": measurement}).to_string();
        server.post("/v1/validations", &[("content-type", "application/json")], body.as_bytes())
    };
    let id = server.job(SUCCEED);
    server.ended(&id);
    let found = json_of(validate(&id, &measurement), 200);
    assert_eq!(found["gain"]["ratio"], 4.0);
    let unknown = problem(validate("nobody", &measurement), 404);
    assert!(string(&unknown, "detail").contains("no job `nobody`"), "{unknown}");
    let unknown = problem(validate(&id, "nobody"), 404);
    assert!(string(&unknown, "detail").contains("no measurement `nobody`"), "{unknown}");

    let incomparable = server.job(INCOMPARABLE);
    server.ended(&incomparable);
    let refused = problem(validate(&incomparable, &measurement), 422);
    assert_eq!(refused["member"], "measurement_id");
    assert!(string(&refused, "detail").contains("no fc_minus"), "{refused}");

    let running = server.job(RUN_UNTIL_CANCELLED);
    problem(validate(&running, &measurement), 409);
    json_of(server.post(&format!("/v1/jobs/{running}/cancel"), &[], b""), 202);
    server.ended(&running);
    problem(validate(&running, &measurement), 404);

    let headers = [("content-type", "application/json")];
    let wrong = problem(server.post("/v1/validations", &headers, b"{\"job\": 1}"), 422);
    assert_eq!(wrong["member"], "job");
    problem(server.post("/v1/validations", &[], b"{}"), 415);
}

#[test]
fn bad_jobs_are_refused_with_the_member_and_what_is_known() {
    let server = Server::start();
    let measurement = server.measurement();
    let refused = |patch: Value, status: u16| {
        let mut body = json!({"measurement_id": measurement, "kind": "identify"});
        body.as_object_mut().unwrap().extend(patch.as_object().unwrap().clone());
        problem(server.submit(&body), status)
    };
    let cases = [
        (json!({"kind": "divine"}), "kind", "known: identify, diagnose"),
        (
            json!({"validation_measurement_id": "x"}),
            "validation_measurement_id",
            "`POST /v1/validations`",
        ),
        (
            json!({"kind": "diagnose", "validation_measurement_id": measurement}),
            "validation_measurement_id",
            "proves nothing",
        ),
        (json!({"method": "magic"}), "method", "known: abc-ann"),
        (json!({"plant": {"actuator_order": 3}}), "plant.actuator_order", "known: 0, 1, 2"),
        (json!({"plant": {"actuator_order": "2"}}), "plant.actuator_order", "string"),
        (json!({"plant": {"order": 2}}), "plant.order", "expected `actuator_order`"),
        (json!({"options": {"sead": 2}}), "options.sead", "`noise_std`"),
        (json!({"options": {"colony": {"bees": 2}}}), "options.colony.bees", "`food_sources`"),
        (json!({"options": {"noise_std": -1.0}}), "options.noise_std", "positive"),
        (json!({"colour": "red"}), "colour", "`measurement_id`"),
    ];
    for (patch, member, known) in cases {
        let problem = refused(patch, 422);
        assert_eq!(problem["member"], member, "{problem}");
        assert!(string(&problem, "detail").contains(known), "{problem}");
    }
    refused(json!({"measurement_id": "nobody"}), 404);
    let nobody = json!({"kind": "diagnose", "validation_measurement_id": "nobody"});
    assert!(string(&refused(nobody, 404), "detail").contains("no measurement `nobody`"));
    assert_eq!(json_of(server.get("/v1/jobs"), 200)["items"], json!([]));
}

#[test]
fn a_running_job_is_cancelled_and_cancelling_again_is_no_error() {
    let server = Server::start();
    let id = server.job(RUN_UNTIL_CANCELLED);
    let early = problem(server.get(&format!("/v1/jobs/{id}/result")), 409);
    assert!(string(&early, "detail").contains("?wait="), "{early}");
    let waiting = server.get(&format!("/v1/jobs/{id}"));
    assert_eq!(header(&waiting, "retry-after"), "1");
    for _ in 0..2 {
        let job = json_of(server.post(&format!("/v1/jobs/{id}/cancel"), &[], b""), 202);
        assert_eq!(job["cancel_requested"], true);
    }
    assert_eq!(server.ended(&id)["status"], "cancelled");
    let listed = json_of(server.get("/v1/jobs?status=cancelled"), 200);
    assert_eq!(listed["items"][0]["id"], id.as_str());
    problem(server.get(&format!("/v1/jobs/{id}/result")), 404);
}

#[test]
fn a_failed_job_says_why_and_cannot_be_cancelled() {
    let server = Server::start();
    let id = server.job(UNUSABLE);
    let job = server.ended(&id);
    assert_eq!(job["status"], "failed");
    assert!(string(&job["failure"], "reason").contains("one frequency only"));
    problem(server.post(&format!("/v1/jobs/{id}/cancel"), &[], b""), 409);
    let result = problem(server.get(&format!("/v1/jobs/{id}/result")), 404);
    assert!(string(&result, "detail").contains("one frequency only"), "{result}");
}
