//! Browsers that are signed in with a key.

use super::*;

fn sign_in(server: &Server, key: &str, headers: &[(&str, &str)]) -> Response<Body> {
    let body = json!({"key": key}).to_string();
    let headers = [&[("content-type", "application/json")], headers].concat();
    server.post("/v1/session", &headers, body.as_bytes())
}

/// Name and value of the cookie that an answer sets.
fn cookie(answer: &Response<Body>) -> String {
    header(answer, "set-cookie").split(';').next().unwrap().to_owned()
}

#[test]
fn a_browser_signs_in_with_a_key_and_out_again() {
    let server = Server::start();
    let (id, key) = server.key(&[Scope::Read]);
    let answer = sign_in(&server, &key, &[("origin", &server.address)]);
    let set = header(&answer, "set-cookie").to_owned();
    assert!(set.ends_with("; Path=/; Max-Age=43200; HttpOnly; SameSite=Strict"), "{set}");
    let session = cookie(&answer);
    assert!(!session.contains(&key[30..]), "{session}");
    assert_eq!(json_of(answer, 200)["key"]["id"], id.as_str());

    let with = |path: &str| server.send("GET", path, &[("cookie", &session)], b"");
    assert_eq!(with("/v1/jobs").status(), 200);
    assert_eq!(json_of(with("/v1/session"), 200)["key"]["name"], "rig");
    problem(with("/v1/keys"), 403);

    let own = [("cookie", session.as_str()), ("sec-fetch-site", "same-origin")];
    let answer = server.send("DELETE", "/v1/session", &own, b"");
    assert_eq!(answer.status(), 204);
    assert!(header(&answer, "set-cookie").starts_with("servoscope_session=; Path=/; Max-Age=0;"));
    let ended = problem(with("/v1/jobs"), 401);
    assert!(string(&ended, "detail").contains("session has ended"), "{ended}");

    let refused = problem(sign_in(&server, "sk_servoscope_wrong", &[]), 401);
    assert!(string(&refused, "detail").contains("not known"), "{refused}");
}

#[test]
fn behind_https_the_cookie_is_for_https_alone() {
    let server = Server::start();
    let (_, key) = server.key(&[Scope::Read]);
    let answer = sign_in(&server, &key, &[("x-forwarded-proto", "https")]);
    assert!(header(&answer, "set-cookie").ends_with("; SameSite=Strict; Secure"));
}

#[test]
fn a_session_ends_with_its_key() {
    let server = Server::start();
    let (id, key) = server.key(&[Scope::Read]);
    let sessions = || cookie(&sign_in(&server, &key, &[]));
    let (first, second) = (sessions(), sessions());
    assert_ne!(first, second);
    server.runtime.block_on(server.service.rotate_key(&id)).unwrap();
    let with = |session: &str| server.send("GET", "/v1/jobs", &[("cookie", session)], b"");
    problem(with(&first), 401);
    problem(with(&second), 401);
    let (_, token) = server.runtime.block_on(server.service.rotate_key(&id)).unwrap();
    let third = cookie(&sign_in(&server, &token.text(), &[]));
    assert_eq!(with(&third).status(), 200);
    server.runtime.block_on(server.service.revoke_key(&id)).unwrap();
    problem(with(&third), 401);
}

#[test]
fn a_change_with_a_session_must_come_from_the_servers_own_page() {
    let server = Server::start();
    let (_, key) = server.key(&[Scope::Upload, Scope::Read]);
    let session = cookie(&sign_in(&server, &key, &[]));
    let upload = |more: &[(&str, &str)]| {
        let headers = [("cookie", session.as_str()), ("content-type", "text/csv")];
        server.post("/v1/measurements", &[&headers, more].concat(), b"any")
    };
    let refused = problem(upload(&[]), 403);
    assert!(string(&refused, "detail").contains("`Sec-Fetch-Site`"), "{refused}");
    problem(upload(&[("origin", "https://evil.example")]), 403);
    problem(upload(&[("sec-fetch-site", "cross-site")]), 403);
    problem(upload(&[("origin", "null")]), 403);
    assert_eq!(upload(&[("origin", &server.address)]).status(), 201);
    assert_eq!(upload(&[("sec-fetch-site", "same-origin")]).status(), 201);
    // A program with the key needs none of it.
    let authorization = format!("Bearer {key}");
    assert_eq!(upload(&[("authorization", &authorization)]).status(), 201);
}

#[test]
fn a_signed_in_browser_follows_a_job() {
    let server = Server::start();
    let (_, key) = server.key(&[Scope::Admin]);
    let session = cookie(&sign_in(&server, &key, &[]));
    let own = [("cookie", session.as_str()), ("sec-fetch-site", "same-origin")];
    let csv = [own[0], own[1], ("content-type", "text/csv")];
    let measurement = json_of(server.post("/v1/measurements", &csv, b"any"), 201);
    let body = json!({"measurement_id": measurement["id"], "kind": "identify"}).to_string();
    let json = [own[0], own[1], ("content-type", "application/json")];
    let job = string(&json_of(server.post("/v1/jobs", &json, body.as_bytes()), 202), "id");
    let path = format!("/v1/jobs/{job}/events");
    problem(server.get(&path), 401);
    let mut stream = server.send("GET", &path, &own[..1], b"");
    assert_eq!(stream.status(), 200);
    assert!(stream.body_mut().read_to_string().unwrap().contains("event: end"));
}

#[test]
fn a_browser_that_signs_in_again_ends_its_session_and_a_key_has_twenty() {
    let server = Server::start();
    let (_, key) = server.key(&[Scope::Read]);
    let signed_in = |headers: &[(&str, &str)]| cookie(&sign_in(&server, &key, headers));
    let status = |session: &str| {
        let answer = server.send("GET", "/v1/jobs", &[("cookie", session)], b"");
        answer.status().as_u16()
    };
    let first = signed_in(&[]);
    let again = signed_in(&[("cookie", &first)]);
    assert_eq!((status(&first), status(&again)), (401, 200));
    // A key that is not known ends nothing.
    let own = [("cookie", again.as_str())];
    problem(sign_in(&server, "sk_servoscope_wrong", &own), 401);
    assert_eq!(status(&again), 200);

    let mut sessions = vec![again];
    while sessions.len() < 20 {
        sessions.push(signed_in(&[]));
        // Times are kept in milliseconds, and the one that was first ends first.
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(sessions.iter().all(|session| status(session) == 200));
    sessions.push(signed_in(&[]));
    let valid = sessions.iter().map(|session| status(session)).collect::<Vec<_>>();
    assert_eq!((valid[0], &valid[1..]), (401, &[200; 20][..]));
}

#[test]
fn a_browser_signs_in_with_a_small_body_and_not_all_the_time() {
    let server = Server::start();
    let large = sign_in(&server, &"k".repeat(5000), &[]);
    assert!(string(&problem(large, 413), "detail").contains("4096 bytes"));
    let mut answered = 0;
    let refused = loop {
        let answer = sign_in(&server, "sk_servoscope_wrong", &[]);
        if answer.status() != 401 || answered > 1000 {
            break answer;
        }
        answered += 1;
    };
    let wait_s: u64 = header(&refused, "retry-after").parse().unwrap();
    assert_eq!(wait_s, 1);
    let text = string(&problem(refused, 429), "detail");
    assert!(text.contains("60 sign-ins a minute"), "{text}");
    // The large one was counted, too.
    assert!(answered >= 59, "{answered}");
}
