//! Requests that are refused, each with a problem document.

use axum::http::header::RETRY_AFTER;
use axum::response::IntoResponse as _;

use super::*;
use crate::http::problem::Problem;
use crate::service::ServiceError;
use crate::store::StoreError;

#[test]
fn malformed_json_is_refused_with_line_and_column() {
    let server = Server::start();
    let headers = [("content-type", "application/json")];
    let answer = problem(server.post("/v1/jobs", &headers, b"{\n  \"kind\": oops}"), 400);
    assert_eq!((&answer["line"], &answer["column"]), (&json!(2), &json!(11)));
    problem(server.post("/v1/jobs", &headers, b""), 400);
    problem(server.post("/v1/jobs", &headers, b"{} {}"), 400);
    for body in [&b"[\"a\", \"identify\", null, null, null, null]"[..], b"\"a\"", b"null"] {
        let answer = problem(server.post("/v1/jobs", &headers, body), 422);
        assert!(string(&answer, "detail").contains("not an object"), "{answer}");
    }
    problem(server.post("/v1/jobs", &[("content-type", "text/plain")], b"{}"), 415);
    for path in ["/v1/measurements", "/v1/jobs"] {
        let answer = problem(server.post(path, &[], b"any"), 415);
        assert!(string(&answer, "detail").contains("`Content-Type`"), "{answer}");
    }
    let headers = [("content-type", "text/csv"), ("content-encoding", "br")];
    let answer = problem(server.post("/v1/measurements", &headers, b"any"), 415);
    assert!(string(&answer, "detail").contains("only gzip"), "{answer}");
}

#[test]
fn every_other_error_is_a_problem_document_too() {
    let server = Server::start();
    assert!(string(&problem(server.get("/v2"), 404), "detail").contains("/openapi.json"));
    let not_allowed = server.post("/livez", &[], b"");
    assert_eq!(header(&not_allowed, "allow"), "GET,HEAD");
    assert!(string(&problem(not_allowed, 405), "detail").contains("does not answer POST"));
    problem(server.get("/v1/jobs/nobody"), 404);
    problem(server.get("/v1/jobs/nobody/result"), 404);
    problem(server.get("/v1/jobs/nobody/convergence.csv"), 404);
    problem(server.get("/v1/measurements/nobody"), 404);
    problem(server.post("/v1/jobs/nobody/cancel", &[], b""), 404);
    problem(server.get("/v1/jobs?colour=red"), 400);
    problem(server.get("/v1/jobs?status=tired"), 400);
    for (query, member) in [("limit=0", "limit"), ("cursor=there", "cursor")] {
        let answer = problem(server.get(&format!("/v1/jobs?{query}")), 422);
        assert_eq!(string(&answer, "member"), member);
    }
    let long_key = "k".repeat(256);
    let headers = [("content-type", "text/csv"), ("idempotency-key", long_key.as_str())];
    problem(server.post("/v1/measurements", &headers, b"any"), 400);
}

#[test]
fn a_request_that_the_database_does_not_answer_in_time_may_be_sent_again() {
    let silent: Box<Problem> = ServiceError::Store(StoreError::Silent).into();
    let answer = silent.into_response();
    assert_eq!(answer.status(), 503);
    assert_eq!(answer.headers()[RETRY_AFTER], "5");
}
