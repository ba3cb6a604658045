//! How fast the queue is by itself: jobs that compute nothing are queued, taken and ended.
//!
//! `cargo bench --bench queue -- [--database postgres://…]`
//!
//! Without an address on a SQLite file of its own; with one on that database, which has to be empty
//! and is of no use afterwards. Each worker has a store of its own, as a process has.
//!
//! With `--ended N` there are so many ended jobs before, and with `--held SECONDS` a transaction that
//! sees the database as it was is held open meanwhile, which keeps Postgres from forgetting rows:
//! then jobs are queued and taken for so long, `--rate` a second, expired leases are looked for, ends
//! announced and the queue counted beside them, and the time of each is measured as the minutes pass.

mod held;
mod jobs;

use std::sync::Arc;
use std::time::Instant;

use clap::Parser;

use servoscope::store::{Postgres, Sqlite, Store};

/// Stores of the workers, and the folder that ends with them.
type Stores = (Vec<Arc<dyn Store>>, Option<tempfile::TempDir>);

/// Queues, takes and ends jobs that compute nothing.
#[derive(Debug, Parser)]
struct Args {
    /// An empty Postgres database [default: a SQLite file].
    #[arg(long)]
    database: Option<String>,
    /// Jobs.
    #[arg(long, default_value_t = 20_000)]
    jobs: usize,
    /// Workers that take them at the same time.
    #[arg(long, default_value_t = 4)]
    workers: usize,
    /// Jobs that have ended before.
    #[arg(long, default_value_t = 0)]
    ended: i64,
    /// Seconds for which a transaction is held open; Postgres only.
    #[arg(long, default_value_t = 0)]
    held: u64,
    /// Jobs a second meanwhile.
    #[arg(long, default_value_t = 200.0)]
    rate: f64,
    /// What `cargo bench` says to every bench.
    #[arg(long, hide = true)]
    bench: bool,
}

#[tokio::main]
async fn main() {
    let args = Args::parse();
    let load = std::fs::read_to_string("/proc/loadavg").expect("Linux");
    println!("machine: load average {}", load.trim());
    let (stores, folder) = stores(&args).await;
    let measurement = jobs::measurement(stores[0].as_ref()).await;
    if args.ended > 0 {
        let began = Instant::now();
        if let Some(address) = &args.database {
            held::end_many(address, &measurement, args.ended).await;
        } else if let Some(folder) = &folder {
            held::end_many_in(folder.path(), &measurement, args.ended).await;
        }
        println!("{} ended jobs, made in {:.0} s", args.ended, began.elapsed().as_secs_f64());
    }
    let per_second = |count: usize, began: Instant| count as f64 / began.elapsed().as_secs_f64();
    let began = Instant::now();
    jobs::queue(&stores, &measurement, args.jobs).await;
    println!("queued by {} at once: {:.0} a second", args.workers, per_second(args.jobs, began));
    let began = Instant::now();
    let taken = jobs::take_all(&stores).await;
    let rate = per_second(taken.len(), began);
    assert_eq!(taken.len(), args.jobs, "each is taken once");
    println!("taken and ended by {} at once: {rate:.0} a second", args.workers);
    println!("  time to take one, ms: {}", jobs::shares(taken));
    if let Some(address) = &args.database
        && args.held > 0
    {
        held::run(address, &stores, &measurement, args.rate, args.held).await;
    }
}

async fn stores(args: &Args) -> Stores {
    let mut stores: Vec<Arc<dyn Store>> = Vec::new();
    let folder = tempfile::tempdir().expect("a folder");
    for _ in 0..args.workers {
        stores.push(match &args.database {
            Some(address) => Arc::new(Postgres::open(address).await.expect("a database")),
            None => Arc::new(Sqlite::open(folder.path()).await.expect("a database")),
        });
    }
    (stores, args.database.is_none().then_some(folder))
}
