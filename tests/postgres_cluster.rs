//! A throw-away Postgres for tests, of the unit tests and the integration tests alike.

use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

/// A cluster in a folder of its own, which listens on a socket there and nowhere else.
pub struct Cluster {
    programs: PathBuf,
    folder: PathBuf,
    databases: AtomicU32,
    /// Stops it and removes the folder once this process has ended, however it ends.
    guard: Child,
}

impl Cluster {
    /// The one that all tests of this process share; `None` where there is no Postgres: the test is
    /// skipped. With `SERVO_REQUIRE_POSTGRES` set that is a failure.
    pub fn shared() -> Option<&'static Self> {
        static SHARED: OnceLock<Option<Cluster>> = OnceLock::new();
        let shared = SHARED.get_or_init(|| programs().map(|programs| Cluster::start(&programs)));
        if shared.is_none() {
            absent();
        }
        shared.as_ref()
    }

    /// One for a test alone.
    pub fn alone() -> Option<Self> {
        let Some(programs) = programs() else {
            absent();
            return None;
        };
        Some(Self::start(&programs))
    }

    fn start(programs: &Path) -> Self {
        let folder = tempfile::Builder::new().prefix("pg").tempdir().unwrap().keep();
        if is_root() {
            run(Command::new("chown").arg("nobody").arg(&folder));
        }
        // The pipe to it closes when this process is gone. A signal to the whole group must not end
        // it before.
        let script = "trap '' HUP INT TERM; cat >/dev/null; \
                      \"$0/pg_ctl\" -D \"$1/data\" -m immediate stop; rm -rf \"$1\"";
        let mut guard = unprivileged(OsStr::new("sh"));
        guard.args(["-c", script]).arg(programs).arg(&folder);
        let guard = guard.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
        let guard = guard.spawn().unwrap();
        let cluster =
            Self { programs: programs.to_owned(), folder, databases: AtomicU32::new(0), guard };
        let mut init = cluster.program("initdb");
        init.args(["--no-sync", "--auth=trust", "--username=postgres", "--encoding=UTF8"]);
        run(init.args(["--locale=C.UTF-8", "--pgdata"]).arg(cluster.data()));
        let settings = format!(
            "listen_addresses = ''\nunix_socket_directories = '{}'\nmax_connections = 300\n\
             fsync = off\nfull_page_writes = off\n",
            cluster.folder.display()
        );
        let file = cluster.data().join("postgresql.auto.conf");
        std::fs::write(file, settings).unwrap();
        cluster.run_server();
        cluster
    }

    fn data(&self) -> PathBuf {
        self.folder.join("data")
    }

    /// One of the programs of Postgres, as the user that the cluster belongs to.
    pub fn program(&self, name: &str) -> Command {
        unprivileged(self.programs.join(name).as_os_str())
    }

    fn run_server(&self) {
        let mut start = self.program("pg_ctl");
        start.arg("-D").arg(self.data()).args(["-w", "-l"]).arg(self.folder.join("log"));
        run(start.arg("start"));
    }

    /// Stops the server without a chance to clean up, as a power cut does.
    pub fn stop(&self) {
        let mut stop = self.program("pg_ctl");
        run(stop.arg("-D").arg(self.data()).args(["-m", "immediate", "-w", "stop"]));
    }

    /// Starts it again.
    pub fn start_again(&self) {
        self.run_server();
    }

    /// The address of a new database.
    pub fn database(&self) -> String {
        let number = self.databases.fetch_add(1, Ordering::Relaxed);
        let mut create = self.program("createdb");
        create.arg("--host").arg(&self.folder).args(["--username=postgres"]);
        run(create.arg(format!("test_{number}")));
        format!("postgres://postgres@localhost/test_{number}?host={}", self.folder.display())
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        // The guard sees the end of the pipe, and cleans up.
        drop(self.guard.stdin.take());
        let _ = self.guard.wait();
    }
}

/// The newest of Debian's, or those on the path.
fn programs() -> Option<PathBuf> {
    let versions = std::fs::read_dir("/usr/lib/postgresql").into_iter().flatten().flatten();
    let mut debian: Vec<PathBuf> = versions.map(|version| version.path().join("bin")).collect();
    debian.sort();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let mut all = debian.into_iter().rev().chain(std::env::split_paths(&path));
    all.find(|folder| {
        ["initdb", "pg_ctl", "createdb"].iter().all(|name| folder.join(name).exists())
    })
}

fn absent() {
    let required = std::env::var_os("SERVO_REQUIRE_POSTGRES").is_some();
    assert!(!required, "postgres is absent");
    // Past the capture of a passing test's output; where it is closed nobody reads it.
    let _ = writeln!(std::io::stderr(), "SKIPPED: postgres is absent");
}

fn is_root() -> bool {
    rustix::process::geteuid().is_root()
}

/// Postgres refuses to be run by root.
fn unprivileged(program: &OsStr) -> Command {
    if !is_root() {
        return Command::new(program);
    }
    let mut command = Command::new("setpriv");
    command.args(["--reuid=nobody", "--regid=nogroup", "--clear-groups", "--"]).arg(program);
    command.current_dir("/");
    command
}

/// Runs a program, which must succeed.
pub fn run(command: &mut Command) {
    let output = command.stdin(Stdio::null()).output().unwrap();
    assert!(output.status.success(), "{command:?}: {output:?}");
}
