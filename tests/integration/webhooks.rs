//! Others are told what happened: signed, until they take it, and nowhere they must not be.

mod page;
mod tls;

use std::time::{Duration, Instant};

use serde_json::{Value, json};
use servoscope::notify::Secret;

use crate::process::{Server, simulated};
use crate::receiver::{Received, Receiver, free_address};
use crate::service::{endless, problem, submit};

/// Ends a test that hangs; far more than anything here takes.
const PATIENCE: Duration = Duration::from_secs(120);

/// Lets webhooks reach the receivers of these tests.
const ALLOWED: [&str; 4] = ["--webhook-allow", "127.0.0.0/8", "--lease-seconds", "2"];

/// Registers a webhook and gives its path and its secret.
fn registered(server: &Server, request: &Value) -> (String, String) {
    let body = request.to_string();
    let added = server.post("/v1/webhooks", "application/json", body.as_bytes());
    assert_eq!(added.status, 201, "{}", added.text);
    let text = |member: &str| added.json()[member].as_str().unwrap().to_owned();
    (format!("/v1/webhooks/{}", text("id")), text("secret"))
}

/// Ends a job in the quickest way: by cancelling it.
fn end_a_job(server: &Server) -> String {
    let job = submit(server, &endless());
    assert_eq!(server.post(&format!("{job}/cancel"), "text/plain", b"").status, 202);
    assert_eq!(server.ended(&job)["status"], "cancelled");
    job.rsplit('/').next().unwrap().to_owned()
}

/// Waits until the latest message to a webhook says what is wanted of it.
fn until(server: &Server, webhook: &str, wanted: impl Fn(&Value) -> bool) -> Value {
    let began = Instant::now();
    loop {
        let latest = server.get(&format!("{webhook}/deliveries")).json()["items"][0].clone();
        if wanted(&latest) {
            return latest;
        }
        assert!(began.elapsed() < PATIENCE, "it stays at {latest}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn is_signed(received: &Received, secret: &str) -> bool {
    let timestamp = received.header("webhook-timestamp").parse().unwrap();
    let secret = Secret::parse(secret).unwrap();
    let signature = secret.sign(received.header("webhook-id"), timestamp, &received.body);
    received.header("webhook-signature") == signature
}

#[test]
fn a_message_is_signed_and_sent_again_until_it_is_taken() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &ALLOWED);
    let receiver = Receiver::start(&["503 Service Unavailable", "204 No Content"]);
    let (webhook, secret) = registered(&server, &json!({"url": receiver.url()}));
    assert!(server.get(&webhook).json().get("secret").is_none(), "it is shown once");
    let job = end_a_job(&server);
    let [first, second] = [receiver.next(), receiver.next()];
    for received in [&first, &second] {
        assert!(is_signed(received, &secret));
        assert_eq!(received.header("content-type"), "application/json");
    }
    assert_eq!(first.header("webhook-id"), second.header("webhook-id"));
    assert_eq!(first.body, second.body);
    let message = first.json();
    assert_eq!(
        (&message["type"], &message["data"]["job_id"]),
        (&"job.finished".into(), &job.into())
    );
    assert_eq!(message["data"]["status"], "cancelled");
    assert_eq!(message["data"]["measurement"]["name"], "simulated axis");
    let delivered = until(&server, &webhook, |latest| latest["status"] == "delivered");
    assert_eq!(delivered["id"], first.header("webhook-id"));
    assert_eq!((&delivered["attempts"], &delivered["answered"]), (&2.into(), &204.into()));
    for outcome in ["failed", "delivered"] {
        // It is counted once it is settled.
        let line = format!("servoscope_messages_total{{to=\"webhook\",outcome=\"{outcome}\"}} 1\n");
        let began = Instant::now();
        while !server.get("/metrics").text.contains(&line) {
            assert!(began.elapsed() < PATIENCE, "{}", server.get("/metrics").text);
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

#[test]
fn a_message_survives_a_killed_server() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &ALLOWED);
    let address = free_address();
    let (webhook, secret) = registered(&server, &json!({"url": format!("http://{address}/hook")}));
    let job = end_a_job(&server);
    let failed =
        until(&server, &webhook, |latest| latest["attempts"] == 1 && !latest["error"].is_null());
    assert!(failed["error"].as_str().unwrap().starts_with("no connection"), "{failed}");
    server.kill();
    let receiver = Receiver::start_at(address, &["200 OK"]);
    let server = Server::start(directory.path(), &ALLOWED);
    let received = receiver.next();
    assert!(is_signed(&received, &secret));
    assert_eq!(received.header("webhook-id"), failed["id"]);
    assert_eq!(received.json()["data"]["job_id"], job);
    until(&server, &webhook, |latest| latest["status"] == "delivered");
}

#[test]
fn a_redirect_is_not_followed() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &ALLOWED);
    let elsewhere = Receiver::start(&["200 OK"]);
    let redirect = format!("307 Temporary Redirect\r\nLocation: {}", elsewhere.url());
    let receiver = Receiver::start(&[&redirect]);
    let (webhook, _) = registered(&server, &json!({"url": receiver.url()}));
    let tested = server.post(&format!("{webhook}/test"), "text/plain", b"").json();
    assert_eq!(receiver.next().json()["type"], "webhook.test");
    assert_eq!((&tested["delivered"], &tested["answered"]), (&false.into(), &307.into()));
    assert!(tested["error"].as_str().unwrap().contains("redirects are not followed"), "{tested}");
    assert!(elsewhere.is_untouched());
}

