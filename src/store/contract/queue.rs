//! Jobs on their way from the queue to their end.

use futures_util::future::join_all;

use super::*;

pub(super) async fn the_oldest_queued_job_is_leased_once(store: &dyn Store) {
    let (first, second) = (queued_job(store).await, queued_job(store).await);
    assert_eq!(lease(store, LONG).await.expect("two are queued").job_id, first);
    assert_eq!(lease(store, LONG).await.expect("one is queued").job_id, second);
    assert_eq!(lease(store, LONG).await, None);
    assert_eq!(status(store, &first).await, Status::Running);
}

pub(super) async fn submitters_take_turns_however_much_each_queues(store: &dyn Store) {
    let measured = stored_measurement(store).await;
    let mut flood = Vec::new();
    for _ in 0..20 {
        flood.push(queued_job_of(store, &measured, "flood").await);
    }
    let mut leased = Vec::new();
    for _ in 0..5 {
        leased.push(lease(store, LONG).await.expect("20 are queued").job_id);
    }
    let mut few = Vec::new();
    for _ in 0..3 {
        few.push(queued_job_of(store, &measured, "few").await);
    }
    flood.push(queued_job_of(store, &measured, "flood").await);
    while let Some(lease) = lease(store, LONG).await {
        leased.push(lease.job_id);
    }
    let mut wanted = flood[..5].to_vec();
    for (of_flood, of_few) in flood[5..].iter().zip(&few) {
        wanted.extend([of_flood.clone(), of_few.clone()]);
    }
    wanted.extend_from_slice(&flood[8..]);
    assert_eq!(leased, wanted);
}

pub(super) async fn jobs_queued_at_once_have_turns_of_their_own(store: &dyn Store) {
    let measured = stored_measurement(store).await;
    let submitters = ["a", "b"].repeat(8);
    let queued = submitters.iter().map(|submitter| queued_job_of(store, &measured, submitter));
    let jobs = join_all(queued).await;
    let of_a: Vec<&String> = jobs.iter().step_by(2).collect();
    for _ in 0..8 {
        let pair = [lease(store, LONG).await, lease(store, LONG).await];
        let pair = pair.map(|lease| lease.expect("16 are queued").job_id);
        let mine = pair.iter().filter(|job| of_a.contains(job));
        assert_eq!(mine.count(), 1, "one of each submitter");
    }
}

pub(super) async fn a_higher_priority_goes_first_within_one_submitter_and_takes_no_turn_of_another(
    store: &dyn Store,
) {
    let measured = stored_measurement(store).await;
    let queue = async |submitter: &str, priority| {
        let row = NewJobRow { submitter: submitter.into(), priority, ..new_job(&measured) };
        assert_eq!(store.insert_job(&all(), &row, None).await.unwrap(), Inserted::Created);
        row.id
    };
    let low = queue("a", Priority::Low).await;
    let (first, second) = (queue("a", Priority::Normal).await, queue("a", Priority::Normal).await);
    let mut others = Vec::new();
    for _ in 0..3 {
        others.push(queue("b", Priority::Normal).await);
    }
    let of_two = [measured.clone(), stored_measurement(store).await];
    let batch = NewBatchRow { priority: Priority::High, ..new_batch(&of_two, "a") };
    assert_eq!(store.insert_batch(&all(), &batch, None).await.unwrap(), Inserted::Created);
    let high: Vec<&String> = batch.jobs.iter().map(|job| &job.job_id).collect();
    let mut leased = Vec::new();
    while let Some(lease) = lease(store, LONG).await {
        leased.push(lease.job_id);
    }
    let [one, two, three] = &others[..] else { unreachable!() };
    assert_eq!(
        leased.iter().collect::<Vec<_>>(),
        [high[0], one, high[1], two, &first, three, &second, &low]
    );
}

pub(super) async fn expired_leases_are_recovered_once(store: &dyn Store) {
    for _ in 0..20 {
        leased_job(store, EXPIRED).await;
    }
    let recovered = join_all((0..8).map(|_| store.recover_expired(NO_WAIT))).await;
    assert_eq!(recovered.into_iter().map(|one| one.unwrap().requeued).sum::<u64>(), 20);
    assert_eq!(store.queue().await.unwrap().queued, 20);
}

