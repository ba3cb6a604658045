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
