//! Servers and workers of one database, each a process.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use rustix::process::{Pid, Signal, kill_process};

use crate::process::{Server, command};

/// That of [`QUICK`].
pub const LEASE: Duration = Duration::from_secs(2);

/// A short wait for what a worker held that is gone.
pub const QUICK: [&str; 4] = ["--lease-seconds", "2", "--retry-seconds", "0"];

/// A server without workers.
pub fn server(folder: &Path, database: &str) -> Server {
    let mut arguments = vec!["--database", database, "--workers", "0"];
    arguments.extend(["--webhook-allow", "127.0.0.0/8"]);
    arguments.extend(QUICK);
    Server::start(folder, &arguments)
}

/// A worker of one place, killed when it is dropped.
pub struct Worker(pub Child);

impl Worker {
    pub fn start(place: &[&str]) -> Self {
        Self::start_logging(place, Stdio::null())
    }

    pub fn start_logging(place: &[&str], log: impl Into<Stdio>) -> Self {
        Self::started(command(), place, log)
    }

    /// One on a machine whose clock is off by this, as libfaketime writes it (`+3600s`); `None` where
    /// that library is absent.
    pub fn with_clock(place: &[&str], offset: &str) -> Option<Self> {
        let mut command = command();
        command.env("LD_PRELOAD", libfaketime()?).env("FAKETIME", offset);
        // Waits of the program end when they should.
        command.env("FAKETIME_DONT_FAKE_MONOTONIC", "1");
        Some(Self::started(command, place, Stdio::null()))
    }

    fn started(mut command: Command, place: &[&str], log: impl Into<Stdio>) -> Self {
        command.arg("worker").args(place).args(["--workers", "1"]).args(QUICK);
        let mut child = command.stdout(Stdio::piped()).stderr(log).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        assert!(line.starts_with("taking jobs from "), "{line}");
        Self(child)
    }

    pub fn signal(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.0), signal).unwrap();
    }

    /// Asks it to stop and waits for its exit code.
    pub fn terminate(mut self) -> Option<i32> {
        self.signal(Signal::TERM);
        self.0.wait().unwrap().code()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        // Fails where it has ended already, which is as good.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Where Debian's package puts it.
fn libfaketime() -> Option<PathBuf> {
    let architectures = std::fs::read_dir("/usr/lib").ok()?.filter_map(Result::ok);
    let library = |folder: std::fs::DirEntry| folder.path().join("faketime/libfaketimeMT.so.1");
    architectures.map(library).find(|path| path.exists())
}
