//! The dashboard's files.

use super::*;

#[test]
fn the_page_is_at_each_of_its_addresses_and_may_use_this_server_alone() {
    let server = Server::start();
    for path in ["/", "/jobs/some-id", "/measurements/some-id", "/compare?a=1&b=2", "/axes"] {
        let mut page = server.get(path);
        assert_eq!(page.status(), 200, "{path}");
        assert_eq!(header(&page, "content-type"), "text/html; charset=utf-8");
        let policy = header(&page, "content-security-policy").to_owned();
        assert!(policy.starts_with("default-src 'none'; script-src 'self'; style-src 'self';"));
        assert!(!policy.contains("unsafe"), "{policy}");
        assert!(page.body_mut().read_to_string().unwrap().contains("/assets/main.js"));
    }
    problem(server.get("/elsewhere"), 404);
}

#[test]
fn a_file_is_asked_for_again_and_sent_once() {
    let server = Server::start();
    let script = server.get("/assets/main.js");
    assert_eq!(header(&script, "content-type"), "text/javascript; charset=utf-8");
    assert_eq!(header(&script, "cache-control"), "no-cache");
    let tag = header(&script, "etag").to_owned();
    let again = server.agent.get(format!("{}/assets/main.js", server.address));
    assert_eq!(again.header("if-none-match", tag).call().unwrap().status(), 304);
    assert_eq!(
        header(&server.get("/assets/shared.css"), "content-type"),
        "text/css; charset=utf-8"
    );
    problem(server.get("/assets/nothing.js"), 404);
}

#[test]
fn a_page_that_is_kept_may_use_what_it_could_at_first() {
    let server = Server::start();
    let page = server.get("/axes");
    let policy = header(&page, "content-security-policy").to_owned();
    let again = server.agent.get(format!("{}/axes", server.address));
    let kept = again.header("if-none-match", header(&page, "etag")).call().unwrap();
    assert_eq!((kept.status().as_u16(), header(&kept, "content-security-policy")), (304, &*policy));
}

#[test]
fn every_answer_says_what_a_browser_may_make_of_it() {
    let server = Server::start();
    let job = server.job(SUCCEED);
    server.ended(&job);
    for path in [
        "/",
        "/assets/main.js",
        "/docs/",
        "/livez",
        "/v1/jobs",
        "/v1/nothing",
        "/v1/jobs?limit=none",
        &format!("/v1/jobs/{job}/result"),
        &format!("/v1/jobs/{job}/convergence.csv"),
    ] {
        let answer = server.get(path);
        assert_eq!(header(&answer, "x-content-type-options"), "nosniff", "{path}");
        assert_eq!(header(&answer, "x-frame-options"), "DENY", "{path}");
        assert_eq!(header(&answer, "referrer-policy"), "no-referrer", "{path}");
        let policy = header(&answer, "content-security-policy");
        assert!(policy.starts_with("default-src 'none'"), "{path}: {policy}");
        assert!(policy.contains("frame-ancestors 'none'"), "{path}: {policy}");
    }
}
