//! The table `queue` of Postgres holds the jobs that have not ended, as they are in `jobs`.

use futures_util::future::join_all;
use sqlx::PgPool;

use super::cluster::Cluster;
use super::*;
use crate::store::{Batches as _, Portable as _, Reader, Writer};

/// What differs between the two tables.
const DIFFERENT: &str = "SELECT concat_ws(' ', 'job:', jobs.id, status, 'queue:', queue)
     FROM (SELECT * FROM jobs WHERE status IN ('queued', 'running')) AS jobs
     FULL JOIN queue ON queue.job_id = jobs.id
     WHERE (queue.job_id, queue.submitter, queue.turn, queue.priority, queue.created_at_ms,
            queue.due_ms, queue.shared, queue.running, queue.worker, queue.started_at_ms)
           IS DISTINCT FROM
           (jobs.id, jobs.submitter, jobs.turn, jobs.priority, jobs.created_at_ms,
            jobs.due_ms, jobs.shared, jobs.status = 'running', jobs.worker, jobs.started_at_ms)";

async fn agree(pool: &PgPool) {
    let different: Vec<String> = sqlx::query_scalar(DIFFERENT).fetch_all(pool).await.unwrap();
    assert!(different.is_empty(), "{different:#?}");
}

/// Checks the tables, and how many jobs wait and run.
async fn holds(pool: &PgPool, queued: i64, running: i64) {
    agree(pool).await;
    let counts: (i64, i64) = sqlx::query_as(
        "SELECT count(*) FILTER (WHERE NOT running), count(*) FILTER (WHERE running) FROM queue",
    )
    .fetch_one(pool)
    .await
    .unwrap();
    assert_eq!(counts, (queued, running), "that wait and that run");
}

async fn opened() -> Option<(PgPool, Postgres)> {
    let address = Cluster::shared()?.database();
    let store = Postgres::open(&address).await.unwrap();
    Some((PgPool::connect(&address).await.unwrap(), store))
}

#[tokio::test]
async fn the_queue_holds_a_job_from_its_start_to_every_way_to_end_it() {
    let Some((pool, store)) = opened().await else { return };
    for outcome in
        [Outcome::Succeeded("{}".into()), Outcome::Failed("{}".into()), Outcome::Cancelled]
    {
        queued_job(&store).await;
        holds(&pool, 1, 0).await;
        let ended = lease(&store, LONG).await.unwrap();
        holds(&pool, 0, 1).await;
        store.heartbeat(&ended, LONG, Some("{}"), &[point(0)]).await.unwrap();
        holds(&pool, 0, 1).await;
        assert!(store.finish(&ended, &outcome).await.unwrap());
        holds(&pool, 0, 0).await;
    }
    let queued = queued_job(&store).await;
    assert_eq!(store.cancel(&all(), &queued).await.unwrap(), Cancelling::Cancelled);
    holds(&pool, 0, 0).await;
    let unwanted = leased_job(&store, LONG).await;
    assert_eq!(store.cancel(&all(), &unwanted.job_id).await.unwrap(), Cancelling::Requested);
    holds(&pool, 0, 1).await;
    assert!(store.hand_back(&unwanted).await.unwrap());
    holds(&pool, 0, 0).await;
}

#[tokio::test]
async fn the_queue_holds_a_job_that_is_handed_back_or_lost_until_it_fails() {
    let Some((pool, store)) = opened().await else { return };
    let handed_back = leased_job(&store, LONG).await;
    assert!(store.hand_back(&handed_back).await.unwrap());
    holds(&pool, 1, 0).await;
    for death in 1..=i64::from(MAX_ATTEMPTS) {
        assert!(lease(&store, EXPIRED).await.is_some());
        holds(&pool, 0, 1).await;
        store.recover_expired(NO_WAIT).await.unwrap();
        holds(&pool, i64::from(death < i64::from(MAX_ATTEMPTS)), 0).await;
    }
    // Two that share a death, of which one is no longer wanted.
    let worker = id();
    queued_job(&store).await;
    let unwanted = queued_job(&store).await;
    for _ in 0..2 {
        store.lease(&worker, EXPIRED).await.unwrap().expect("two are queued");
    }
    store.cancel(&all(), &unwanted).await.unwrap();
    assert_eq!(store.recover_expired(LONG).await.unwrap().requeued, 1);
    holds(&pool, 1, 0).await;
}

