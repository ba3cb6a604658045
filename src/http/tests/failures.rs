//! What a computation that goes wrong leaves of everything else.

use crate::service::testing::PANIC;

use super::*;

#[test]
fn neither_a_foreign_name_nor_a_foreign_page_gets_through() {
    let server = Server::start();
    let table = b"magnitude,omega_rad_s,re,im\n1,2,0.5,-0.2\n";
    let rebound = server.post("/v1/measurements", &[("Host", "evil.example")], table);
    assert!(string(&problem(rebound, 421), "detail").contains("`--host evil.example`"));
    let foreign = [("Origin", "https://evil.example"), ("Sec-Fetch-Site", "cross-site")];
    let refused = problem(server.post("/v1/measurements", &foreign, table), 403);
    assert!(string(&refused, "detail").contains("`--cors-origin https://evil.example`"));
    let none = json_of(server.get("/v1/measurements"), 200);
    assert_eq!(none["items"], json!([]));
}

#[test]
fn the_character_nul_is_refused_wherever_it_comes_and_not_the_words_for_it() {
    let server = Server::start();
    let measurement = format!("/v1/measurements/{}", server.measurement());
    for path in ["/v1/jobs/%00", "/v1/jobs?text=%00", "/v1/mappings/a%00b", "/v1/axes?machine=a%00"]
    {
        let refused = problem(server.get(path), 400);
        assert!(string(&refused, "detail").contains("the character NUL"), "{path}: {refused}");
    }
    let csv = [("content-type", "text/csv")];
    problem(server.post("/v1/measurements?name=%00", &csv, b"any"), 400);
    for nul in [json!({"name": "a\0b"}), json!({"labels": {"site\0": "north"}})] {
        let refused = problem(server.patch(&measurement, &nul), 422);
        assert!(string(&refused, "detail").contains("the character NUL"), "{refused}");
    }
    // A percent sign with two noughts behind it, and the escape as a text.
    problem(server.get("/v1/jobs/%2500"), 404);
    let named = json_of(server.patch(&measurement, &json!({"name": "\\u0000 %00"})), 200);
    assert_eq!(named["name"], "\\u0000 %00");
}

#[test]
fn an_error_of_the_database_says_nothing_of_what_is_in_it() {
    let server = Server::start();
    let measurement = server.measurement();
    let folder = server.directory.path().to_str().unwrap().to_lowercase();
    server.database("PRAGMA foreign_keys = OFF; DROP TABLE measurement_files; DROP TABLE jobs");
    let body = json!({"measurement_id": measurement, "kind": "identify"}).to_string();
    let headers = [("content-type", "application/json")];
    let table = [("content-type", "text/csv")];
    for answer in [
        server.get("/v1/jobs"),
        server.get(&format!("/v1/measurements/{measurement}")),
        server.get(&format!("/v1/measurements/{measurement}/data.csv")),
        server.get("/v1/results.json"),
        server.post("/v1/jobs", &headers, body.as_bytes()),
        server.post("/v1/measurements", &table, b"any"),
        server.send("DELETE", &format!("/v1/measurements/{measurement}"), &[], b""),
    ] {
        let said = problem(answer, 503);
        assert_eq!(said["title"], "Internal error");
        assert!(uuid::Uuid::try_parse(&string(&said, "reference")).is_ok(), "{said}");
        let text = said.to_string().to_lowercase();
        for inner in [
            "measurement_files",
            "jobs",
            "no such table",
            "select",
            "insert",
            "sql",
            "code",
            &folder,
        ] {
            assert!(!text.contains(inner), "{inner}: {text}");
        }
    }
}

#[test]
fn a_panic_in_a_fit_fails_that_job_with_a_reference_and_nothing_else() {
    let server = Server::start();
    let beside = server.job(RUN_UNTIL_CANCELLED);
    let bad = server.job(PANIC);
    let failed = server.ended(&bad);
    assert_eq!(failed["status"], "failed");
    let reference = string(&failed["failure"], "reference");
    assert!(uuid::Uuid::try_parse(&reference).is_ok(), "{reference}");
    let reason = string(&failed["failure"], "reason");
    assert!(reason.contains("report the reference"), "{reason}");
    assert!(!failed.to_string().contains("scripted"), "what it panicked with is for the log");
    let result = problem(server.get(&format!("/v1/jobs/{bad}/result")), 404);
    assert!(string(&result, "detail").contains("internal error"), "{result}");

    let still = json_of(server.get(&format!("/v1/jobs/{beside}")), 200);
    assert_eq!(still["status"], "running");
    // The place that it had is free: the other one is taken.
    let next = server.job(SUCCEED);
    assert_eq!(server.ended(&next)["status"], "succeeded");
    assert_eq!(server.get("/readyz").status(), 200);
    let metrics = server.get("/metrics").body_mut().read_to_string().unwrap();
    assert!(metrics.contains("{kind=\"identify\",outcome=\"failed\"} 1\n"), "{metrics}");
    json_of(server.post(&format!("/v1/jobs/{beside}/cancel"), &[], b""), 202);
}