#[test]
fn an_address_that_is_not_public_is_refused_unless_its_network_is_allowed() {
    let directory = tempfile::tempdir().unwrap();
    let receiver = Receiver::start(&["204 No Content"]);
    let add = |server: &Server, url: &str| {
        let body = json!({"url": url}).to_string();
        server.post("/v1/webhooks", "application/json", body.as_bytes())
    };
    let server = Server::start(directory.path(), &["--webhook-allow", "10.0.0.0/8,fd00::/8"]);
    let named = receiver.url().replace("127.0.0.1", "localhost");
    for url in [&receiver.url(), &named, "http://169.254.169.254/", "http://[::1]/"] {
        let refused = problem(&add(&server, url), 422);
        assert_eq!(refused["member"], "url");
        let detail = refused["detail"].as_str().unwrap();
        assert!(detail.contains("not a public address") && detail.contains("--webhook-allow"));
    }
    assert_eq!(add(&server, "http://10.1.2.3/").status, 201);
    assert_eq!(server.get("/v1/webhooks").json()["items"].as_array().unwrap().len(), 1);
    // What an earlier server allowed is refused by one that does not.
    server.kill();
    let server = Server::start(directory.path(), &ALLOWED);
    let (webhook, _) = registered(&server, &json!({"url": receiver.url()}));
    let test = format!("{webhook}/test");
    assert_eq!(server.post(&test, "text/plain", b"").json()["delivered"], true);
    receiver.next();
    server.kill();
    let server = Server::start(directory.path(), &[]);
    let tested = server.post(&test, "text/plain", b"").json();
    assert!(tested["error"].as_str().unwrap().contains("not a public address"), "{tested}");
    assert!(receiver.is_untouched());
}

#[test]
fn a_receiver_that_answers_gone_is_told_nothing_more() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &ALLOWED);
    let receiver = Receiver::start(&["410 Gone"]);
    let (webhook, _) = registered(&server, &json!({"url": receiver.url()}));
    end_a_job(&server);
    receiver.next();
    let last = until(&server, &webhook, |latest| latest["status"] == "given_up");
    assert_eq!((&last["attempts"], &last["next_attempt_at"]), (&1.into(), &Value::Null));
    let disabled = server.get(&webhook).json()["disabled"].clone();
    assert!(disabled.as_str().unwrap().contains("410"), "{disabled}");
    end_a_job(&server);
    let metrics = || server.get("/metrics").text;
    let began = Instant::now();
    while !metrics().contains("servoscope_messages_waiting 0\n") {
        assert!(began.elapsed() < PATIENCE);
    }
    assert!(receiver.is_untouched());
    assert_eq!(server.delete(&webhook), 204);
    assert_eq!(server.get(&webhook).status, 404);
}

