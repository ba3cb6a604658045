//! A receiver that speaks TLS, with a certificate that the server trusts or does not.

use std::path::Path;

use serde_json::json;

use super::{end_a_job, is_signed, registered, until};
use crate::certificates::Authority;
use crate::process::Server;
use crate::receiver::Receiver;

const HERE: &str = "DNS:localhost,IP:127.0.0.1";

/// A server that may send to this machine and trusts an authority.
fn trusting(folder: &Path, authority: &Authority) -> Server {
    let arguments = ["--webhook-allow", "127.0.0.0/8,::1/128", "--lease-seconds", "2"];
    let log = folder.join("servoscope.log");
    Server::start_trusting(&folder.join("data"), &arguments, authority.file(), &log)
}

#[test]
fn a_signed_message_arrives_over_tls_where_the_receiver_is_trusted() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let Some(authority) = Authority::new(folder, "authority") else { return };
    let receiver = Receiver::start_tls(&authority.certify(HERE), &["204 No Content"]);
    let by_address = receiver.url();
    let by_name = by_address.replace("127.0.0.1", "localhost");
    let server = trusting(folder, &authority);
    for url in [by_address, by_name] {
        assert!(url.starts_with("https://"), "{url}");
        let (webhook, secret) = registered(&server, &json!({"url": url}));
        let job = end_a_job(&server);
        let received = receiver.next();
        assert!(is_signed(&received, &secret), "{url}");
        assert_eq!(received.json()["data"]["job_id"], job);
        let delivered = until(&server, &webhook, |latest| latest["status"] == "delivered");
        assert_eq!((&delivered["attempts"], &delivered["answered"]), (&1.into(), &204.into()));
        assert_eq!(server.delete(&webhook), 204);
    }
}

#[test]
fn a_receiver_that_is_not_trusted_is_told_nothing_until_it_is() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let Some(issuer) = Authority::new(folder, "authority") else { return };
    let Some(trusted) = Authority::new(folder, "trusted") else { return };
    let receiver = Receiver::start_tls(&issuer.certify(HERE), &["204 No Content"]);
    let server = trusting(folder, &trusted);
    let (webhook, secret) = registered(&server, &json!({"url": receiver.url()}));
    let job = end_a_job(&server);
    let failed =
        until(&server, &webhook, |latest| latest["attempts"] == 1 && !latest["error"].is_null());
    let error = failed["error"].as_str().unwrap();
    assert!(error.starts_with("no connection: invalid peer certificate"), "{error}");
    assert_eq!(failed["status"], "waiting");
    assert!(failed["answered"].is_null() && !failed["next_attempt_at"].is_null(), "{failed}");
    assert!(receiver.is_untouched());
    server.kill();
    let log = std::fs::read_to_string(folder.join("servoscope.log")).unwrap();
    assert!(log.contains("message not delivered yet"), "{log}");

    let server = trusting(folder, &issuer);
    let received = receiver.next();
    assert!(is_signed(&received, &secret));
    assert_eq!(received.header("webhook-id"), failed["id"]);
    assert_eq!(received.json()["data"]["job_id"], job);
    until(&server, &webhook, |latest| latest["status"] == "delivered");
    assert!(receiver.is_untouched(), "it came once");
}

#[test]
fn a_receiver_with_the_certificate_of_another_host_is_told_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let Some(authority) = Authority::new(folder, "authority") else { return };
    let receiver =
        Receiver::start_tls(&authority.certify("DNS:bench.example"), &["204 No Content"]);
    let server = trusting(folder, &authority);
    let (webhook, _) = registered(&server, &json!({"url": receiver.url()}));
    let tested = server.post(&format!("{webhook}/test"), "text/plain", b"").json();
    assert_eq!(tested["delivered"], false);
    let error = tested["error"].as_str().unwrap();
    assert!(error.starts_with("no connection: invalid peer certificate"), "{error}");
    assert!(receiver.is_untouched());
}
