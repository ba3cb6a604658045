//! How the service stands up to many callers while it computes, and what memory it
//! takes.
//!
//! `cargo bench --bench load`
//!
//! It starts the server itself, on the same machine and with default settings, in
//! four acts: uploads as large as may be, and many small ones; thousands of jobs queued; and callers
//! who ask over 64 kept connections how the jobs stand that are being computed.
//! The callers ask when their schedule says, not when the answer before has come
//! (an open loop), and an answer's time counts from the scheduled moment, so that
//! a server that stalls cannot hide the requests it kept from being sent.

mod memory;
mod polls;
mod server;
mod upload;
mod watched;

use std::time::{Duration, Instant};

use clap::Parser;
use serde_json::json;

use polls::Plan;
use server::Server;
use watched::Watched;

/// Every so many-th job is a diagnosis, the others are identifications.
const DIAGNOSIS_EVERY: u64 = 4;

/// Small uploads, and callers that send them.
const UPLOADS: usize = 4000;
const UPLOADERS: usize = 8;

/// How long jobs run before callers come.
const WARM_UP: Duration = Duration::from_secs(3);

/// Asks a server more than it should like.
#[derive(Debug, Parser)]
struct Args {
    /// Requests a second, all connections together.
    #[arg(long, default_value_t = 2000.0)]
    rate: f64,
    /// Connections that are kept.
    #[arg(long, default_value_t = 64)]
    connections: u64,
    /// How long the callers ask.
    #[arg(long, default_value_t = 30)]
    seconds: u64,
    /// Jobs that are queued before they do.
    #[arg(long, default_value_t = 10_000)]
    jobs: u64,
    /// Leaves out the uploads.
    #[arg(long)]
    no_uploads: bool,
    /// An empty Postgres database in place of a SQLite file; only one server is started, and the
    /// largest uploads are left out.
    #[arg(long)]
    database: Option<String>,
    /// What `cargo bench` says to every bench.
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() {
    let args = Args::parse();
    println!("machine: {} cores, load average {}", cores(), memory::load_average());
    if !args.no_uploads && args.database.is_none() {
        println!("\nlargest uploads");
        uploads();
    }
    let server = Server::start(args.database.as_deref());
    if !args.no_uploads {
        println!("\nsmall uploads");
        small_uploads(&server);
    }
    println!("\njobs");
    let jobs = queue(&server, args.jobs);
    println!("\npolls");
    poll(&server, jobs, &args);
}

/// Each on a server of its own: what one leaves behind is not the other's.
fn uploads() {
    for (name, encoding, bytes) in upload::largest() {
        let server = Server::start(None);
        let before = server.memory().resident;
        let began = Instant::now();
        let stored = server.upload(&bytes, encoding);
        let (took, after) = (began.elapsed().as_secs_f64(), server.memory());
        assert!(stored["experiments"].as_u64() > Some(0), "{stored}");
        println!(
            "  {name}: taken in {took:.1} s; resident {before} before, {} at most, {} after",
            after.peak, after.resident
        );
    }
}

/// From several callers at once, each one after the other.
fn small_uploads(server: &Server) {
    let table = server::simulated(&["--noise-db", "60"]);
    let began = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..UPLOADERS {
            scope.spawn(|| {
                let agent = server::agent();
                for _ in 0..UPLOADS / UPLOADERS {
                    server.upload_with(&agent, &table, None);
                }
            });
        }
    });
    let rate = UPLOADS as f64 / began.elapsed().as_secs_f64();
    println!("  {UPLOADS} of {} KiB by {UPLOADERS} callers: {rate:.0} a second", table.len() >> 10);
}

/// Queues real jobs, and gives their ids in the order in which they run.
fn queue(server: &Server, count: u64) -> Vec<String> {
    let table = server::simulated(&["--fs-plus", "0.8", "--fs-minus", "0.6", "--noise-db", "60"]);
    let measurement = server.upload(&table, None)["id"].clone();
    let before = server.memory().resident;
    let began = Instant::now();
    let submit = |seed: u64| {
        let kind = if seed.is_multiple_of(DIAGNOSIS_EVERY) { "diagnose" } else { "identify" };
        server.submit(&json!({
            "measurement_id": measurement, "kind": kind, "options": {"seed": seed},
        }))
    };
    let ids = (1..=count).map(submit).collect();
    let rate = count as f64 / began.elapsed().as_secs_f64();
    let after = server.memory();
    println!(
        "  {count} submitted one after the other, {rate:.0} a second, while the first ones run; \
         resident {before} before, {} at most, {} after",
        after.peak, after.resident
    );
    ids
}

fn poll(server: &Server, jobs: Vec<String>, args: &Args) {
    std::thread::sleep(WARM_UP);
    let plan = Plan {
        rate: args.rate,
        connections: args.connections,
        duration: Duration::from_secs(args.seconds),
    };
    let watched = Watched::new(jobs);
    let (jobs_before, idle_before) = (server.jobs_ended(), memory::idle_seconds());
    let began = Instant::now();
    let outcome = polls::run(server.address(), &plan, &watched);
    let core_seconds = cores() * began.elapsed().as_secs_f64();
    let idle = (memory::idle_seconds() - idle_before) / core_seconds;
    let jobs_ended = server.jobs_ended() - jobs_before;
    let seen = watched.seen();
    println!(
        "  {} connections, {:.0} requests a second scheduled for {} s, at random",
        plan.connections, plan.rate, args.seconds
    );
    println!("  answered: {:.0} a second, {} refused", outcome.rate(), outcome.refused);
    let at = |share| outcome.latency(share).as_secs_f64() * 1e3;
    println!(
        "  time to the answer from the scheduled moment, ms: median {:.2}, 90 % {:.2}, \
         99 % {:.2}, 99.9 % {:.2}, at most {:.2}",
        at(0.5),
        at(0.9),
        at(0.99),
        at(0.999),
        at(1.0)
    );
    println!(
        "  {} answers told something new; {} queued, {} running, {} ended",
        seen.changed, seen.queued, seen.running, seen.ended
    );
    println!(
        "  meanwhile {jobs_ended} jobs ended, and the cores were idle for {:.1} % of the time",
        100.0 * idle
    );
    let memory = server.memory();
    println!("  resident {}, {} at most", memory.resident, memory.peak);
    println!("machine: load average {}", memory::load_average());
}

fn cores() -> f64 {
    std::thread::available_parallelism().map_or(1.0, |cores| cores.get() as f64)
}
