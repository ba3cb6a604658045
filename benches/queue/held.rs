//! A Postgres that has a million ended jobs and may forget no row.

use std::sync::Arc;
use std::time::{Duration, Instant};

use servoscope::store::Store;
use sqlx::{Connection as _, PgConnection};

use super::jobs;

/// How often times are printed.
const MINUTE: Duration = Duration::from_secs(60);

/// Makes jobs that have ended.
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

/// Queues and takes jobs for so many seconds while a transaction is held open.
pub async fn run(
    address: &str,
    stores: &[Arc<dyn Store>],
    measurement: &str,
    rate: f64,
    seconds: u64,
) {
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
    let (mut times, mut printed, mut done) = (Vec::new(), began, 0_u32);
    while began.elapsed() < Duration::from_secs(seconds) {
        let due = began + Duration::from_secs_f64(f64::from(done) / rate);
        tokio::time::sleep_until(due.into()).await;
        let store = stores[done as usize % stores.len()].as_ref();
        jobs::queue_one(store, measurement, "").await;
        let (lease, time) = jobs::take(store, "one").await.expect("one is queued");
        times.push(time);
        jobs::end(store, &lease).await;
        done += 1;
        if printed.elapsed() >= MINUTE {
            let at = began.elapsed().as_secs() / 60;
            println!("  minute {at}, {done} jobs so far: {}", jobs::shares(times));
            (times, printed) = (Vec::new(), Instant::now());
        }
    }
    held.rollback().await.expect("it ends");
}
