//! Deleting, exporting, caching, and what an operator looks at.

use super::*;

#[test]
fn a_deleted_measurement_is_gone_with_its_jobs_and_its_key() {
    let server = Server::start();
    let csv = [("content-type", "text/csv"), ("idempotency-key", "k")];
    let added = json_of(server.post("/v1/measurements", &csv, b"any"), 201);
    let path = format!("/v1/measurements/{}", string(&added, "id"));
    let body = json!({
        "measurement_id": added["id"], "kind": "identify",
        "options": {"seed": RUN_UNTIL_CANCELLED},
    });
    let job = format!("/v1/jobs/{}", string(&json_of(server.submit(&body), 202), "id"));
    assert_eq!(server.delete(&path), 204);
    problem(server.get(&path), 404);
    problem(server.get(&job), 404);
    assert_eq!(server.delete(&path), 404);
    let again = json_of(server.post("/v1/measurements", &csv, b"any"), 201);
    assert_ne!(again["id"], added["id"]);
    // The worker lets go of the job that it has lost.
    let mut ids = vec![server.job(SUCCEED), server.job(SUCCEED), server.job(SUCCEED)];
    ids.retain(|id| server.ended(id)["status"] == "succeeded");
    assert_eq!(ids.len(), 3);
    assert_eq!(server.delete(&format!("/v1/jobs/{}", ids[0])), 204);
    problem(server.get(&format!("/v1/jobs/{}/result", ids[0])), 404);
}

#[test]
fn lists_are_filtered_by_machine_axis_label_state_and_time() {
    let server = Server::start();
    let id = server.job(SUCCEED);
    server.ended(&id);
    let count =
        |path: &str| json_of(server.get(path), 200)["items"].as_array().expect("a list").len();
    for (query, expected) in [
        ("machine=press%204", 1),
        ("machine=press%205", 0),
        ("axis=z", 0),
        ("label=site:north", 1),
        ("label=site:south", 0),
        ("label=site:north&label=shift:night", 0),
        ("since=2020-01-01T00:00:00Z&until=2120-01-01T00:00:00%2B01:00", 1),
        ("since=2120-01-01T00:00:00Z", 0),
        ("until=2020-01-01T00:00:00Z", 0),
    ] {
        assert_eq!(count(&format!("/v1/measurements?{query}")), expected, "{query}");
        assert_eq!(count(&format!("/v1/jobs?{query}")), expected, "jobs: {query}");
    }
    assert_eq!(count("/v1/measurements?measured_since=2020-01-01T00:00:00Z"), 0, "it does not say");
    assert_eq!(count("/v1/jobs?status=succeeded&kind=identify"), 1);
    assert_eq!(count("/v1/jobs?kind=diagnose"), 0);
    problem(server.get("/v1/jobs?since=yesterday"), 400);
    problem(server.get("/v1/measurements?label=north"), 400);
}

#[test]
fn results_and_tables_have_tags_and_are_sent_once() {
    let server = Server::start();
    let id = server.job(SUCCEED);
    server.ended(&id);
    let measurement =
        string(&json_of(server.get(&format!("/v1/jobs/{id}")), 200), "measurement_id");
    for (path, begins) in [
        (format!("/v1/jobs/{id}/result"), "{\"method\":"),
        (format!("/v1/jobs/{id}/parameters.csv"), "model,parameter,value,std,low95,high95,unit\n"),
        (format!("/v1/jobs/{id}/comparison.csv"), "experiment,magnitude [A],omega [rad/s],run,"),
        (format!("/v1/measurements/{measurement}/data.csv"), "# machine: press 4\n"),
        (format!("/v1/measurements/{measurement}/data.json"), "{\"metadata\":{\"machine\":"),
    ] {
        let mut first = server.get(&path);
        let tag = header(&first, "etag").to_owned();
        let text = first.body_mut().read_to_string().unwrap();
        assert!(text.starts_with(begins), "{path}: {text}");
        let again = server.agent.get(format!("{}{path}", server.address));
        let again = again.header("if-none-match", tag.as_str()).call().unwrap();
        assert_eq!(again.status(), 304, "{path}");
    }
    let running = server.job(RUN_UNTIL_CANCELLED);
    problem(server.get(&format!("/v1/jobs/{running}/parameters.csv")), 409);
    json_of(server.post(&format!("/v1/jobs/{running}/cancel"), &[], b""), 202);
}

