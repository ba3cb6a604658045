//! The program as a process.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Output, Stdio};
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use ureq::http::Response;
use ureq::{Agent, Body};

/// Runs the program to its end.
pub fn servoscope(arguments: &[&str]) -> Output {
    command().args(arguments).output().unwrap()
}

/// A measurement that the program simulates.
pub fn simulated(arguments: &[&str]) -> Vec<u8> {
    let output = servoscope(&[&["simulate"], arguments].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// The program, with nothing of this environment that it would heed.
pub fn command() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_servoscope"));
    command.env_remove("RUST_LOG");
    for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("SERVOSCOPE_")) {
        command.env_remove(name);
    }
    command
}

/// What serves on a free port.
fn serve(data_dir: &Path, arguments: &[&str]) -> Command {
    let mut command = command();
    command.args(["serve", "--listen", "127.0.0.1:0", "--data-dir"]);
    command.arg(data_dir).args(arguments);
    command
}

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// A server on a free port, killed when it is dropped.
pub struct Server {
    child: Child,
    address: String,
    agent: Agent,
}

impl Server {
    pub fn start(data_dir: &Path, arguments: &[&str]) -> Self {
        Self::spawn(data_dir, arguments, Stdio::null()).0
    }

    /// The same with its log in a file.
    pub fn start_logging(data_dir: &Path, arguments: &[&str], log: &Path) -> Self {
        Self::spawn(data_dir, arguments, File::create(log).unwrap().into()).0
    }

    /// The same, trusting what the authority of this certificate signed and nothing else.
    pub fn start_trusting(
        data_dir: &Path,
        arguments: &[&str],
        authority: &Path,
        log: &Path,
    ) -> Self {
        let mut command = serve(data_dir, arguments);
        command.env("SSL_CERT_FILE", authority).env_remove("SSL_CERT_DIR");
        Self::started(command, File::create(log).unwrap().into()).0
    }

    /// One that may have so many files open.
    pub fn start_with_files(data_dir: &Path, files: u64) -> Self {
        let mut shell = Command::new("sh");
        let limited = format!("ulimit -n {files} && exec \"$0\" \"$@\"");
        shell.args(["-c", &limited]).arg(env!("CARGO_BIN_EXE_servoscope"));
        shell.args(["serve", "--listen", "127.0.0.1:0", "--data-dir"]).arg(data_dir);
        Self::started(shell, Stdio::null()).0
    }

    /// One that shows its demonstration, and what it prints.
    pub fn demonstrate(data_dir: &Path) -> (Self, String) {
        let (server, output) = Self::spawn(data_dir, &["--demo"], Stdio::null());
        let mut printed = String::new();
        for line in output.lines() {
            printed.push_str(&line.unwrap());
            printed.push('\n');
            if printed.contains("until it is interrupted") {
                break;
            }
        }
        (server, printed)
    }

    /// One that other machines could reach, with these variables of the environment.
    pub fn reachable(data_dir: &Path, variables: &[(&str, &str)]) -> Self {
        let mut command = command();
        command.args(["serve", "--listen", "0.0.0.0:0", "--data-dir"]).arg(data_dir);
        command.envs(variables.iter().copied());
        let (mut server, _) = Self::started(command, Stdio::null());
        server.address = server.address.replace("0.0.0.0", "127.0.0.1");
        server
    }

    fn spawn(data_dir: &Path, arguments: &[&str], log: Stdio) -> (Self, BufReader<ChildStdout>) {
        Self::started(serve(data_dir, arguments), log)
    }

    fn started(mut command: Command, log: Stdio) -> (Self, BufReader<ChildStdout>) {
        let mut child = command.stdout(Stdio::piped()).stderr(log).spawn().unwrap();
        let mut line = String::new();
        let mut output = BufReader::new(child.stdout.take().unwrap());
        output.read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("listening on ").expect("it says where").to_owned();
        let agent = Agent::config_builder()
            .http_status_as_error(false)
            .timeout_global(Some(Duration::from_secs(90)))
            .build()
            .into();
        (Self { child, address, agent }, output)
    }

    pub fn delete(&self, path: &str) -> u16 {
        self.agent.delete(format!("{}{path}", self.address)).call().unwrap().status().as_u16()
    }

    pub fn get(&self, path: &str) -> Answer {
        self.agent.get(format!("{}{path}", self.address)).call().unwrap().into()
    }

    /// The same with a key.
    pub fn get_with(&self, path: &str, key: &str) -> Answer {
        let request = self.agent.get(format!("{}{path}", self.address));
        request.header("authorization", format!("Bearer {key}")).call().unwrap().into()
    }

    pub fn post(&self, path: &str, content_type: &str, body: &[u8]) -> Answer {
        let request = self.agent.post(format!("{}{path}", self.address));
        request.header("content-type", content_type).send(body).unwrap().into()
    }

    /// The same with headers of its own.
    pub fn post_with(&self, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Answer {
        let mut request = self.agent.post(format!("{}{path}", self.address));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        request.send(body).unwrap().into()
    }

    /// Status of a `PUT` of whatever it is.
    pub fn put_bytes(&self, path: &str, content_type: &str, body: &[u8]) -> u16 {
        let request = self.agent.put(format!("{}{path}", self.address));
        let answer = request.header("content-type", content_type).send(body);
        answer.unwrap().status().as_u16()
    }

    /// The same of a `PATCH`.
    pub fn patch_bytes(&self, path: &str, content_type: &str, body: &[u8]) -> u16 {
        let request = self.agent.patch(format!("{}{path}", self.address));
        let answer = request.header("content-type", content_type).send(body);
        answer.unwrap().status().as_u16()
    }

    /// Most memory that it has had, KiB, where the system tells it.
    pub fn peak_memory_kib(&self) -> Option<u64> {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        line.trim().trim_end_matches("kB").trim().parse().ok()
    }

    pub fn put(&self, path: &str, body: &Value) -> Answer {
        let request = self.agent.put(format!("{}{path}", self.address));
        let request = request.header("content-type", "application/json");
        request.send(body.to_string()).unwrap().into()
    }

    /// Queues a job and gives its path.
    pub fn submit(&self, request: &Value) -> String {
        let job = self.post("/v1/jobs", "application/json", request.to_string().as_bytes());
        assert_eq!(job.status, 202, "{}", job.text);
        format!("/v1/jobs/{}", job.json()["id"].as_str().unwrap())
    }

    /// Waits for a job to end and gives it as it then stands.
    pub fn ended(&self, job: &str) -> Value {
        loop {
            let job = self.get(&format!("{job}?wait=30")).json();
            if !["queued", "running"].contains(&job["status"].as_str().unwrap()) {
                return job;
            }
        }
    }

    /// Where it listens, as `http://…`.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Ends the process without a chance to clean up, as a power cut does.
    pub fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// Asks the process to stop and waits for its exit code.
    pub fn terminate(mut self) -> Option<i32> {
        kill_process(Pid::from_child(&self.child), Signal::TERM).unwrap();
        self.child.wait().unwrap().code()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // Fails where it has ended already, which is as good.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// An answer, read to its end.
pub struct Answer {
    pub status: u16,
    pub content_type: String,
    pub text: String,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.text).unwrap_or_else(|error| panic!("{error}: {}", self.text))
    }
}

impl From<Response<Body>> for Answer {
    fn from(mut response: Response<Body>) -> Self {
        let content_type = response.headers().get("content-type");
        let content_type = content_type.map_or("", |value| value.to_str().unwrap()).to_owned();
        let status = response.status().as_u16();
        let text = response.body_mut().read_to_string().unwrap();
        Self { status, content_type, text }
    }
}
