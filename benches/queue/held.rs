//! A database that has a million ended jobs, and a Postgres that may forget no row.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use servoscope::store::Store;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{Connection as _, PgConnection, SqliteConnection};

use super::jobs;

/// How often times are printed.
const MINUTE: Duration = Duration::from_secs(60);

/// Makes jobs that have ended in a Postgres.
pub async fn end_many(address: &str, measurement: &str, count: i64) {
    let mut connection = PgConnection::connect(address).await.expect("a database");
    sqlx::query(
        "INSERT INTO jobs (id, measurement_id, owner, submitter, turn, kind, request, status,
                           attempt, created_at_ms, started_at_ms, finished_at_ms, result)
         SELECT 'ended ' || n, $1, '', '', n, 'identify', '{}', 'succeeded', 1, 1, 1, n,
                repeat('x', 500)
         FROM generate_series(1, $2) AS n",
    )
    .bind(measurement)
    .bind(count)
    .execute(&mut connection)
    .await
    .expect("they are stored");
    sqlx::query("ANALYZE").execute(&mut connection).await.expect("it is done");
}

/// The same in a folder.
pub async fn end_many_in(folder: &Path, measurement: &str, count: i64) {
    let options = SqliteConnectOptions::new().filename(folder.join("servoscope.sqlite3"));
    let mut connection = SqliteConnection::connect_with(&options).await.expect("a database");
    sqlx::query(
        "WITH RECURSIVE numbers (n) AS (
             SELECT 1 UNION ALL SELECT n + 1 FROM numbers WHERE n < ?2)
         INSERT INTO jobs (id, measurement_id, owner, submitter, turn, kind, request, status,
                           attempt, created_at_ms, started_at_ms, finished_at_ms, result)
         SELECT 'ended ' || n, ?1, '', '', n, 'identify', '{}', 'succeeded', 1, 1, 1, n,
                hex(zeroblob(250))
         FROM numbers",
    )
    .bind(measurement)
    .bind(count)
    .execute(&mut connection)
    .await
    .expect("they are stored");
}

/// How long each thing took that goes on beside a queue.
#[derive(Default)]
struct Times {
    take: Vec<Duration>,
    recover: Vec<Duration>,
    announce: Vec<Duration>,
    state: Vec<Duration>,
}

impl Times {
    /// One job comes, is taken and ends, as in a server: with a look for expired leases before, and
    /// word to nobody afterwards.
    async fn one(&mut self, store: &dyn Store, measurement: &str) {
        jobs::queue_one(store, measurement, "").await;
        let began = Instant::now();
        store.recover_expired(Duration::ZERO).await.expect("leases are read");
        self.recover.push(began.elapsed());
        let (lease, time) = jobs::take(store, "one").await.expect("one is queued");
        self.take.push(time);
        jobs::end(store, &lease).await;
        let began = Instant::now();
        for event in store.events(100).await.expect("events are read") {
            store.announce(event.id, &[]).await.expect("it is stored");
        }
        self.announce.push(began.elapsed());
        let began = Instant::now();
        store.queue().await.expect("it is counted");
        self.state.push(began.elapsed());
    }

    fn print(self) {
        println!("    taken: {}", jobs::shares(self.take));
        println!("    leases looked at: {}", jobs::shares(self.recover));
        println!("    ends announced: {}", jobs::shares(self.announce));
        println!("    queue counted: {}", jobs::shares(self.state));
    }
}

/// Queues and takes jobs for so many seconds while a transaction is held open.
pub async fn run(
    address: &str,
    stores: &[Arc<dyn Store>],
    measurement: &str,
    rate: f64,
    seconds: u64,
) {
    // Ends from before are nobody's news.
    let store = stores[0].as_ref();
    loop {
        let events = store.events(1000).await.expect("events are read");
        if events.is_empty() {
            break;
        }
        for event in events {
            store.announce(event.id, &[]).await.expect("it is stored");
        }
    }
    let mut connection = PgConnection::connect(address).await.expect("a database");
    let mut held = connection
        .begin_with("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY")
        .await
        .expect("it begins");
    let seen: i64 = sqlx::query_scalar("SELECT count(*) FROM jobs")
        .fetch_one(&mut *held)
        .await
        .expect("it is read");
    println!("a transaction that sees {seen} jobs is held; {rate} jobs a second come and go");
    let began = Instant::now();
    let (mut times, mut printed, mut done) = (Times::default(), began, 0_u32);
    while began.elapsed() < Duration::from_secs(seconds) {
        let due = began + Duration::from_secs_f64(f64::from(done) / rate);
        tokio::time::sleep_until(due.into()).await;
        times.one(stores[done as usize % stores.len()].as_ref(), measurement).await;
        done += 1;
        if printed.elapsed() >= MINUTE {
            println!("  minute {}, {done} jobs so far, ms:", began.elapsed().as_secs() / 60);
            times.print();
            (times, printed) = (Times::default(), Instant::now());
        }
    }
    held.rollback().await.expect("it ends");
}
