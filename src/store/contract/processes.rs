//! Several processes on one store.

use super::cluster::Cluster;
use super::*;

async fn leases_taken_at_once_are_of_different_jobs(first: &dyn Store, second: &dyn Store) {
    let mut queued = Vec::new();
    for _ in 0..8 {
        queued.push(queued_job(first).await);
    }
    let take = async |store: &dyn Store| {
        let mut taken = Vec::new();
        while let Some(lease) = store.lease("one", LONG).await.unwrap() {
            taken.push(lease.job_id);
        }
        taken
    };
    let (mut taken, others) = tokio::join!(take(first), take(second));
    taken.extend(others);
    taken.sort();
    assert_eq!(taken, queued);
}

#[tokio::test]
async fn leases_taken_at_once_from_two_connections_to_sqlite_are_of_different_jobs() {
    let directory = tempfile::tempdir().unwrap();
    let first = Sqlite::open(directory.path()).await.unwrap();
    let second = Sqlite::open(directory.path()).await.unwrap();
    leases_taken_at_once_are_of_different_jobs(&first, &second).await;
}

#[tokio::test]
async fn processes_that_start_at_once_on_a_new_folder_share_its_queue() {
    let directory = tempfile::tempdir().unwrap();
    let opened = futures_util::future::join_all((0..8).map(|_| Sqlite::open(directory.path())));
    let stores: Vec<Sqlite> = opened.await.into_iter().map(Result::unwrap).collect();
    leases_taken_at_once_are_of_different_jobs(&stores[0], &stores[7]).await;
}

#[tokio::test]
async fn two_processes_that_start_at_once_on_an_empty_postgres_share_its_queue() {
    let Some(cluster) = Cluster::shared() else { return };
    let address = cluster.database();
    let (first, second) = tokio::join!(Postgres::open(&address), Postgres::open(&address));
    leases_taken_at_once_are_of_different_jobs(&first.unwrap(), &second.unwrap()).await;
}

#[tokio::test]
async fn processes_on_one_postgres_hear_what_others_do() {
    let Some(cluster) = Cluster::shared() else { return };
    let address = cluster.database();
    let store = Postgres::open(&address).await.unwrap();
    let other = Postgres::open(&address).await.unwrap();
    let (sender, mut said) = tokio::sync::mpsc::unbounded_channel();
    tokio::spawn(async move { other.listen(&move |wake| sender.send(wake).unwrap()).await });
    let mut heard = async |wakes: &[Wake]| {
        for wake in wakes {
            assert_eq!(said.recv().await, Some(*wake));
        }
    };
    heard(&Wake::ALL).await;
    let lease = leased_job(&store, LONG).await;
    heard(&[Wake::Queued, Wake::Changed]).await;
    store.heartbeat(&lease, LONG, None, &[]).await.unwrap();
    store.heartbeat(&lease, LONG, Some("{}"), &[point(0)]).await.unwrap();
    heard(&[Wake::Changed]).await;
    store.cancel(&all(), &lease.job_id).await.unwrap();
    heard(&[Wake::Unwanted, Wake::Changed]).await;
    store.finish(&lease, &Outcome::Cancelled).await.unwrap();
    heard(&[Wake::Ended]).await;
    store.delete_job(&all(), &lease.job_id).await.unwrap();
    heard(&[Wake::Unwanted, Wake::Ended]).await;
}

// Two that looked at once could each see a part of the jobs that died together, and charge them as if each
// had been alone.
#[tokio::test]
async fn expired_leases_are_judged_by_one_process_at_a_time() {
    let Some(cluster) = Cluster::shared() else { return };
    let address = cluster.database();
    let store = Postgres::open(&address).await.unwrap();
    let lease = leased_job(&store, EXPIRED).await;
    let other = sqlx::PgPool::connect(&address).await.unwrap();
    let mut judging = other.begin().await.unwrap();
    let lock = "SELECT pg_advisory_xact_lock(hashtext('recovery'), 0)";
    sqlx::query(lock).execute(&mut *judging).await.unwrap();
    assert_eq!(store.recover_expired(NO_WAIT).await.unwrap(), Recovered::default());
    judging.rollback().await.unwrap();
    assert_eq!(store.recover_expired(NO_WAIT).await.unwrap().requeued, 1);
    assert_eq!(status(&store, &lease.job_id).await, Status::Queued);
}