#[tokio::test]
async fn the_queue_holds_no_job_that_is_deleted() {
    let Some((pool, store)) = opened().await else { return };
    let running = leased_job(&store, LONG).await;
    let queued = queued_job(&store).await;
    let row = store.job(&all(), &queued_job(&store).await).await.unwrap().unwrap();
    holds(&pool, 2, 1).await;
    assert!(store.delete_job(&all(), &running.job_id).await.unwrap());
    assert!(store.delete_job(&all(), &queued).await.unwrap());
    holds(&pool, 1, 0).await;
    assert!(store.delete_measurement(&all(), &row.measurement_id).await.unwrap());
    holds(&pool, 0, 0).await;
    let ended = leased_job(&store, LONG).await;
    assert!(store.finish(&ended, &Outcome::Cancelled).await.unwrap());
    queued_job(&store).await;
    tokio::time::sleep(Duration::from_millis(5)).await;
    assert_eq!(store.delete_older(Duration::from_millis(1), 9).await.unwrap().jobs, 1);
    holds(&pool, 1, 0).await;
}

#[tokio::test]
async fn the_queue_holds_the_jobs_of_a_batch_as_they_exchange_turns() {
    let Some((pool, store)) = opened().await else { return };
    let measured = stored_measurement(&store).await;
    queued_job_of(&store, &measured, "rig").await;
    let of = vec![measured; 4];
    let batch = NewBatchRow { priority: Priority::High, ..new_batch(&of, "rig") };
    assert_eq!(store.insert_batch(&all(), &batch, None).await.unwrap(), Inserted::Created);
    holds(&pool, 5, 0).await;
    let first = lease(&store, LONG).await.unwrap();
    assert_eq!(first.job_id, batch.jobs[0].job_id, "it goes before the one whose turn it is");
    holds(&pool, 4, 1).await;
    store.cancel_batch(&all(), &batch.id, 2).await.unwrap();
    holds(&pool, 3, 1).await;
    store.cancel_batch(&all(), &batch.id, 9).await.unwrap();
    holds(&pool, 1, 1).await;
    store.delete_batch(&all(), &batch.id, 9).await.unwrap();
    holds(&pool, 1, 0).await;
}

#[tokio::test]
async fn the_queue_holds_what_is_restored_and_has_not_ended() {
    let Some((pool, source)) = opened().await else { return };
    let ended = leased_job(&source, LONG).await;
    assert!(source.finish(&ended, &Outcome::Cancelled).await.unwrap());
    leased_job(&source, LONG).await;
    let unwanted = leased_job(&source, LONG).await;
    source.cancel(&all(), &unwanted.job_id).await.unwrap();
    queued_job(&source).await;
    holds(&pool, 1, 2).await;
    let mut backup = Vec::new();
    let mut writer = Writer::new(&mut backup).unwrap();
    source.back_up(&mut writer).await.unwrap();
    writer.finish().unwrap();
    let Some((pool, target)) = opened().await else { return };
    target.restore(&mut Reader::new(backup.as_slice()).unwrap()).await.unwrap();
    holds(&pool, 2, 0).await;
}

// Whoever locks a row of the queue before that of its job would wait for one who did it the other way.
#[tokio::test]
async fn jobs_are_taken_cancelled_and_deleted_at_once_and_nobody_waits_for_ever() {
    let Some((pool, store)) = opened().await else { return };
    let measured = stored_measurement(&store).await;
    let mut jobs = Vec::new();
    for job in 0..60 {
        jobs.push(queued_job_of(&store, &measured, ["a", "b"][job % 2]).await);
    }
    let take = async || {
        while let Some(lease) = lease(&store, LONG).await {
            store.hand_back(&lease).await.unwrap();
            if let Some(lease) = store.lease("one", LONG).await.unwrap() {
                store.finish(&lease, &Outcome::Cancelled).await.unwrap();
            }
        }
    };
    let cancel = async {
        for job in jobs.iter().step_by(3) {
            store.cancel(&all(), job).await.unwrap();
        }
    };
    let delete = async {
        for job in jobs.iter().skip(1).step_by(3) {
            store.delete_job(&all(), job).await.unwrap();
        }
    };
    tokio::join!(take(), take(), cancel, delete);
    agree(&pool).await;
}

// One that lets another go before it changes its place, maybe after somebody has read where it was.
#[tokio::test]
async fn jobs_that_exchange_turns_while_many_are_taken_are_found_within_a_second() {
    let Some((pool, store)) = opened().await else { return };
    let measured = stored_measurement(&store).await;
    let priorities = [Priority::Low, Priority::Normal, Priority::High];
    for job in 0..300 {
        let submitter = (job % 4).to_string();
        let row = NewJobRow { submitter, priority: priorities[job % 3], ..new_job(&measured) };
        assert_eq!(store.insert_job(&all(), &row, None).await.unwrap(), Inserted::Created);
    }
    let take = async |_| while lease(&store, LONG).await.is_some() {};
    join_all((0..8).map(take)).await;
    // One that exchanges its turn at this moment may be passed over by those who look for the next. The
    // look at the whole queue, once a second, leads to all of them.
    tokio::time::sleep(Duration::from_millis(1100)).await;
    take(0).await;
    holds(&pool, 0, 300).await;
}
