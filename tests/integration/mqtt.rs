//! Events on a real broker: Mosquitto.

mod tls;

use std::fs::File;
use std::net::{SocketAddr, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use servoscope::notify::{Broker, SendError};

use crate::process::{Server, command};
use crate::receiver::free_address;
use crate::service::{endless, submit};
use crate::shared_files::skipped;

/// Ends a test that hangs; far more than anything here takes.
const PATIENCE: Duration = Duration::from_secs(120);

/// No part of it occurs anywhere else.
const PASSWORD: &str = "p@ss:w/rd-kestrel";
/// The same as an address has it.
const ESCAPED: &str = "p%40ss%3Aw%2Frd-kestrel";

/// A broker in a folder, and what it keeps when it is stopped.
struct Mosquitto {
    folder: PathBuf,
    address: SocketAddr,
    child: Option<Child>,
}

impl Mosquitto {
    /// One that knows a single user; `None` where there is no Mosquitto.
    fn new(folder: &Path) -> Option<Self> {
        Self::with(folder, "")
    }

    /// The same with settings of its listener, each with a line of its own.
    fn with(folder: &Path, of_listener: &str) -> Option<Self> {
        let password_file = folder.join("passwords");
        let made = Command::new("mosquitto_passwd")
            .args(["-b", "-c"])
            .arg(&password_file)
            .args(["bench", PASSWORD])
            .output();
        let present = Command::new(program()).arg("-h").output().is_ok()
            && Command::new("mosquitto_sub").arg("--help").output().is_ok();
        if made.is_err() || !present {
            let required = std::env::var_os("SERVO_REQUIRE_MOSQUITTO").is_some();
            assert!(!required, "mosquitto is absent");
            skipped("mosquitto is absent");
            return None;
        }
        let address = free_address();
        let settings = format!(
            "listener {} 127.0.0.1\n{of_listener}allow_anonymous false\npassword_file {}\n\
             persistence true\npersistence_location {}/\n{}",
            address.port(),
            password_file.display(),
            folder.display(),
            // Run by root it would become a user that cannot read this folder.
            if rustix::process::geteuid().is_root() { "user root\n" } else { "" },
        );
        std::fs::write(folder.join("mosquitto.conf"), settings).unwrap();
        Some(Self { folder: folder.to_owned(), address, child: None })
    }

    fn start(&mut self) {
        let log = File::create(self.folder.join("log")).unwrap();
        let child = Command::new(program())
            .arg("-c")
            .arg(self.folder.join("mosquitto.conf"))
            .stdout(Stdio::null())
            .stderr(log)
            .spawn();
        self.child = Some(child.unwrap());
        let began = Instant::now();
        while TcpStream::connect(self.address).is_err() {
            assert!(began.elapsed() < PATIENCE, "{}", self.log());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Stops it in good order: what it keeps for others is stored.
    fn stop(&mut self) {
        if let Some(mut child) = self.child.take() {
            kill_process(Pid::from_child(&child), Signal::TERM).unwrap();
            child.wait().unwrap();
        }
    }

    fn log(&self) -> String {
        std::fs::read_to_string(self.folder.join("log")).unwrap_or_default()
    }

    fn url(&self, password: &str) -> String {
        format!("mqtt://bench:{password}@{}", self.address)
    }

    /// A subscriber that the broker remembers while it is away.
    fn subscriber(&self, arguments: &[&str]) -> String {
        let output = Command::new("mosquitto_sub")
            .args(["-h", "127.0.0.1", "-p", &self.address.port().to_string()])
            .args(["-u", "bench", "-P", PASSWORD, "-i", "watcher", "-c", "-q", "1"])
            .args(["-t", "plant/7/#", "-v", "-W", &PATIENCE.as_secs().to_string()])
            .args(arguments)
            .output()
            .unwrap();
        assert!(output.status.success(), "{output:?}\n{}", self.log());
        String::from_utf8(output.stdout).unwrap()
    }
}

impl Drop for Mosquitto {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Debian keeps it where only root looks.
fn program() -> &'static str {
    if Path::new("/usr/sbin/mosquitto").exists() { "/usr/sbin/mosquitto" } else { "mosquitto" }
}

/// Waits until a server could not publish a message.
fn until_an_attempt_failed(server: &Server) {
    let failed = "servoscope_messages_total{to=\"mqtt\",outcome=\"failed\"} 1\n";
    let began = Instant::now();
    while !server.get("/metrics").text.contains(failed) {
        assert!(began.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn the_end_of_a_job_is_published_though_the_broker_was_down_and_no_log_has_the_password() {
    let directory = tempfile::tempdir().unwrap();
    let Some(mut broker) = Mosquitto::new(directory.path()) else { return };
    broker.start();
    broker.subscriber(&["-E"]);
    broker.stop();

    let log = directory.path().join("servoscope.log");
    let url = broker.url(ESCAPED);
    let arguments = ["--mqtt", &url, "--mqtt-topic", "plant/7", "--lease-seconds", "2", "-vv"];
    let server = Server::start_logging(&directory.path().join("data"), &arguments, &log);
    let job = submit(&server, &endless());
    assert_eq!(server.post(&format!("{job}/cancel"), "text/plain", b"").status, 202);
    until_an_attempt_failed(&server);
    broker.start();
    let received = broker.subscriber(&["-C", "1"]);
    let (topic, body) = received.trim().split_once(' ').expect("a topic and a message");
    let id = job.rsplit('/').next().unwrap();
    assert_eq!(topic, format!("plant/7/jobs/{id}/finished"));
    let message: Value = serde_json::from_str(body).unwrap();
    assert_eq!(
        (&message["type"], &message["data"]["job_id"]),
        (&"job.finished".into(), &id.into())
    );
    assert_eq!(server.terminate(), Some(0));
    let log = std::fs::read_to_string(&log).unwrap();
    assert!(log.contains("message not delivered yet"), "{log}");
    assert!(!log.contains("kestrel"), "the password is in the log");
}

#[test]
fn a_broker_that_refuses_says_so() {
    let directory = tempfile::tempdir().unwrap();
    let Some(mut broker) = Mosquitto::new(directory.path()) else { return };
    broker.start();
    let publish = |password: &str| {
        let broker = Broker::parse(&broker.url(password), "plant/7").unwrap();
        let runtime = tokio::runtime::Runtime::new().unwrap();
        runtime.block_on(async { broker.publish("jobs/1/finished", "{}").await })
    };
    assert_eq!(publish(ESCAPED), Ok(()));
    let refused = publish("wrong-kestrel");
    let Err(SendError::Broker(reason)) = &refused else { panic!("{refused:?}") };
    assert!(reason.contains("NotAuthorized") && !reason.contains("kestrel"), "{reason}");
}

#[test]
fn the_settings_are_shown_without_the_password() {
    let mut show = command();
    show.args(["config", "show"]).env("SERVOSCOPE_MQTT", "mqtt://bench:secret-kestrel@host");
    let output = show.output().unwrap();
    let shown = String::from_utf8(output.stdout).unwrap();
    assert!(shown.contains("mqtt = \"mqtt://bench:***@host\""), "{shown}");
    let mut wrong = command();
    wrong.args(["config", "show", "--mqtt", "http://bench:secret-kestrel@host"]);
    let output = wrong.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let mut help = command();
    let help =
        help.args(["serve", "--help"]).env("SERVOSCOPE_MQTT", "mqtt://b:secret-kestrel@host");
    let help = help.output().unwrap();
    for text in [output.stdout, output.stderr, help.stdout] {
        assert!(!String::from_utf8(text).unwrap().contains("kestrel"));
    }
}
