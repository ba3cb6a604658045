//! What one key may store, queue, compute and ask for.

use super::*;

const SCOPES: [Scope; 3] = [Scope::Upload, Scope::Run, Scope::Read];

fn start(quotas: Quotas) -> Server {
    Server::start_with(Vec::new(), Keeping::new(100), quotas)
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
    let server = start(Quotas { measurements: Some(1), ..Quotas::default() });
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
    let server = start(Quotas { mib: Some(1), ..Quotas::default() });
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
    let server = start(Quotas { jobs: Some(2), ..Quotas::default() });
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
fn a_key_computes_so_long_a_day_and_deleting_what_was_computed_gives_nothing_back() {
    let server = start(Quotas { compute_minutes: Some(1), ..Quotas::default() });
    let [(_, one), (_, other)] = [server.key(&SCOPES), server.key(&SCOPES)];
    let measured = |key: &str| string(&json_of(upload(&server, key, "a", b"any"), 201), "id");
    let (measurement, of_other) = (measured(&one), measured(&other));
    let job = string(&json_of(submit(&server, &one, &measurement), 202), "id");
    let path = format!("/v1/jobs/{job}");
    let authorization = format!("Bearer {one}");
    let send = |method: &str| {
        server.send(method, &path, &[("authorization", authorization.as_str())], b"")
    };
    let patience = Instant::now() + Duration::from_secs(60);
    while json_of(send("GET"), 200)["status"] != "running" {
        assert!(Instant::now() < patience, "it never ran");
        std::thread::sleep(Duration::from_millis(10));
    }
    server.database("UPDATE jobs SET started_at_ms = started_at_ms - 61000");
    for _ in 0..2 {
        let refused = submit(&server, &one, &measurement);
        assert_eq!(header(&refused, "retry-after"), "1800");
        let text = detail(refused);
        assert!(text.contains("1 minute in 24 hours (`--key-compute-minutes`)"), "{text}");
        // It ends, and is gone.
        send("DELETE");
    }
    assert_eq!(send("GET").status(), 404);
    json_of(submit(&server, &other, &of_other), 202);
}

#[test]
fn a_key_asks_so_often_and_another_is_not_kept_waiting() {
    let server = start(Quotas { requests_per_minute: Some(3), ..Quotas::default() });
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
    assert!(detail(refused).contains("3 requests a minute"));
    json_of(ask(&other), 200);
}

#[test]
fn what_a_key_may_not_do_counts_as_asked_too() {
    let server = start(Quotas { requests_per_minute: Some(3), ..Quotas::default() });
    let (_, key) = server.key(&[Scope::Read]);
    for _ in 0..3 {
        problem(upload(&server, &key, "a", b"any"), 403);
    }
    assert!(detail(upload(&server, &key, "a", b"any")).contains("3 requests a minute"));
}

#[test]
fn a_key_has_quotas_of_its_own_from_its_start_and_later() {
    let server = start(Quotas { measurements: Some(1), ..Quotas::default() });
    let (_, admin) = server.key(&[Scope::Admin]);
    let authorization = format!("Bearer {admin}");
    let headers = [("authorization", authorization.as_str()), ("content-type", "application/json")];
    let send = |method: &str, path: &str, body: &Value| {
        server.send(method, path, &headers, body.to_string().as_bytes())
    };
    let none = json!({
        "measurements": null, "mib": null, "jobs": null, "compute_minutes": null,
        "requests_per_minute": null,
    });
    let with = |mut quotas: Value, name: &str, most: u32| {
        quotas[name] = json!(most);
        quotas
    };
    let body = json!({"name": "rig", "scopes": SCOPES, "quotas": {"measurements": 2}});
    let added = json_of(send("POST", "/v1/keys", &body), 201);
    assert_eq!(added["quotas"], with(none.clone(), "measurements", 2));
    let (id, key) = (string(&added, "id"), string(&added, "key"));
    json_of(upload(&server, &key, "a", b"any"), 201);
    let measurement = string(&json_of(upload(&server, &key, "b", b"more"), 201), "id");
    let text = detail(upload(&server, &key, "c", b"even more"));
    assert!(text.contains("2 measurements (set for this key)"), "{text}");

    let path = format!("/v1/keys/{id}/quotas");
    let limited = json_of(send("PUT", &path, &json!({"jobs": 1})), 200);
    assert_eq!(limited["quotas"], with(none.clone(), "jobs", 1));
    let text = detail(upload(&server, &key, "c", b"even more"));
    assert!(text.contains("1 measurement (`--key-measurements`)"), "{text}");
    json_of(submit(&server, &key, &measurement), 202);
    let text = detail(submit(&server, &key, &measurement));
    assert!(text.contains("1 job that waits or runs (set for this key)"), "{text}");
    json_of(send("PUT", &path, &json!({"requests_per_minute": 1})), 200);
    upload(&server, &key, "a", b"any");
    assert!(detail(upload(&server, &key, "a", b"any")).contains("1 request a minute (set for"));
    assert_eq!(json_of(send("PUT", &path, &json!({})), 200)["quotas"], none);
    json_of(upload(&server, &key, "a", b"any"), 201);

    for wrong in [json!({"jobs": 0}), json!({"jobs": 1_000_000_001})] {
        assert_eq!(problem(send("PUT", &path, &wrong), 422)["member"], "quotas.jobs");
        let body = json!({"name": "rig", "scopes": SCOPES, "quotas": wrong});
        assert_eq!(problem(send("POST", "/v1/keys", &body), 422)["member"], "quotas.jobs");
    }
    problem(send("PUT", &path, &json!({"cores": 1})), 422);
    problem(send("PUT", "/v1/keys/nobody/quotas", &json!({})), 404);
}

#[test]
fn the_unfinished_bodies_of_a_key_leave_memory_for_those_of_others() {
    use std::io::Write;

    let server = start(Quotas::default());
    let [(_, flood), (_, rig)] = [server.key(&SCOPES), server.key(&SCOPES)];
    let host = server.address.trim_start_matches("http://");
    let begin = || {
        let mut stream = std::net::TcpStream::connect(host).unwrap();
        let head = format!(
            "POST /v1/measurements HTTP/1.1\r\nhost: localhost\r\ncontent-type: text/csv\r\n\
             authorization: Bearer {flood}\r\ncontent-length: 9000\r\n\r\n"
        );
        stream.write_all(head.as_bytes()).unwrap();
        stream.write_all(&[b'x'; 8000]).unwrap();
        stream
    };
    // More than half of the memory, which is 64 of the pieces of which each of these takes one.
    let mut held: Vec<_> = (0..40).map(|_| begin()).collect();
    let deadline = Instant::now() + Duration::from_secs(30);
    let refused = loop {
        let answer = upload(&server, &flood, "a", b"any");
        if answer.status() == 503 || Instant::now() > deadline {
            break answer;
        }
        // What was just tried may have taken the piece of one that was then refused.
        held.push(begin());
        std::thread::sleep(Duration::from_millis(20));
    };
    assert!(string(&problem(refused, 503), "detail").contains("one key"));
    json_of(upload(&server, &rig, "a", b"any"), 201);
}
