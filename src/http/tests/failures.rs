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