#[tokio::test]
async fn a_store_goes_on_when_its_postgres_was_killed_and_is_back() {
    let Some(cluster) = Cluster::alone() else { return };
    let store = Postgres::open(&cluster.database()).await.unwrap();
    let lease = leased_job(&store, LONG).await;
    cluster.stop();
    cluster.start_again();
    assert!(store.finish(&lease, &Outcome::Succeeded("{}".into())).await.unwrap());
    assert_eq!(status(&store, &lease.job_id).await, Status::Succeeded);
}

/// What a newer version of the program may do to the tables while this one runs.
const NEWER: [&str; 5] = [
    "ALTER TABLE jobs ADD COLUMN mood TEXT",
    "ALTER TABLE measurements ADD COLUMN mood INTEGER NOT NULL DEFAULT 0",
    "CREATE TABLE moods (job_id TEXT REFERENCES jobs (id) ON DELETE CASCADE)",
    "CREATE INDEX jobs_by_mood ON jobs (mood)",
    "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time)
     VALUES (9999, 'moods', TRUE, '', 0)",
];

/// Everything that goes on in a server, on a store that is open.
async fn goes_on(store: &dyn Store) {
    let ended = leased_job(store, LONG).await;
    let renewed = store.heartbeat(&ended, LONG, Some("{}"), &[point(0)]).await.unwrap();
    assert_eq!(renewed, Beat::Renewed { cancel_requested: false });
    assert!(store.finish(&ended, &Outcome::Succeeded("{}".into())).await.unwrap());
    assert_eq!(store.result(&all(), &ended.job_id).await.unwrap().as_deref(), Some("{}"));
    let page = Page { limit: 10, before: None };
    assert!(!store.jobs(&all(), &JobFilter::default(), &page).await.unwrap().is_empty());
    let measured = store.measurement(&all(), &ended.measurement_id).await.unwrap();
    assert!(measured.is_some());
    assert!(store.delete_job(&all(), &ended.job_id).await.unwrap());
}

#[tokio::test]
async fn a_folder_of_a_newer_version_is_refused_and_an_older_server_goes_on() {
    let directory = tempfile::tempdir().unwrap();
    let store = Sqlite::open(directory.path()).await.unwrap();
    goes_on(&store).await;
    let file = format!("sqlite://{}/servoscope.sqlite3", directory.path().display());
    let newer = sqlx::SqlitePool::connect(&file).await.unwrap();
    for statement in NEWER {
        sqlx::query(statement).execute(&newer).await.unwrap();
    }
    goes_on(&store).await;
    for opened in
        [Sqlite::open(directory.path()).await, Sqlite::open_existing(directory.path()).await]
    {
        assert!(matches!(opened, Err(StoreError::Newer)), "{opened:?}");
    }
    sqlx::query("DELETE FROM _sqlx_migrations WHERE version > 1").execute(&newer).await.unwrap();
    let older = Sqlite::open_existing(directory.path()).await;
    assert!(matches!(older, Err(StoreError::Older)), "{older:?}");
}

#[tokio::test]
async fn a_postgres_of_a_newer_version_is_refused_and_an_older_server_goes_on() {
    let Some(cluster) = Cluster::shared() else { return };
    let address = cluster.database();
    let none = Postgres::open_existing(&address).await;
    assert!(matches!(none, Err(StoreError::Older)), "{none:?}");
    let store = Postgres::open(&address).await.unwrap();
    goes_on(&store).await;
    let newer = sqlx::PgPool::connect(&address).await.unwrap();
    for statement in NEWER {
        sqlx::query(statement).execute(&newer).await.unwrap();
    }
    goes_on(&store).await;
    for opened in [Postgres::open(&address).await, Postgres::open_existing(&address).await] {
        assert!(matches!(opened, Err(StoreError::Newer)), "{opened:?}");
    }
}
