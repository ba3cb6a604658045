//! A database of every earlier version keeps what it holds, and goes on.
//!
//! Rows are written in the words of the version whose step is the last one done. A step that renames
//! or makes tables anew must take them along.

use std::path::Path;

use sqlx::postgres::PgPoolOptions;
use sqlx::sqlite::{SqliteConnectOptions, SqlitePoolOptions};
use sqlx::{PgPool, SqlitePool};

use super::cluster::Cluster;
use super::*;
use crate::store::{postgres, sqlite};

/// What each step of SQLite lets be stored.
const OF_SQLITE: [&str; 5] = [
    "INSERT INTO measurements (id, created_at_ms, name, machine, axis, labels, sha256, experiments,
         highest_harmonic, magnitude_min, magnitude_max, omega_min_rad_s, omega_max_rad_s, notes)
     VALUES ('m', 1, 'tab', 'press', 'x', '{}', '00', 2, 9, 1, 3, 0.5, 200, '[]');
     INSERT INTO measurement_files (measurement_id, position, name, content_type, bytes)
     VALUES ('m', 0, 'a.csv', 'text/csv', CAST('bytes' AS BLOB));
     INSERT INTO jobs (id, measurement_id, kind, request, status, attempt, created_at_ms,
         started_at_ms, finished_at_ms, result)
     VALUES ('done', 'm', 'identify', '{}', 'succeeded', 1, 2, 3, 4, '{\"a\":1}'),
            ('waits', 'm', 'diagnose', '{}', 'queued', 0, 5, NULL, NULL, NULL);
     INSERT INTO convergence (job_id, attempt, seq, stage, cycle, evaluations, best, elapsed_s)
     VALUES ('done', 1, 0, 'colony', 0, 20, 0.5, 0.1);
     INSERT INTO idempotency_keys (scope, key, body_sha256, resource_id, created_at_ms)
     VALUES ('measurement', 'k', 'body', 'm', 1);",
    "INSERT INTO probe (id, at_ms) VALUES (1, 1);",
    "INSERT INTO webhooks (id, created_at_ms, url, secret, events)
     VALUES ('hook', 1, 'https://receiver.example', 'whsec_x', '[\"job.finished\"]');
     INSERT INTO deliveries (id, webhook_id, event, topic, body, status, created_at_ms, due_ms)
     VALUES ('msg', 'hook', 'job.finished', 't', '{}', 'waiting', 1, 1);",
    "INSERT INTO mappings (name, settings, layout, updated_at_ms) VALUES ('map', '{}', 'l', 1);",
    "INSERT INTO keys (id, name, scopes, sha256, created_at_ms) VALUES ('rig', 'r', '[]', '00', 1);
     INSERT INTO sessions (sha256, key_id, expires_at_ms) VALUES ('cookie', 'rig', 9000000000000);
     UPDATE jobs SET owner = 'rig', finished_at_ms = 8 WHERE id = 'done';",
];

/// The same of the first step of Postgres.
const OF_POSTGRES: &str =
    "INSERT INTO measurements (id, created_at_ms, owner, name, machine, axis, labels, sha256,
         experiments, highest_harmonic, magnitude_min, magnitude_max, omega_min_rad_s,
         omega_max_rad_s, notes)
     VALUES ('m', 1, '', 'tab', 'press', 'x', '{}', '00', 2, 9, 1, 3, 0.5, 200, '[]');
     INSERT INTO measurement_files (measurement_id, position, name, content_type, bytes)
     VALUES ('m', 0, 'a.csv', 'text/csv', 'bytes');
     INSERT INTO jobs (id, measurement_id, owner, submitter, turn, kind, request, status, attempt,
         created_at_ms, started_at_ms, finished_at_ms, result)
     VALUES ('done', 'm', 'rig', '', 0, 'identify', '{}', 'succeeded', 1, 2, 3, 8, '{\"a\":1}'),
            ('waits', 'm', '', '', 0, 'diagnose', '{}', 'queued', 0, 5, NULL, NULL, NULL);
     INSERT INTO convergence (job_id, attempt, seq, stage, cycle, evaluations, best, elapsed_s)
     VALUES ('done', 1, 0, 'colony', 0, 20, 0.5, 0.1);
     INSERT INTO idempotency_keys (owner, scope, key, body_sha256, resource_id, created_at_ms)
     VALUES ('', 'measurement', 'k', 'body', 'm', 1);
     INSERT INTO webhooks (id, created_at_ms, owner, url, secret, events)
     VALUES ('hook', 1, '', 'https://receiver.example', 'whsec_x', '[\"job.finished\"]');
     INSERT INTO deliveries (id, webhook_id, event, topic, body, status, created_at_ms, due_ms)
     VALUES ('msg', 'hook', 'job.finished', 't', '{}', 'waiting', 1, 1);
     INSERT INTO mappings (owner, name, settings, layout, updated_at_ms)
     VALUES ('', 'map', '{}', 'l', 1);
     INSERT INTO keys (id, name, scopes, sha256, created_at_ms) VALUES ('rig', 'r', '[]', '00', 1);
     INSERT INTO sessions (sha256, key_id, expires_at_ms) VALUES ('cookie', 'rig', 9000000000000);";

