//! The server under load, as a process of its own.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};

use serde_json::Value;
use ureq::Agent;

use super::memory::{self, Memory};

/// A server on a free port; it ends with this value.
pub struct Server {
    process: Child,
    address: String,
    agent: Agent,
    _directory: tempfile::TempDir,
}

impl Server {
    /// Starts one with default settings, an empty store and its log in a file.
    pub fn start(database: Option<&str>) -> Self {
        let directory = tempfile::tempdir().expect("a folder");
        let log = File::create(directory.path().join("log")).expect("a file");
        let mut process = program()
            .args(["serve", "--listen", "127.0.0.1:0", "--data-dir"])
            .arg(directory.path().join("data"))
            .args(database.into_iter().flat_map(|address| ["--database", address]))
            .stdout(Stdio::piped())
            .stderr(log)
            .spawn()
            .expect("the server starts");
        let mut line = String::new();
        let output = process.stdout.take().expect("it is a pipe");
        BufReader::new(output).read_line(&mut line).expect("it says where it listens");
        let address = line.trim().strip_prefix("listening on ").expect("an address").to_owned();
        Self { process, address, agent: agent(), _directory: directory }
    }

    /// Where it listens, as `http://…`.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Its memory.
    pub fn memory(&self) -> Memory {
        memory::of(self.process.id())
    }

    /// Stores a measurement.
    pub fn upload(&self, table: &[u8], encoding: Option<&str>) -> Value {
        self.upload_with(&self.agent, table, encoding)
    }

    /// The same on a connection of the caller.
    pub fn upload_with(&self, agent: &Agent, table: &[u8], encoding: Option<&str>) -> Value {
        let request = agent.post(format!("{}/v1/measurements", self.address));
        let request = request.header("content-type", "text/csv");
        let request = match encoding {
            Some(encoding) => request.header("content-encoding", encoding),
            None => request,
        };
        let answer = request.send(table).expect("it is taken");
        answer.into_body().read_json().expect("JSON")
    }

    /// Queues a job and gives its id.
    pub fn submit(&self, job: &Value) -> String {
        let request = self.agent.post(format!("{}/v1/jobs", self.address));
        let answer = request.send_json(job).expect("it is queued");
        let job: Value = answer.into_body().read_json().expect("JSON");
        job["id"].as_str().expect("an id").to_owned()
    }

    /// How many jobs have ended.
    pub fn jobs_ended(&self) -> f64 {
        let request = self.agent.get(format!("{}/metrics", self.address));
        let text = request.call().expect("metrics").into_body().read_to_string().expect("text");
        let ended = text.lines().filter(|line| line.starts_with("servoscope_jobs_ended_total{"));
        let counts = ended.filter_map(|line| line.rsplit(' ').next()?.parse::<f64>().ok());
        counts.sum()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Fails where it has ended already, which is as good.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// A caller that keeps its connection.
pub fn agent() -> Agent {
    Agent::new_with_defaults()
}

/// A measurement that the program simulates.
pub fn simulated(arguments: &[&str]) -> Vec<u8> {
    let output = program().arg("simulate").args(arguments).output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// The program with its default settings, whatever the environment says.
fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_servoscope"));
    command.env_remove("RUST_LOG");
    for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("SERVOSCOPE_")) {
        command.env_remove(name);
    }
    command
}