#[test]
fn a_webhook_is_told_of_the_axis_that_changed_and_of_nothing_else_if_it_wants() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &ALLOWED);
    let receiver = Receiver::start(&["204 No Content"]);
    let request = json!({"url": receiver.url(), "events": ["axis.changed"]});
    registered(&server, &request);
    let everything = Receiver::start(&["204 No Content"]);
    registered(&server, &json!({"url": everything.url()}));
    let mut jobs = Vec::new();
    for (name, pole) in [("before", "-10"), ("same", "-10"), ("after", "-12")] {
        let mut table = b"# machine: press 4\n# axis: x/1\n".to_vec();
        table.extend(simulated(&["--noise-db", "60", &format!("--pole={pole}")]));
        let path = format!("/v1/measurements?name={name}");
        let measurement = server.post(&path, "text/csv", &table);
        assert_eq!(measurement.status, 201, "{}", measurement.text);
        let job = server.submit(&json!({
            "measurement_id": measurement.json()["id"], "kind": "identify",
            "plant": {"actuator_order": 0},
        }));
        assert_eq!(server.ended(&job)["status"], "succeeded");
        let finished = everything.next().json();
        let data = &finished["data"];
        assert_eq!(
            (&finished["type"], &data["status"]),
            (&"job.finished".into(), &"succeeded".into())
        );
        assert!(data["headline"].as_str().unwrap().starts_with("ADEQUATE: "), "{data}");
        for link in data["links"].as_object().unwrap().values() {
            assert_eq!(server.get(link.as_str().unwrap()).status, 200, "{link}");
        }
        jobs.push(data["job_id"].clone());
    }
    let message = receiver.next().json();
    let data = &message["data"];
    assert_eq!((&message["type"], &data["job_id"]), (&"axis.changed".into(), &jobs[2]));
    assert_eq!((&data["machine"], &data["axis"]), (&"press 4".into(), &"x/1".into()));
    let changes = data["changes"].as_array().unwrap();
    let pole = changes.iter().find(|change| change["parameter"] == "pole").expect("the pole");
    // 60 dB below the response in noise leaves the pole certain to a thousandth.
    assert!((pole["change"].as_f64().unwrap() + 2.0).abs() < 0.05, "{pole}");
    let history = server.get(data["links"]["history"].as_str().unwrap()).json();
    let marked = history["rows"].as_array().unwrap().iter().filter(|row| row["changed"] == true);
    assert_eq!(marked.count(), changes.len());
}

#[test]
fn what_cannot_be_a_webhook_is_refused_by_its_member() {
    let directory = tempfile::tempdir().unwrap();
    let server = Server::start(directory.path(), &[]);
    for (request, member) in [
        (json!({"url": "ftp://example.com"}), "url"),
        (json!({"url": "https://me:secret@example.com"}), "url"),
        (json!({"url": "https://8.8.8.8/", "events": []}), "events"),
        (json!({"url": "https://8.8.8.8/", "events": ["job.begun"]}), "events[0]"),
        (json!({"url": "https://8.8.8.8/", "secret": "whsec_c2hvcnQ="}), "secret"),
        (json!({"url": "https://8.8.8.8/", "colour": "red"}), "colour"),
    ] {
        let body = request.to_string();
        let answer = server.post("/v1/webhooks", "application/json", body.as_bytes());
        assert_eq!(problem(&answer, 422)["member"], member, "{request}");
    }
}