pub(super) async fn a_job_runs_and_succeeds_with_its_history(store: &dyn Store) {
    let lease = leased_job(store, LONG).await;
    let beat = store.heartbeat(&lease, LONG, Some("{\"done\":1}"), &[point(0), point(1)]).await;
    assert_eq!(beat.unwrap(), Beat::Renewed { cancel_requested: false });
    // Sent again, as after a lost answer, with one more row and no progress.
    store.heartbeat(&lease, LONG, None, &[point(1), point(2)]).await.unwrap();
    assert_eq!(store.result(&all(), &lease.job_id).await.unwrap(), None);

    let outcome = Outcome::Succeeded("{\"answer\":42}".into());
    assert!(store.finish(&lease, &outcome).await.unwrap());
    let job = store.job(&all(), &lease.job_id).await.unwrap().expect("it exists");
    assert_eq!(job.status, Status::Succeeded);
    assert_eq!(job.progress.as_deref(), Some("{\"done\":1}"));
    assert!(job.finished_at_ms >= job.started_at_ms && job.started_at_ms.is_some());
    assert_eq!(store.result(&all(), &job.id).await.unwrap().as_deref(), Some("{\"answer\":42}"));
    assert_eq!(store.convergence(&all(), &job.id).await.unwrap(), [point(0), point(1), point(2)]);
}

pub(super) async fn a_failed_job_says_why_and_has_no_result(store: &dyn Store) {
    let lease = leased_job(store, LONG).await;
    let outcome = Outcome::Failed("{\"reason\":\"no\"}".into());
    assert!(store.finish(&lease, &outcome).await.unwrap());
    let job = store.job(&all(), &lease.job_id).await.unwrap().expect("it exists");
    assert_eq!((job.status, job.failure.as_deref()), (Status::Failed, Some("{\"reason\":\"no\"}")));
    assert_eq!(store.result(&all(), &job.id).await.unwrap(), None);
}

pub(super) async fn nothing_is_written_after_the_end(store: &dyn Store) {
    let lease = leased_job(store, LONG).await;
    assert!(store.finish(&lease, &Outcome::Cancelled).await.unwrap());
    let late = Outcome::Succeeded("{}".into());
    assert!(!store.finish(&lease, &late).await.unwrap());
    assert!(!store.hand_back(&lease).await.unwrap());
    assert_eq!(store.heartbeat(&lease, LONG, None, &[point(0)]).await.unwrap(), Beat::Lost);
    assert_eq!(status(store, &lease.job_id).await, Status::Cancelled);
    assert!(store.convergence(&all(), &lease.job_id).await.unwrap().is_empty());
}

pub(super) async fn an_expired_lease_writes_nothing_even_before_it_is_recovered(store: &dyn Store) {
    let lease = leased_job(store, EXPIRED).await;
    assert_eq!(store.heartbeat(&lease, LONG, Some("{}"), &[point(0)]).await.unwrap(), Beat::Lost);
    assert!(!store.finish(&lease, &Outcome::Succeeded("{}".into())).await.unwrap());
    assert!(!store.hand_back(&lease).await.unwrap());
    assert_eq!(status(store, &lease.job_id).await, Status::Running);
}

pub(super) async fn a_stale_worker_cannot_spoil_its_successor(store: &dyn Store) {
    let stale = leased_job(store, EXPIRED).await;
    assert_eq!(store.recover_expired(NO_WAIT).await.unwrap().requeued, 1);
    let fresh = lease(store, LONG).await.expect("it is queued again");
    assert_eq!(fresh.job_id, stale.job_id);
    assert_ne!(fresh.attempt, stale.attempt);
    store.heartbeat(&fresh, LONG, None, &[point(0)]).await.unwrap();

    assert_eq!(store.heartbeat(&stale, LONG, None, &[point(1)]).await.unwrap(), Beat::Lost);
    assert!(!store.finish(&stale, &Outcome::Failed("{}".into())).await.unwrap());
    assert!(store.finish(&fresh, &Outcome::Succeeded("{}".into())).await.unwrap());
    assert_eq!(store.convergence(&all(), &fresh.job_id).await.unwrap(), [point(0)]);
}

pub(super) async fn a_job_handed_back_is_queued_and_not_charged(store: &dyn Store) {
    let job = queued_job(store).await;
    let mut attempts = Vec::new();
    for _ in 0..2 * MAX_ATTEMPTS {
        let lease = lease(store, LONG).await.expect("it is queued");
        attempts.push(lease.attempt);
        assert!(store.hand_back(&lease).await.unwrap());
    }
    assert!(attempts.windows(2).all(|pair| pair[0] < pair[1]), "no lease number twice");
    let last = lease(store, EXPIRED).await.expect("it is queued");
    assert_eq!(store.recover_expired(NO_WAIT).await.unwrap().requeued, 1);
    assert_eq!(last.job_id, job);
}

