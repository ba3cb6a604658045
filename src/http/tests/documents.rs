//! Figures and the page of a job.

use super::*;

/// A browser gives a document no style but those that its policy names.
fn has_the_styles_of_its_policy(document: &str, policy: &str) {
    use base64::prelude::{BASE64_STANDARD, Engine as _};
    use sha2::{Digest as _, Sha256};

    let sheets: Vec<&str> = document.split("<style").skip(1).collect();
    assert!(!sheets.is_empty());
    for sheet in sheets {
        let sheet = sheet.strip_prefix('>').unwrap().split_once("</style>").unwrap().0;
        let digest = BASE64_STANDARD.encode(Sha256::digest(sheet));
        assert!(policy.contains(&format!("'sha256-{digest}'")), "{policy}");
    }
    assert!(!document.contains(" style="), "no policy allows an attribute");
}

#[test]
fn no_answer_may_run_or_style_what_its_policy_does_not_name() {
    let server = Server::start();
    let job = server.job(SUCCEED);
    let measurement = string(&server.ended(&job), "measurement_id");
    let document = json_of(server.get("/openapi.json"), 200);
    let paths = document["paths"].as_object().unwrap().iter();
    let paths = paths.filter(|(_, item)| item["get"].is_object()).map(|(path, _)| {
        let id = if path.starts_with("/v1/measurements") { &measurement } else { &job };
        path.replace("{id}", id).replace("{file}", "bode.svg").replace("{name}", "nothing")
    });
    let pages = ["/", "/docs/", "/docs/swagger-ui.css", "/nothing", "/assets/nothing"];
    let mut styled = 0;
    for path in paths.chain(pages.map(str::to_owned)) {
        let answer = server.get(&path);
        let policy = header(&answer, "content-security-policy");
        assert!(policy.starts_with("default-src 'none'"), "{path}: {policy}");
        assert!(!policy.contains("unsafe"), "{path}: {policy}");
        assert_eq!(header(&answer, "cross-origin-resource-policy"), "same-origin", "{path}");
        styled += usize::from(policy.contains("sha256-"));
    }
    assert!(styled > 1, "some answers style themselves");
    // The page of the interface needs no more than its own files.
    let page = server.get("/docs/").body_mut().read_to_string().unwrap();
    assert!(page.contains("<link rel=\"stylesheet\""), "{page}");
    assert!(!page.contains("<style") && !page.contains(" style="), "{page}");
    assert!(page.split("<script").skip(1).all(|script| script.starts_with(" src=")), "{page}");
}

#[test]
fn a_plot_is_an_image_that_may_be_kept() {
    let server = Server::start();
    let id = server.job(SUCCEED);
    assert_eq!(server.ended(&id)["status"], "succeeded");
    let path = format!("/v1/jobs/{id}/plots/bode.svg");
    let mut plot = server.get(&path);
    assert_eq!(plot.status(), 200);
    assert_eq!(header(&plot, "content-type"), "image/svg+xml");
    let policy = header(&plot, "content-security-policy").to_owned();
    assert!(policy.starts_with("default-src 'none'; style-src 'sha256-"), "{policy}");
    assert!(header(&plot, "cache-control").contains("max-age"));
    // What one caller may see is not kept for another, nor for a page of another origin.
    let varies: Vec<_> = plot.headers().get_all("vary").iter().collect();
    assert!(varies.iter().any(|names| *names == "authorization, cookie"), "{varies:?}");
    assert_eq!(header(&plot, "cross-origin-resource-policy"), "same-origin");
    let tag = header(&plot, "etag").to_owned();
    let svg = plot.body_mut().read_to_string().unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("prefers-color-scheme"));
    has_the_styles_of_its_policy(&svg, &policy);
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
fn two_jobs_are_drawn_in_one_figure() {
    let server = Server::start();
    let [left, right] = [SUCCEED; 2].map(|seed| server.job(seed));
    for id in [&left, &right] {
        assert_eq!(server.ended(id)["status"], "succeeded");
    }
    let path = |other: &str| format!("/v1/jobs/{left}/plots/bode-against-{other}.svg");
    let mut plot = server.get(&path(&right));
    assert_eq!(plot.status(), 200);
    let svg = plot.body_mut().read_to_string().unwrap();
    for part in ["servoscope-bode-both", "data-series=\"left ", "data-series=\"right "] {
        assert!(svg.contains(part), "{part}: {svg}");
    }
    problem(server.get(&path("nobody")), 404);
    let running = server.job(RUN_UNTIL_CANCELLED);
    problem(server.get(&path(&running)), 409);
    json_of(server.post(&format!("/v1/jobs/{running}/cancel"), &[], b""), 202);
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
    let policy = header(&report, "content-security-policy").to_owned();
    assert!(policy.starts_with("default-src 'none'; style-src 'sha256-"), "{policy}");
    assert!(policy.contains("; script-src 'sha256-"), "{policy}");
    assert!(header(&report, "cache-control").contains("max-age"));
    let tag = header(&report, "etag").to_owned();
    let page = report.body_mut().read_to_string().unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("Diagnosis of press 4"), "{page}");
    assert!(page.contains("servoscope-bode"), "it is without figures");
    has_the_styles_of_its_policy(&page, &policy);
    let again = server.agent.get(format!("{}{path}", server.address));
    assert_eq!(again.header("if-none-match", tag.as_str()).call().unwrap().status(), 304);
    problem(server.get("/v1/jobs/nobody/report.html"), 404);
}