#[test]
fn pages_from_elsewhere_may_use_it_only_where_that_was_said() {
    let from = |server: &Server, origin: &str| {
        let request = server.agent.get(format!("{}/livez", server.address));
        let answer = request.header("origin", origin).call().unwrap();
        header(&answer, "access-control-allow-origin").to_owned()
    };
    let closed = Server::start();
    assert_eq!(from(&closed, "https://bench.example"), "");
    let open = Server::start_for(vec!["https://bench.example".parse().unwrap()]);
    assert_eq!(from(&open, "https://bench.example"), "https://bench.example");
    assert_eq!(from(&open, "https://evil.example"), "");
}

#[test]
fn the_metrics_count_jobs_and_requests() {
    let server = Server::start();
    let id = server.job(SUCCEED);
    server.ended(&id);
    let invented = ureq::http::Request::builder().method("DIVINE");
    let invented = invented.uri(format!("{}/livez", server.address)).body(()).unwrap();
    let request = server.agent.configure_request(invented).allow_non_standard_methods(true);
    problem(server.agent.run(request.build()).unwrap(), 405);
    let mut answer = server.get("/metrics");
    assert!(header(&answer, "content-type").starts_with("application/openmetrics-text"));
    let text = answer.body_mut().read_to_string().unwrap();
    for part in [
        "servoscope_jobs_queued 0\n",
        "servoscope_jobs_ended_total{kind=\"identify\",outcome=\"succeeded\"} 1\n",
        "route=\"/v1/jobs/{id}\",status=\"200\"",
        "servoscope_evaluations_total{kind=\"identify\"}",
        "method=\"other\",route=\"/livez\",status=\"405\"",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    assert!(!text.contains("DIVINE"), "{text}");
}

#[test]
fn the_documents_need_nothing_from_outside() {
    let server = Server::start();
    let mut page = server.get("/docs/");
    assert_eq!(page.status(), 200);
    let page = page.body_mut().read_to_string().unwrap();
    assert!(!page.contains("http://") && !page.contains("https://"), "{page}");
    let files =
        page.split(['"', '\'']).filter(|part| part.ends_with(".js") || part.ends_with(".css"));
    let mut count = 0;
    for file in files {
        let path = format!("/docs/{}", file.trim_start_matches("./"));
        assert_eq!(server.get(&path).status(), 200, "{path}");
        count += 1;
    }
    assert!(count >= 3, "{page}");
    let script = server.get("/docs/swagger-initializer.js").body_mut().read_to_string().unwrap();
    assert!(script.contains("/openapi.json") && !script.contains("petstore"), "{script}");
}

#[test]
fn json_that_is_nested_too_deeply_is_refused() {
    let server = Server::start();
    let deep = |depth: usize| format!("{}{}", "[".repeat(depth), "]".repeat(depth));
    let headers = [("content-type", "application/json")];
    let body = format!("{{\"measurement_id\": \"a\", \"options\": {}}}", deep(4000));
    problem(server.post("/v1/jobs", &headers, body.as_bytes()), 422);
    problem(server.post("/v1/jobs", &headers, deep(4000).as_bytes()), 422);
}

#[test]
fn options_that_make_a_job_endless_are_refused() {
    let server = Server::start();
    let options = json!({"colony": {"food_sources": 1000, "cycles": 10_000}});
    let body = json!({
        "measurement_id": server.measurement(), "kind": "identify", "options": options,
    });
    let refused = problem(server.submit(&body), 422);
    assert!(string(&refused, "detail").contains("food_sources × colony.cycles"), "{refused}");
}

#[test]
fn a_measurement_is_renamed_and_its_data_stays() {
    let server = Server::start();
    let csv = [("content-type", "text/csv")];
    let added = json_of(server.post("/v1/measurements", &csv, b"any"), 201);
    let path = format!("/v1/measurements/{}", string(&added, "id"));
    let change = json!({
        "name": "before the repair", "axis": "", "measured_at": "2026-03-04T10:20:00Z",
        "labels": {"shift": "night"},
    });
    let changed = json_of(server.patch(&path, &change), 200);
    assert_eq!(changed["name"], "before the repair");
    assert_eq!(changed["machine"], "press 4", "what is left out stays");
    assert_eq!(changed["axis"], Value::Null);
    assert_eq!(changed["labels"], json!({"shift": "night"}));
    for same in ["id", "sha256", "response", "magnitude_range"] {
        assert_eq!(changed[same], added[same], "{same}");
    }
    let mut export = server.get(&format!("{path}/data.csv"));
    let text = export.body_mut().read_to_string().unwrap();
    assert!(text.contains("# name: before the repair\n") && !text.contains("# axis:"), "{text}");
    let found = |query: &str| {
        let list = json_of(server.get(&format!("/v1/measurements?{query}")), 200);
        list["items"].as_array().unwrap().len()
    };
    assert_eq!(found("text=REPAIR"), 1);
    assert_eq!(found("text=axis%20x"), 0);
    assert_eq!(found(&format!("sha256={}", string(&added, "sha256"))), 1);

    let refused = problem(server.patch(&path, &json!({"measured_at": "yesterday"})), 422);
    assert_eq!(refused["member"], "measured_at");
    let many: std::collections::BTreeMap<String, &str> =
        (0..101).map(|label| (label.to_string(), "x")).collect();
    let refused = problem(server.patch(&path, &json!({"labels": many})), 422);
    assert!(string(&refused, "detail").contains("more than 100 labels"), "{refused}");
    let refused = problem(server.patch(&path, &json!({"response": "position mm"})), 422);
    assert!(string(&refused, "detail").contains("response"), "{refused}");
    problem(server.patch("/v1/measurements/nobody", &json!({"name": "x"})), 404);
}

#[test]
fn jobs_are_found_by_verdict_and_by_text() {
    let server = Server::start();
    let id = server.job(SUCCEED);
    server.ended(&id);
    let found = |query: &str| {
        json_of(server.get(&format!("/v1/jobs?{query}")), 200)["items"].as_array().unwrap().len()
    };
    assert_eq!(found("text=press"), 1);
    assert_eq!(found("text=lathe"), 0);
    assert_eq!(found("verdict=explained"), 0, "an identification has no verdict");
    let body = json!({"measurement_id": json_of(server.get(&format!("/v1/jobs/{id}")), 200)["measurement_id"],
        "kind": "diagnose", "options": {"seed": SUCCEED}});
    let diagnosis = string(&json_of(server.submit(&body), 202), "id");
    server.ended(&diagnosis);
    let result = json_of(server.get(&format!("/v1/jobs/{diagnosis}/result")), 200);
    assert_eq!(found(&format!("verdict={}", string(&result, "verdict"))), 1);
    problem(server.get("/v1/jobs?verdict=bad"), 400);
}

#[test]
fn a_browser_that_asks_for_an_unknown_page_gets_a_page_and_a_program_a_problem() {
    let server = Server::start();
    let accepting = |path: &str, accept: &str| {
        let request = server.agent.get(format!("{}{path}", server.address));
        request.header("accept", accept).call().unwrap()
    };
    let browser = "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8";
    let mut page = accepting("/no/such/page", browser);
    assert_eq!(page.status(), 404);
    assert_eq!(header(&page, "content-type"), "text/html; charset=utf-8");
    assert!(header(&page, "content-security-policy").contains("default-src 'none'"));
    assert!(page.body_mut().read_to_string().unwrap().contains("<main"));
    for (path, accept) in [
        ("/no/such/page", "application/json"),
        ("/no/such/page", "*/*"),
        ("/v1/jobs/nobody", browser),
        ("/assets/none.js", browser),
    ] {
        problem(accepting(path, accept), 404);
    }
}
