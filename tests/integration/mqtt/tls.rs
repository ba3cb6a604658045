//! A broker that speaks TLS, with a certificate that the server trusts or does not.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::{ESCAPED, Mosquitto, PASSWORD, until_an_attempt_failed};
use crate::certificates::{Authority, Certificate};
use crate::process::Server;
use crate::service::{endless, submit};

const HERE: &str = "DNS:localhost,IP:127.0.0.1";

fn with_tls(folder: &Path, Certificate { file, key }: &Certificate) -> Option<Mosquitto> {
    let settings = format!("certfile {}\nkeyfile {}\n", file.display(), key.display());
    Mosquitto::with(folder, &settings)
}

/// Ends a job of a server that publishes to the broker and trusts an authority.
fn ended(folder: &Path, broker: &Mosquitto, trusted: &Authority) -> (Server, String) {
    let url = broker.url(ESCAPED).replace("mqtt://", "mqtts://");
    let arguments = ["--mqtt", &url, "--mqtt-topic", "plant/7", "--lease-seconds", "2"];
    let log = folder.join("servoscope.log");
    let server = Server::start_trusting(&folder.join("data"), &arguments, trusted.file(), &log);
    let job = submit(&server, &endless());
    assert_eq!(server.post(&format!("{job}/cancel"), "text/plain", b"").status, 202);
    (server, job.rsplit('/').next().unwrap().to_owned())
}

#[test]
fn the_end_of_a_job_is_published_over_tls_to_a_broker_that_is_trusted() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let Some(authority) = Authority::new(folder, "authority") else { return };
    let Some(mut broker) = with_tls(folder, &authority.certify(HERE)) else { return };
    broker.start();
    let trusting = ["--cafile", authority.file().to_str().unwrap()];
    broker.subscriber(&[&trusting[..], &["-E"]].concat());
    let (_server, id) = ended(folder, &broker, &authority);
    let received = broker.subscriber(&[&trusting[..], &["-C", "1"]].concat());
    let (topic, body) = received.trim().split_once(' ').expect("a topic and a message");
    assert_eq!(topic, format!("plant/7/jobs/{id}/finished"));
    let message: Value = serde_json::from_str(body).unwrap();
    assert_eq!(message["data"]["job_id"], id);
}

/// Lets a server publish to a broker with a certificate that it must refuse.
fn refused(folder: &Path, broker: Option<Mosquitto>, issuer: &Authority, trusted: &Authority) {
    let Some(mut broker) = broker else { return };
    broker.start();
    // The subscriber takes the certificate whatever it is for.
    let port = broker.address.port().to_string();
    let careless = ["--cafile", issuer.file().to_str().unwrap(), "--insecure"];
    broker.subscriber(&[&careless[..], &["-E"]].concat());
    let (server, _) = ended(folder, &broker, trusted);
    until_an_attempt_failed(&server);
    let published = Command::new("mosquitto_pub")
        .args(["-h", "127.0.0.1", "-p", &port, "-u", "bench", "-P", PASSWORD, "-q", "1"])
        .args(["-t", "plant/7/later", "-m", "another"])
        .args(careless)
        .output()
        .unwrap();
    assert!(published.status.success(), "{published:?}");
    // What the server had published would come before it.
    let received = broker.subscriber(&[&careless[..], &["-C", "1"]].concat());
    assert_eq!(received.trim(), "plant/7/later another");
    assert_eq!(server.terminate(), Some(0));
    let log = std::fs::read_to_string(folder.join("servoscope.log")).unwrap();
    assert!(log.contains("message not delivered yet"), "{log}");
    assert!(log.contains("invalid peer certificate"), "{log}");
    assert!(!log.contains("kestrel"), "the password is in the log");
}

#[test]
fn nothing_is_published_to_a_broker_whose_authority_is_not_trusted() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let Some(issuer) = Authority::new(folder, "authority") else { return };
    let Some(trusted) = Authority::new(folder, "trusted") else { return };
    refused(folder, with_tls(folder, &issuer.certify(HERE)), &issuer, &trusted);
}

#[test]
fn nothing_is_published_to_a_broker_with_the_certificate_of_another_host() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let Some(authority) = Authority::new(folder, "authority") else { return };
    let broker = with_tls(folder, &authority.certify("DNS:bench.example"));
    refused(folder, broker, &authority, &authority);
}
