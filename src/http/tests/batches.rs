//! Batches of measurements.

use super::*;

impl Server {
    fn measurements(&self, count: usize) -> Vec<String> {
        let upload = |place| {
            let path = format!("/v1/measurements?name=run%20{place}.csv");
            let answer = self.post(&path, &[("content-type", "text/csv")], b"any");
            string(&json_of(answer, 201), "id")
        };
        (0..count).map(upload).collect()
    }

    fn submit_batch(&self, headers: &[(&str, &str)], body: &Value) -> Response<Body> {
        let json = [&[("content-type", "application/json")], headers].concat();
        self.post("/v1/batches", &json, body.to_string().as_bytes())
    }

    fn batch(&self, measurements: &[String], seed: u64) -> Value {
        json_of(self.submit_batch(&[], &asked(measurements, seed)), 202)
    }

    fn batch_ended(&self, id: &str) -> Value {
        let began = Instant::now();
        loop {
            let batch = json_of(self.get(&format!("/v1/batches/{id}")), 200);
            if batch["state"] == "ended" {
                return batch;
            }
            assert!(began.elapsed() < Duration::from_secs(60), "{batch}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

fn asked(measurements: &[String], seed: u64) -> Value {
    json!({
        "name": "press hall", "kind": "diagnose", "measurement_ids": measurements,
        "options": {"seed": seed},
    })
}

fn counts(batch: &Value) -> Value {
    let counts = batch["counts"].as_object().unwrap().iter().filter(|(_, count)| **count != 0);
    counts
        .map(|(state, count)| (state.clone(), count.clone()))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

#[test]
fn a_batch_goes_from_measurements_to_a_table_of_what_came_of_each() {
    let server = Server::start();
    let measurements = server.measurements(3);
    let answer = server.submit_batch(&[], &asked(&measurements, SUCCEED));
    let location = header(&answer, "location").to_owned();
    let made = json_of(answer, 202);
    let id = string(&made, "id");
    assert_eq!(location, format!("/v1/batches/{id}"));
    assert_eq!((&made["name"], &made["jobs"]), (&json!("press hall"), &json!(3)));
    let ended = server.batch_ended(&id);
    assert_eq!(counts(&ended), json!({"succeeded": 3}));
    assert!(ended["started_at"].is_string() && ended["ended_at"].is_string(), "{ended}");
    let verdicts = ended["verdicts"].as_object().unwrap();
    assert_eq!(verdicts.values().map(|count| count.as_i64().unwrap()).sum::<i64>(), 3);

    let first = json_of(server.get(&format!("{location}/results?limit=2")), 200);
    let next = string(&first, "next");
    let second = json_of(server.get(&format!("{location}/results?limit=2&cursor={next}")), 200);
    assert_eq!(second["next"], Value::Null);
    let rows = [&first["items"][0], &first["items"][1], &second["items"][0]];
    for (place, row) in rows.iter().enumerate() {
        assert_eq!(row["measurement_id"], measurements[place]);
        assert_eq!(
            (&row["file"], &row["state"]),
            (&json!(format!("run {place}.csv")), &json!("succeeded"))
        );
        let result =
            json_of(server.get(&format!("/v1/jobs/{}/result", string(row, "job_id"))), 200);
        assert_eq!((&row["verdict"], &row["tested"]), (&result["verdict"], &json!(true)));
        assert_eq!(row["cause"], result["causes"][0]["effect"]);
        assert_eq!(row["confidence"], result["causes"][0]["confidence"]);
    }
    let jobs = json_of(server.get(&format!("/v1/jobs?batch_id={id}")), 200);
    assert_eq!(jobs["items"].as_array().unwrap().len(), 3);
    assert!(jobs["items"].as_array().unwrap().iter().all(|job| job["batch_id"] == id));
    let listed = json_of(server.get("/v1/batches"), 200);
    assert_eq!(listed, json!({"items": [ended], "next": null}));
}

#[test]
fn a_table_for_a_spreadsheet_has_every_row_and_no_formula() {
    let server = Server::start();
    let path = "/v1/measurements?name=%3DHYPERLINK(1).csv";
    let evil = json_of(server.post(path, &[("content-type", "text/csv")], b"any"), 201);
    let measurements = [server.measurements(1), vec![string(&evil, "id")]].concat();
    let id = string(&server.batch(&measurements, UNUSABLE), "id");
    let ended = server.batch_ended(&id);
    assert_eq!(counts(&ended), json!({"failed": 2}));
    let reason = string(&ended["failures"][0], "reason");
    assert_eq!(ended["failures"], json!([{"reason": reason, "jobs": 2}]));
    let mut answer = server.get(&format!("/v1/batches/{id}/results.csv"));
    assert_eq!(header(&answer, "content-type"), "text/csv; charset=utf-8");
    let text = answer.body_mut().read_to_string().unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(
        lines[0],
        "measurement_id,file,job_id,state,verdict,cause,confidence,problem,tested"
    );
    assert_eq!(lines.len(), 3);
    assert!(lines[1].contains(",run 0.csv,") && lines[1].contains(",failed,,,,"), "{text}");
    assert!(lines[2].contains(",'=HYPERLINK(1).csv,"), "{text}");
    let rows = json_of(server.get(&format!("/v1/batches/{id}/results")), 200);
    assert_eq!(rows["items"][0]["problem"], reason);
}

#[test]
fn a_batch_that_names_what_cannot_be_used_is_refused_whole() {
    let server = Server::start();
    let measurements = server.measurements(2);
    let refused = |more: &str, status| {
        let list = [&measurements[..], &[more.to_owned()]].concat();
        problem(server.submit_batch(&[], &asked(&list, SUCCEED)), status)
    };
    let unknown = refused("nobody", 404);
    assert_eq!(unknown["member"], "measurement_ids[2]");
    assert_eq!(unknown["detail"], "measurement_ids[2]: there is no measurement `nobody`");
    assert_eq!(refused(&measurements[0], 422)["member"], "measurement_ids[2]");
    for (member, value) in [
        ("measurement_ids", json!([])),
        ("kind", json!("divine")),
        ("method", json!("two-magnitude")),
        ("name", json!("x".repeat(201))),
    ] {
        let mut body = asked(&measurements, SUCCEED);
        body[member] = value;
        assert_eq!(problem(server.submit_batch(&[], &body), 422)["member"], member);
    }
    problem(server.submit_batch(&[], &json!({"kind": "identify"})), 422);
    let none = json!({"items": [], "next": null});
    assert_eq!(json_of(server.get("/v1/batches"), 200), none);
    assert_eq!(json_of(server.get("/v1/jobs"), 200), none);
    for path in ["/v1/batches/nobody", "/v1/batches/nobody/results"] {
        problem(server.get(path), 404);
    }
    problem(server.post("/v1/batches/nobody/cancel", &[], b""), 404);
    assert_eq!(server.delete("/v1/batches/nobody"), 404);
}

#[test]
fn a_repeated_batch_is_made_once() {
    let server = Server::start();
    let measurements = server.measurements(2);
    let key = [("idempotency-key", "k")];
    let first = json_of(server.submit_batch(&key, &asked(&measurements, SUCCEED)), 202);
    let again = json_of(server.submit_batch(&key, &asked(&measurements, SUCCEED)), 202);
    assert_eq!(first["id"], again["id"]);
    let other = problem(server.submit_batch(&key, &asked(&measurements[..1], SUCCEED)), 422);
    assert_eq!(other["type"], "urn:servoscope:problem:idempotency-key-reused");
    assert_eq!(json_of(server.get("/v1/jobs"), 200)["items"].as_array().unwrap().len(), 2);
}

#[test]
fn a_batch_is_cancelled_and_a_deleted_job_is_said_to_be_deleted() {
    let server = Server::start();
    let measurements = server.measurements(5);
    let id = string(&server.batch(&measurements, RUN_UNTIL_CANCELLED), "id");
    let path = format!("/v1/batches/{id}");
    let rows = json_of(server.get(&format!("{path}/results")), 200);
    assert_eq!(server.delete(&format!("/v1/jobs/{}", string(&rows["items"][4], "job_id"))), 204);
    assert_eq!(server.delete(&format!("/v1/measurements/{}", measurements[3])), 204);
    for _ in 0..2 {
        json_of(server.post(&format!("{path}/cancel"), &[], b""), 202);
    }
    let ended = server.batch_ended(&id);
    assert_eq!(counts(&ended), json!({"cancelled": 3, "deleted": 2}));
    let deleted = json_of(server.get(&format!("{path}/results?state=deleted")), 200);
    let deleted = deleted["items"].as_array().unwrap();
    let of: Vec<_> = deleted.iter().map(|row| string(row, "measurement_id")).collect();
    assert_eq!(of, measurements[3..]);
    assert!(string(&deleted[0], "problem").contains("deleted"));
    problem(server.get(&format!("{path}/results?state=tired")), 400);
    let metrics = server.get("/metrics").body_mut().read_to_string().unwrap();
    assert!(metrics.contains("outcome=\"cancelled\"} 3\n"), "{metrics}");
}

#[test]
fn a_deleted_batch_takes_its_jobs_with_it_and_leaves_its_measurements() {
    let server = Server::start();
    // More than are deleted in one step.
    let measurements = server.measurements(120);
    let id = string(&server.batch(&measurements, RUN_UNTIL_CANCELLED), "id");
    assert_eq!(server.delete(&format!("/v1/batches/{id}")), 204);
    problem(server.get(&format!("/v1/batches/{id}")), 404);
    let none = json!({"items": [], "next": null});
    assert_eq!(json_of(server.get("/v1/jobs"), 200), none);
    json_of(server.get(&format!("/v1/measurements/{}", measurements[0])), 200);
}

#[test]
fn a_batch_counts_against_the_quota_of_its_key_and_leaves_nothing_where_it_is_too_large() {
    let quotas = Quotas { jobs: Some(3), ..Quotas::default() };
    let server = Server::start_with(Vec::new(), Keeping::new(100), quotas);
    let (id, key) = server.key(&[Scope::Upload, Scope::Run, Scope::Read]);
    let authorization = format!("Bearer {key}");
    let bearer = ("authorization", authorization.as_str());
    let headers = [bearer, ("content-type", "text/csv")];
    let upload = || string(&json_of(server.post("/v1/measurements", &headers, b"any"), 201), "id");
    let measurements: Vec<String> = (0..4).map(|_| upload()).collect();
    let submit =
        |list: &[String]| server.submit_batch(&[bearer], &asked(list, RUN_UNTIL_CANCELLED));
    let never = problem(submit(&measurements), 422);
    assert!(string(&never, "detail").contains("make batches of at most 3"), "{never}");
    json_of(submit(&measurements[..2]), 202);
    let refused = submit(&measurements[2..]);
    assert_eq!(header(&refused, "retry-after"), "30");
    problem(refused, 429);
    let usage = server.runtime.block_on(server.store.usage(&id, Duration::from_secs(60)));
    assert_eq!(usage.unwrap().unfinished, 2);
    let mut listed = server.send("GET", "/v1/batches", &[bearer], b"");
    let listed: Value = serde_json::from_str(&listed.body_mut().read_to_string().unwrap()).unwrap();
    assert_eq!(listed["items"].as_array().unwrap().len(), 1);
}

#[test]
fn a_measurement_that_costs_too_much_is_named() {
    let server = Server::start();
    let measurements = server.measurements(2);
    let strict = server.service.clone().accepting(Duration::from_micros(1));
    let submission = crate::service::BatchSubmission {
        name: None,
        measurement_ids: measurements,
        each: crate::service::Submission { kind: "identify".into(), ..Default::default() },
    };
    let refused = server.runtime.block_on(strict.submit_batch(&submission, None)).unwrap_err();
    let refused = refused.to_string();
    assert!(refused.starts_with("measurement_ids[0]: it would compute about"), "{refused}");
}