/// The rows of the first steps are there, and the job that waits is computed.
async fn holds(store: &dyn Store, sqlite_steps: usize) {
    let kept = store.measurement(&all(), "m").await.unwrap().expect("the measurement is kept");
    assert_eq!((kept.name.as_deref(), kept.experiments), (Some("tab"), 2));
    assert_eq!(store.measurement_files(&all(), "m").await.unwrap(), [file(b"bytes")]);
    assert_eq!(store.result(&all(), "done").await.unwrap().as_deref(), Some(r#"{"a":1}"#));
    assert_eq!(store.convergence(&all(), "done").await.unwrap().len(), 1);
    let key = key("k", "body");
    let again = store.insert_measurement(&all(), &measurement(&id()), &[], Some(&key)).await;
    assert_eq!(again.unwrap(), Inserted::Replayed("m".into()));
    if sqlite_steps >= 3 {
        assert_eq!(store.webhooks(&all(), None).await.unwrap().len(), 1);
        assert_eq!(store.waiting().await.unwrap(), 1);
    }
    if sqlite_steps >= 4 {
        assert!(store.mapping(&all(), "map").await.unwrap().is_some());
    }
    if sqlite_steps >= 5 {
        assert_eq!(store.key("rig").await.unwrap().map(|key| key.quotas), Some("{}".into()));
        assert!(store.session("cookie").await.unwrap().is_some());
        let ever = Duration::from_secs(9_000_000_000);
        assert_eq!(store.usage("rig", ever).await.unwrap().computed_ms, 5);
    }
    let lease = lease(store, LONG).await.expect("a job waits");
    assert_eq!(lease.job_id, "waits");
    assert!(store.finish(&lease, &Outcome::Succeeded("{}".into())).await.unwrap());
    assert_eq!(status(store, "waits").await, Status::Succeeded);
}

/// A file on which so many steps were done, with rows of each.
async fn file_of(folder: &Path, steps: usize) -> SqlitePool {
    let path = folder.join(sqlite::FILE_NAME);
    let options = SqliteConnectOptions::new().filename(path).create_if_missing(true);
    let pool = SqlitePoolOptions::new().max_connections(1).connect_with(options).await.unwrap();
    for step in 1..=steps {
        sqlite::migrations::first(step).run(&pool).await.unwrap();
        if let Some(rows) = OF_SQLITE.get(step - 1) {
            sqlx::raw_sql(*rows).execute(&pool).await.unwrap();
        }
    }
    pool
}

/// The same of a database of Postgres.
async fn database_of(address: &str, steps: usize) -> PgPool {
    let pool = PgPoolOptions::new().max_connections(1).connect(address).await.unwrap();
    postgres::migrations::first(1).run(&pool).await.unwrap();
    sqlx::raw_sql(OF_POSTGRES).execute(&pool).await.unwrap();
    postgres::migrations::first(steps).run(&pool).await.unwrap();
    pool
}

#[tokio::test]
async fn a_file_of_every_earlier_version_keeps_what_it_holds() {
    for before in 1..=sqlite::migrations::COUNT {
        let folder = tempfile::tempdir().unwrap();
        file_of(folder.path(), before).await.close().await;
        holds(&Sqlite::open(folder.path()).await.unwrap(), before).await;
    }
}

#[tokio::test]
async fn a_postgres_of_every_earlier_version_keeps_what_it_holds() {
    let Some(cluster) = Cluster::shared() else { return };
    for before in 1..=postgres::migrations::COUNT {
        let address = cluster.database();
        database_of(&address, before).await.close().await;
        holds(&Postgres::open(&address).await.unwrap(), OF_SQLITE.len()).await;
    }
}

#[tokio::test]
async fn a_file_that_has_the_quotas_of_keys_under_another_number_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let pool = file_of(folder.path(), 8).await;
    let other = "UPDATE _sqlx_migrations SET version = 9 WHERE version = 8";
    assert_eq!(sqlx::query(other).execute(&pool).await.unwrap().rows_affected(), 1);
    pool.close().await;
    holds(&Sqlite::open(folder.path()).await.unwrap(), 8).await;
}

#[tokio::test]
async fn a_postgres_that_has_the_quotas_of_keys_under_another_number_goes_on() {
    let Some(cluster) = Cluster::shared() else { return };
    let address = cluster.database();
    let pool = database_of(&address, 4).await;
    let other = "UPDATE _sqlx_migrations SET version = 5 WHERE version = 4";
    assert_eq!(sqlx::query(other).execute(&pool).await.unwrap().rows_affected(), 1);
    pool.close().await;
    holds(&Postgres::open(&address).await.unwrap(), OF_SQLITE.len()).await;
}
