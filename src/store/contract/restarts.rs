//! Postgres restarts under jobs that run; and what a process looks for now and then only.

use sqlx::PgPool;

use super::cluster::Cluster;
use super::*;
use crate::store::Outbox as _;

/// How a lease was that ended while the database was away: it had been renewed for so many milliseconds
/// when the database stopped.
const OUTAGE: &str = "UPDATE jobs SET renewed_at_ms = began - $1 - 60000, lease_until_ms = began - 60000
     FROM (SELECT floor(extract(epoch FROM pg_postmaster_start_time()) * 1000)::bigint AS began) AS up
     WHERE status = 'running'";

/// As long as a look into an empty list of leases is good for, and a little longer.
const A_LOOK: Duration = Duration::from_millis(1100);

async fn opened() -> Option<(PgPool, Postgres)> {
    let address = Cluster::shared()?.database();
    let store = Postgres::open(&address).await.unwrap();
    Some((PgPool::connect(&address).await.unwrap(), store))
}

async fn outage(pool: &PgPool, lease: Duration) {
    let done = sqlx::query(OUTAGE).bind(lease.as_millis() as i64).execute(pool).await.unwrap();
    assert!(done.rows_affected() > 0);
}

#[tokio::test]
async fn a_lease_from_before_a_restart_of_postgres_is_good_for_its_length_once_more() {
    let Some((pool, store)) = opened().await else { return };
    let a_day = Duration::from_secs(24 * 3600);
    for end in 0..3 {
        let lease = leased_job(&store, LONG).await;
        outage(&pool, a_day).await;
        assert_eq!(store.recover_expired(NO_WAIT).await.unwrap(), Recovered::default());
        assert!(match end {
            0 => store.finish(&lease, &Outcome::Cancelled).await.unwrap(),
            1 => {
                assert!(store.hand_back(&lease).await.unwrap());
                store.delete_job(&all(), &lease.job_id).await.unwrap()
            }
            _ => {
                let beat = store.heartbeat(&lease, LONG, None, &[]).await.unwrap();
                beat == Beat::Renewed { cancel_requested: false }
            }
        });
    }
}

#[tokio::test]
async fn a_restart_of_postgres_charges_no_job_whose_worker_is_gone() {
    let Some((pool, store)) = opened().await else { return };
    let job = queued_job(&store).await;
    for _ in 0..2 * MAX_ATTEMPTS {
        assert_eq!(lease(&store, LONG).await.expect("it is queued").job_id, job);
        // Its length is over again since the database started.
        outage(&pool, Duration::from_millis(1)).await;
        tokio::time::sleep(Duration::from_millis(5)).await;
        let recovered = store.recover_expired(NO_WAIT).await.unwrap();
        assert_eq!(recovered, Recovered { requeued: 1, ended: Vec::new() });
    }
    // A death since then is charged.
    for _ in 1..MAX_ATTEMPTS {
        assert!(lease(&store, EXPIRED).await.is_some());
        assert_eq!(store.recover_expired(NO_WAIT).await.unwrap().requeued, 1);
    }
    assert!(lease(&store, EXPIRED).await.is_some());
    assert_eq!(store.recover_expired(NO_WAIT).await.unwrap().ended.len(), 1);
}

#[tokio::test]
async fn an_outage_of_postgres_that_outlasts_a_lease_charges_nobody() {
    let Some(cluster) = Cluster::alone() else { return };
    let address = cluster.database();
    let store = Postgres::open(&address).await.unwrap();
    let short = Duration::from_millis(500);
    let lost = leased_job(&store, short).await;
    cluster.stop();
    tokio::time::sleep(short).await;
    cluster.start_again();
    let requeued = async {
        while store.recover_expired(NO_WAIT).await.unwrap().requeued == 0 {
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
    };
    tokio::time::timeout(LONG, requeued).await.expect("its lease ends");
    let pool = PgPool::connect(&address).await.unwrap();
    let charged = sqlx::query_scalar("SELECT charged FROM jobs WHERE id = $1").bind(&lost.job_id);
    let charged: i64 = charged.fetch_one(&pool).await.unwrap();
    assert_eq!(charged, 0);
}

#[tokio::test]
async fn a_process_that_found_no_expired_lease_looks_again_after_a_second() {
    let Some((_pool, store)) = opened().await else { return };
    assert_eq!(store.recover_expired(NO_WAIT).await.unwrap(), Recovered::default());
    leased_job(&store, EXPIRED).await;
    tokio::time::sleep(A_LOOK).await;
    assert_eq!(store.recover_expired(NO_WAIT).await.unwrap().requeued, 1);
    // It found one: the next look is not put off.
    assert!(lease(&store, EXPIRED).await.is_some());
    assert_eq!(store.recover_expired(NO_WAIT).await.unwrap().requeued, 1);
}

// Numbers are given when a job ends, and seen when its transaction is committed: not in the same order.
#[tokio::test]
async fn an_event_that_is_committed_after_later_ones_is_announced() {
    let Some((pool, store)) = opened().await else { return };
    let lease = leased_job(&store, LONG).await;
    let mut late = pool.begin().await.unwrap();
    let event = "INSERT INTO events (job_id, at_ms) VALUES ($1, 1) RETURNING id";
    let event = sqlx::query_scalar(event).bind(&lease.job_id);
    let event: i64 = event.fetch_one(&mut *late).await.unwrap();
    // Its row is held by the transaction that is late: another job ends.
    let other = leased_job(&store, LONG).await;
    assert!(store.finish(&other, &Outcome::Cancelled).await.unwrap());
    for _ in 0..2 {
        let later = store.events(9).await.unwrap();
        assert_eq!(later.iter().map(|row| &row.job_id).collect::<Vec<_>>(), [&other.job_id]);
        tokio::time::sleep(A_LOOK).await;
    }
    assert_eq!(store.events(9).await.unwrap().len(), 1);
    late.commit().await.unwrap();
    tokio::time::sleep(A_LOOK).await;
    assert_eq!(store.events(9).await.unwrap().first().map(|row| row.id), Some(event));
}