pub(super) async fn a_queued_job_is_cancelled_at_once(store: &dyn Store) {
    let job = queued_job(store).await;
    assert_eq!(store.cancel(&all(), &job).await.unwrap(), Cancelling::Cancelled);
    assert_eq!(lease(store, LONG).await, None);
    assert_eq!(store.cancel(&all(), &job).await.unwrap(), Cancelling::Ended(Status::Cancelled));
    assert_eq!(store.cancel(&all(), "nobody").await.unwrap(), Cancelling::Unknown);
}

pub(super) async fn the_worker_of_a_running_job_learns_that_it_is_cancelled(store: &dyn Store) {
    let lease = leased_job(store, LONG).await;
    assert_eq!(store.cancel(&all(), &lease.job_id).await.unwrap(), Cancelling::Requested);
    let beat = store.heartbeat(&lease, LONG, None, &[]).await.unwrap();
    assert_eq!(beat, Beat::Renewed { cancel_requested: true });
    assert!(store.finish(&lease, &Outcome::Cancelled).await.unwrap());
    assert_eq!(status(store, &lease.job_id).await, Status::Cancelled);
}

pub(super) async fn a_cancelled_job_does_not_come_back_to_the_queue(store: &dyn Store) {
    let lease = leased_job(store, LONG).await;
    store.cancel(&all(), &lease.job_id).await.unwrap();
    assert!(store.hand_back(&lease).await.unwrap());
    assert_eq!(status(store, &lease.job_id).await, Status::Cancelled);

    let lease = leased_job(store, EXPIRED).await;
    store.cancel(&all(), &lease.job_id).await.unwrap();
    let recovered = store.recover_expired(NO_WAIT).await.unwrap();
    let ended = EndedRow { kind: "identify".into(), status: Status::Cancelled };
    assert_eq!(recovered, Recovered { requeued: 0, ended: vec![ended] });
    assert_eq!(status(store, &lease.job_id).await, Status::Cancelled);
}

pub(super) async fn history_goes_on_where_the_attempt_before_left_it(store: &dyn Store) {
    let first = leased_job(store, LONG).await;
    assert_eq!(first.next_seq, 0);
    store.heartbeat(&first, LONG, None, &[point(0), point(1)]).await.unwrap();
    assert!(store.hand_back(&first).await.unwrap());
    let second = lease(store, LONG).await.expect("it is queued again");
    assert_eq!(second.next_seq, 2);
    store.heartbeat(&second, LONG, None, &[point(2)]).await.unwrap();
    assert_eq!(store.convergence(&all(), &second.job_id).await.unwrap(), [point(2)]);
    let from = async |position, limit| {
        store.history(&all(), &second.job_id, position, limit).await.unwrap()
    };
    assert_eq!(from(0, 10).await, [point(0), point(1), point(2)]);
    assert_eq!(from(1, 1).await, [point(1)]);
    assert!(from(3, 10).await.is_empty());
}

pub(super) async fn the_queue_says_what_waits_and_how_long(store: &dyn Store) {
    assert_eq!(store.queue().await.unwrap(), QueueState::default());
    leased_job(store, LONG).await;
    queued_job(store).await;
    tokio::time::sleep(Duration::from_millis(5)).await;
    queued_job(store).await;
    let QueueState { queued, running, oldest_wait_ms } = store.queue().await.unwrap();
    assert_eq!((queued, running), (2, 1));
    assert!((5..60_000).contains(&oldest_wait_ms), "{oldest_wait_ms}");
}

pub(super) async fn jobs_that_have_ended_or_are_gone_are_told_from_the_others(store: &dyn Store) {
    let finished = leased_job(store, LONG).await;
    assert!(store.finish(&finished, &Outcome::Succeeded("{}".into())).await.unwrap());
    let running = leased_job(store, LONG).await.job_id;
    let [cancelled, deleted, queued] =
        [queued_job(store).await, queued_job(store).await, queued_job(store).await];
    assert_eq!(store.cancel(&all(), &cancelled).await.unwrap(), Cancelling::Cancelled);
    assert!(store.delete_job(&all(), &deleted).await.unwrap());
    let asked = [finished.job_id, running.clone(), cancelled, deleted, queued.clone(), id()];
    let mut open = store.unended(&asked).await.unwrap();
    open.sort();
    assert_eq!(open, [running, queued]);
    assert!(store.unended(&[]).await.unwrap().is_empty());
}
