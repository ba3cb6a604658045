//! Figures and the page of a job.

use super::*;

#[test]
fn a_plot_is_an_image_that_may_be_kept() {
    let server = Server::start();
    let id = server.job(SUCCEED);
    assert_eq!(server.ended(&id)["status"], "succeeded");
    let path = format!("/v1/jobs/{id}/plots/bode.svg");
    let mut plot = server.get(&path);
    assert_eq!(plot.status(), 200);
    assert_eq!(header(&plot, "content-type"), "image/svg+xml");
    assert!(header(&plot, "content-security-policy").contains("default-src 'none'"));
    assert!(header(&plot, "cache-control").contains("max-age"));
    let tag = header(&plot, "etag").to_owned();
    let svg = plot.body_mut().read_to_string().unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("prefers-color-scheme"));
    let again = server.agent.get(format!("{}{path}", server.address));
    assert_eq!(again.header("if-none-match", tag.as_str()).call().unwrap().status(), 304);

    let mut dark = server.get(&format!("{path}?theme=dark"));
    assert_ne!(header(&dark, "etag"), tag);
    assert!(!dark.body_mut().read_to_string().unwrap().contains("prefers-color-scheme"));
    problem(server.get(&format!("{path}?theme=sepia")), 400);
    let mut small = server.get(&format!("{path}?width=400"));
    assert!(small.body_mut().read_to_string().unwrap().contains("width=\"400\""));
    let huge = problem(server.get(&format!("{path}?height=100000")), 400);
    assert!(string(&huge, "detail").contains("50 to 10000"), "{huge}");
    for name in ["spectrum", "residuals", "convergence"] {
        assert_eq!(server.get(&format!("/v1/jobs/{id}/plots/{name}.svg")).status(), 200, "{name}");
    }
}

#[test]
fn a_plot_there_is_none_of_is_refused_with_those_there_are() {
    let server = Server::start();
    let id = server.job(SUCCEED);
    server.ended(&id);
    let unknown = problem(server.get(&format!("/v1/jobs/{id}/plots/pie.svg")), 404);
    assert!(
        string(&unknown, "detail").contains("available: bode, bode-errors, linearity"),
        "{unknown}"
    );
    problem(server.get("/v1/jobs/nobody/plots/bode.svg"), 404);
}

#[test]
fn a_running_job_shows_how_it_converges_and_nothing_else() {
    let server = Server::start();
    let id = server.job(RUN_UNTIL_CANCELLED);
    let status = |name: &str| server.get(&format!("/v1/jobs/{id}/plots/{name}.svg")).status();
    // Rows reach the store with the next heartbeat after the job was taken up.
    let patience = Instant::now() + Duration::from_secs(60);
    while status("convergence") != 200 {
        assert!(Instant::now() < patience, "nothing was shown of a running job");
        std::thread::sleep(Duration::from_millis(10));
    }
    problem(server.get(&format!("/v1/jobs/{id}/plots/bode.svg")), 409);
    problem(server.get(&format!("/v1/jobs/{id}/report.html")), 409);
    json_of(server.post(&format!("/v1/jobs/{id}/cancel"), &[], b""), 202);
    assert_eq!(server.ended(&id)["status"], "cancelled");
    assert_eq!(status("convergence"), 200);
    problem(server.get(&format!("/v1/jobs/{id}/plots/bode.svg")), 404);
    problem(server.get(&format!("/v1/jobs/{id}/report.html")), 404);
}

#[test]
fn a_report_is_a_page_that_may_style_itself_and_be_kept() {
    let server = Server::start();
    let body = json!({"measurement_id": server.measurement(), "kind": "diagnose"});
    let id = string(&json_of(server.submit(&body), 202), "id");
    assert_eq!(server.ended(&id)["status"], "succeeded");
    let path = format!("/v1/jobs/{id}/report.html");
    let mut report = server.get(&path);
    assert_eq!(report.status(), 200);
    assert_eq!(header(&report, "content-type"), "text/html; charset=utf-8");
    let policy = header(&report, "content-security-policy");
    assert!(policy.starts_with("default-src 'none'; style-src 'unsafe-inline'"), "{policy}");
    assert!(header(&report, "cache-control").contains("max-age"));
    let tag = header(&report, "etag").to_owned();
    let page = report.body_mut().read_to_string().unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("Diagnosis of press 4"), "{page}");
    assert!(page.contains("servoscope-bode"), "it is without figures");
    let again = server.agent.get(format!("{}{path}", server.address));
    assert_eq!(again.header("if-none-match", tag.as_str()).call().unwrap().status(), 304);
    problem(server.get("/v1/jobs/nobody/report.html"), 404);
}
