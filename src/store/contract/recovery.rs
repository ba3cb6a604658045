//! Jobs whose workers die.

use super::*;

/// A lease that is still good when the next one is taken or renewed: workers die with all of them.
const SHORT: Duration = Duration::from_millis(500);

/// Those of the jobs that ended as failed.
async fn failed(store: &dyn Store, jobs: &[String]) -> Vec<String> {
    let mut failed = Vec::new();
    for job in jobs {
        if status(store, job).await == Status::Failed {
            failed.push(job.clone());
        }
    }
    failed
}

async fn queued_jobs(store: &dyn Store, count: usize) -> Vec<String> {
    let mut jobs = Vec::new();
    for _ in 0..count {
        jobs.push(queued_job(store).await);
    }
    jobs
}

/// A worker of `slots` places takes what it gets, and dies.
async fn dies(store: &dyn Store, slots: usize) -> Vec<String> {
    let worker = id();
    let mut in_hand = Vec::new();
    while in_hand.len() < slots
        && let Some(lease) = store.lease(&worker, SHORT).await.unwrap()
    {
        in_hand.push(lease.job_id);
    }
    if !in_hand.is_empty() {
        tokio::time::sleep(SHORT).await;
    }
    in_hand
}

pub(super) async fn a_job_that_kills_its_workers_fails_after_the_last_attempt(store: &dyn Store) {
    let job = queued_job(store).await;
    for _ in 1..MAX_ATTEMPTS {
        lease(store, EXPIRED).await.expect("it is queued");
        assert_eq!(store.recover_expired(NO_WAIT).await.unwrap().requeued, 1);
    }
    lease(store, EXPIRED).await.expect("it is queued a last time");
    let recovered = store.recover_expired(NO_WAIT).await.unwrap();
    let ended = EndedRow { kind: "identify".into(), status: Status::Failed };
    assert_eq!(recovered, Recovered { requeued: 0, ended: vec![ended] });
    let job = store.job(&all(), &job).await.unwrap().expect("it exists");
    assert_eq!(job.status, Status::Failed);
    assert!(job.failure.expect("it says why").contains("3 attempts"));
}

pub(super) async fn ten_kills_in_company_end_no_job(store: &dyn Store) {
    // All within the first wait.
    let jobs = queued_jobs(store, 30).await;
    for _ in 0..10 {
        assert_eq!(dies(store, 2).await.len(), 2);
        let recovered = store.recover_expired(LONG).await.unwrap();
        assert_eq!(recovered, Recovered { requeued: 2, ended: Vec::new() });
    }
    assert_eq!(failed(store, &jobs).await, Vec::<String>::new());
    assert_eq!(store.queue().await.unwrap().queued, 30);
}

pub(super) async fn after_two_kills_all_places_are_filled_at_once(store: &dyn Store) {
    let jobs = queued_jobs(store, 4).await;
    for _ in 0..2 {
        assert_eq!(dies(store, 4).await.len(), 4);
        assert_eq!(store.recover_expired(NO_WAIT).await.unwrap().requeued, 4);
    }
    let worker = id();
    for _ in &jobs {
        store.lease(&worker, LONG).await.unwrap().expect("none waits for another");
    }
}

pub(super) async fn a_poisonous_job_ends_and_none_of_its_siblings(store: &dyn Store) {
    let jobs = queued_jobs(store, 6).await;
    let poison = &jobs[1];
    let mut deaths = 0;
    loop {
        let worker = id();
        let mut in_hand = Vec::new();
        while in_hand.len() < 3
            && let Some(lease) = store.lease(&worker, LONG).await.unwrap()
        {
            in_hand.push(lease);
        }
        if in_hand.is_empty() {
            break;
        }
        if in_hand.iter().any(|lease| lease.job_id == *poison) {
            for lease in &in_hand {
                store.heartbeat(lease, SHORT, None, &[]).await.unwrap();
            }
            tokio::time::sleep(SHORT).await;
            deaths += 1;
            store.recover_expired(NO_WAIT).await.unwrap();
        } else {
            for lease in &in_hand {
                assert!(store.finish(lease, &Outcome::Succeeded("{}".into())).await.unwrap());
            }
        }
    }
    assert_eq!(failed(store, &jobs).await, std::slice::from_ref(poison));
    assert_eq!(deaths, ALONE_AFTER + MAX_ATTEMPTS);
    for job in jobs.iter().filter(|job| *job != poison) {
        assert_eq!(status(store, job).await, Status::Succeeded);
    }
}

pub(super) async fn a_job_that_is_lost_by_a_living_worker_is_charged(store: &dyn Store) {
    let worker = id();
    let sibling = queued_job(store).await;
    let lease = store.lease(&worker, LONG).await.unwrap().expect("queued");
    assert_eq!(lease.job_id, sibling);
    let lost = queued_job(store).await;
    for charge in 1..=MAX_ATTEMPTS {
        assert_eq!(store.lease(&worker, EXPIRED).await.unwrap().expect("queued").job_id, lost);
        // The sibling may have died with it: its own lease is only good for longer.
        let waiting = store.recover_expired(NO_WAIT).await.unwrap();
        assert_eq!(waiting, Recovered::default(), "nobody knows yet");
        tokio::time::sleep(Duration::from_millis(5)).await;
        store.heartbeat(&lease, LONG, None, &[]).await.unwrap();
        let Recovered { requeued, ended } = store.recover_expired(NO_WAIT).await.unwrap();
        assert_eq!((requeued, ended.len()), if charge < MAX_ATTEMPTS { (1, 0) } else { (0, 1) });
    }
    assert_eq!(status(store, &lost).await, Status::Failed);
    assert_eq!(status(store, &sibling).await, Status::Running);
}

pub(super) async fn a_job_waits_longer_with_each_death_but_the_first(store: &dyn Store) {
    let job = queued_job(store).await;
    assert_eq!(dies(store, 1).await, std::slice::from_ref(&job));
    store.recover_expired(LONG).await.unwrap();
    assert_eq!(dies(store, 1).await, std::slice::from_ref(&job), "the first time it does not wait");
    store.recover_expired(Duration::from_millis(50)).await.unwrap();
    assert!(dies(store, 1).await.is_empty(), "it waits");
    while dies(store, 1).await.is_empty() {
        tokio::time::sleep(Duration::from_millis(10)).await;
    }
}

pub(super) async fn a_job_that_waited_is_leased_after_those_that_passed_it(store: &dyn Store) {
    let jobs = queued_jobs(store, 3).await;
    for wait in [NO_WAIT, Duration::from_millis(50)] {
        assert_eq!(lease(store, EXPIRED).await.expect("it is queued").job_id, jobs[0]);
        assert_eq!(store.recover_expired(wait).await.unwrap().requeued, 1);
    }
    for job in &jobs[1..] {
        assert_eq!(lease(store, LONG).await.expect("it is queued").job_id, *job);
    }
    let waited = tokio::time::timeout(LONG, async {
        loop {
            match lease(store, LONG).await {
                Some(lease) => break lease,
                None => tokio::time::sleep(Duration::from_millis(10)).await,
            }
        }
    });
    assert_eq!(waited.await.expect("it is found").job_id, jobs[0]);
}
