//! What one key may store, queue, compute and ask for.

use super::*;

const SCOPES: [Scope; 3] = [Scope::Upload, Scope::Run, Scope::Read];

fn start(quotas: Quotas, key_requests_per_minute: Option<usize>) -> Server {
    Server::start_with(Vec::new(), Keeping::new(100), quotas, key_requests_per_minute)
}

fn upload(server: &Server, key: &str, idempotency_key: &str, body: &[u8]) -> Response<Body> {
    let authorization = format!("Bearer {key}");
    let headers = [
        ("authorization", authorization.as_str()),
        ("content-type", "text/csv"),
        ("idempotency-key", idempotency_key),
    ];
    server.post("/v1/measurements", &headers, body)
}

fn submit(server: &Server, key: &str, measurement: &str) -> Response<Body> {
    let authorization = format!("Bearer {key}");
    let headers = [("authorization", authorization.as_str()), ("content-type", "application/json")];
    let body = json!({
        "measurement_id": measurement, "kind": "identify",
        "options": {"seed": RUN_UNTIL_CANCELLED},
    });
    server.post("/v1/jobs", &headers, body.to_string().as_bytes())
}

fn detail(answer: Response<Body>) -> String {
    let problem = problem(answer, 429);
    assert_eq!(problem["type"], "urn:servoscope:problem:over-quota");
    string(&problem, "detail")
}

#[test]
fn a_key_keeps_so_many_measurements_and_a_repeated_upload_is_answered_also_then() {
    let server = start(Quotas { measurements: Some(1), ..Quotas::default() }, None);
    let [(id, one), (_, other)] = [server.key(&SCOPES), server.key(&SCOPES)];
    let first = json_of(upload(&server, &one, "a", b"any"), 201);
    let refused = upload(&server, &one, "b", b"more");
    assert!(refused.headers().get("retry-after").is_none(), "waiting does not help");
    let text = detail(refused);
    assert!(text.contains("1 measurement (`--key-measurements`)") && text.contains("delete"));
    assert_eq!(json_of(upload(&server, &one, "a", b"any"), 201), first);
    json_of(upload(&server, &other, "a", b"any"), 201);

    // What was refused left nothing behind, its idempotency key neither.
    let kept = server.runtime.block_on(server.store.usage(&id, Duration::from_secs(60)));
    assert_eq!(kept.unwrap().measurements, 1);
    let path = format!("/v1/measurements/{}", string(&first, "id"));
    let authorization = format!("Bearer {one}");
    let headers = [("authorization", authorization.as_str())];
    assert_eq!(server.send("DELETE", &path, &headers, b"").status(), 204);
    json_of(upload(&server, &one, "b", b"more"), 201);
}

#[test]
fn a_key_keeps_so_many_mebibytes() {
    let server = start(Quotas { mebibytes: Some(1), ..Quotas::default() }, None);
    let (id, key) = server.key(&SCOPES);
    for count in 0..3 {
        json_of(upload(&server, &key, &count.to_string(), &[b'x'; 3000]), 201);
    }
    let last = Duration::from_secs(60);
    let usage = server.runtime.block_on(server.store.usage(&id, last)).unwrap();
    assert_eq!((usage.measurements, usage.bytes), (3, 9000));
}

#[test]
fn a_key_has_so_many_jobs_that_wait_or_run() {
    let server = start(Quotas { jobs: Some(2), ..Quotas::default() }, None);
    let (id, key) = server.key(&SCOPES);
    let measurement = string(&json_of(upload(&server, &key, "a", b"any"), 201), "id");
    for _ in 0..2 {
        json_of(submit(&server, &key, &measurement), 202);
    }
    let refused = submit(&server, &key, &measurement);
    assert_eq!(header(&refused, "retry-after"), "30");
    assert!(detail(refused).contains("2 jobs that wait or run (`--key-jobs`)"));
    let usage = server.runtime.block_on(server.store.usage(&id, Duration::from_secs(60)));
    assert_eq!(usage.unwrap().unfinished, 2);
}

#[test]
fn a_key_asks_so_often_and_another_is_not_kept_waiting() {
    let server = start(Quotas::default(), Some(3));
    let [(_, one), (_, other)] = [server.key(&SCOPES), server.key(&SCOPES)];
    let ask = |key: &str| {
        let authorization = format!("Bearer {key}");
        server.send("GET", "/v1/jobs", &[("authorization", authorization.as_str())], b"")
    };
    for _ in 0..3 {
        json_of(ask(&one), 200);
    }
    let refused = ask(&one);
    let wait_s: u64 = header(&refused, "retry-after").parse().unwrap();
    assert!((1..=20).contains(&wait_s), "a token comes back in 20 s: {wait_s}");
    assert!(detail(refused).contains("3 times a minute"));
    json_of(ask(&other), 200);
}
