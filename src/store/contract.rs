//! What every engine of [`Store`] must do. Each engine runs the whole list.

use std::time::Duration;

use super::{
    Beat, Cancelling, ConvergencePoint, EndedRow, FileRow, IdempotencyKey, Inserted, JobFilter,
    Lease, MAX_ATTEMPTS, MeasurementFilter, MeasurementRow, NewJobRow, Outcome, Page, QueueState,
    Recovered, ResultFilter, Sqlite, Status, Store, StoreError,
};

const LONG: Duration = Duration::from_secs(600);
/// A lease that has expired as soon as it is given.
const EXPIRED: Duration = Duration::ZERO;

fn id() -> String {
    uuid::Uuid::now_v7().to_string()
}

fn measurement(id: &str) -> MeasurementRow {
    MeasurementRow {
        id: id.to_owned(),
        created_at_ms: 0,
        name: Some("stepped sine".into()),
        machine: Some("press 4".into()),
        axis: Some("x".into()),
        operator: None,
        measured_at: Some("2024-05-06T07:08:09Z".into()),
        labels: r#"{"site":"north"}"#.into(),
        sha256: "00ff".into(),
        experiments: 48,
        highest_harmonic: 9,
        magnitude_min: 1.0,
        magnitude_max: 3.0,
        omega_min_rad_s: 0.5,
        omega_max_rad_s: 200.0,
        notes: "[]".into(),
    }
}

fn file(bytes: &[u8]) -> FileRow {
    FileRow { name: "a.csv".into(), content_type: "text/csv".into(), bytes: bytes.to_vec() }
}

fn key(key: &str, body: &str) -> IdempotencyKey {
    IdempotencyKey { key: key.into(), body_sha256: body.into() }
}

fn point(seq: i64) -> ConvergencePoint {
    ConvergencePoint {
        seq,
        stage: "colony".into(),
        cycle: seq,
        evaluations: 20 * seq,
        best: 1.0 / (seq + 1) as f64,
        mean: (seq > 0).then_some(2.5),
        elapsed_s: 0.25 * seq as f64,
    }
}

async fn stored_measurement(store: &dyn Store) -> String {
    let id = id();
    store.insert_measurement(&measurement(&id), &[file(b"x")], None).await.unwrap();
    id
}

async fn queued_job(store: &dyn Store) -> String {
    let measurement_id = stored_measurement(store).await;
    let row = NewJobRow { id: id(), measurement_id, kind: "identify".into(), request: "{}".into() };
    assert_eq!(store.insert_job(&row, None).await.unwrap(), Inserted::Created);
    row.id
}

async fn leased_job(store: &dyn Store, duration: Duration) -> Lease {
    let job = queued_job(store).await;
    let lease = store.lease(duration).await.unwrap().expect("a job is queued");
    assert_eq!(lease.job_id, job);
    lease
}

async fn status(store: &dyn Store, id: &str) -> Status {
    store.job(id).await.unwrap().expect("the job exists").status
}

async fn a_measurement_comes_back_as_it_was_stored(store: &dyn Store) {
    let id = id();
    let files = [file(b"one"), file(&[0, 255, 10])];
    store.insert_measurement(&measurement(&id), &files, None).await.unwrap();

    let row = store.measurement(&id).await.unwrap().expect("it was stored");
    let created_at_ms = row.created_at_ms;
    assert!(created_at_ms > 1_700_000_000_000, "{created_at_ms} is not a time of today in ms");
    assert_eq!(row, MeasurementRow { created_at_ms, ..measurement(&id) });
    assert_eq!(store.measurement_files(&id).await.unwrap(), files);
    assert_eq!(store.measurement("nobody").await.unwrap(), None);
}

async fn lists_are_paged_newest_first_and_filtered(store: &dyn Store) {
    let ids = [
        stored_measurement(store).await,
        stored_measurement(store).await,
        stored_measurement(store).await,
    ];
    let everything = MeasurementFilter::default();
    let first = Page { limit: 2, before: None };
    let rows = store.measurements(&everything, &first).await.unwrap();
    assert_eq!(rows.iter().map(|row| &row.id).collect::<Vec<_>>(), [&ids[2], &ids[1]]);
    let second = Page { limit: 2, before: Some(ids[1].clone()) };
    let rows = store.measurements(&everything, &second).await.unwrap();
    assert_eq!(rows.iter().map(|row| &row.id).collect::<Vec<_>>(), [&ids[0]]);

    let elsewhere = MeasurementFilter { machine: Some("press 5".into()), ..everything.clone() };
    assert!(store.measurements(&elsewhere, &first).await.unwrap().is_empty());
    let here = MeasurementFilter {
        machine: Some("press 4".into()),
        axis: Some("x".into()),
        labels: vec![("site".into(), "north".into())],
        since_ms: Some(1_700_000_000_000),
        // The measurement says 2024-05-06T07:08:09Z.
        measured_since_ms: Some(1_714_979_289_000),
        measured_until_ms: Some(1_714_979_289_001),
        ..everything.clone()
    };
    assert_eq!(store.measurements(&here, &first).await.unwrap().len(), 2);
    for wrong in [
        MeasurementFilter { labels: vec![("site".into(), "south".into())], ..here.clone() },
        MeasurementFilter { until_ms: Some(1_700_000_000_000), ..here.clone() },
        MeasurementFilter { measured_since_ms: Some(1_714_979_289_001), ..here.clone() },
        MeasurementFilter { measured_until_ms: Some(1_714_979_289_000), ..here.clone() },
    ] {
        assert!(store.measurements(&wrong, &first).await.unwrap().is_empty(), "{wrong:?}");
    }

    let job = queued_job(store).await;
    let queued = JobFilter {
        status: Some(Status::Queued),
        kind: Some("identify".into()),
        machine: Some("press 4".into()),
        axis: Some("x".into()),
        labels: vec![("site".into(), "north".into())],
        since_ms: Some(1_700_000_000_000),
        ..JobFilter::default()
    };
    let running = JobFilter { status: Some(Status::Running), ..JobFilter::default() };
    assert_eq!(store.jobs(&queued, &first).await.unwrap()[0].id, job);
    assert!(store.jobs(&running, &first).await.unwrap().is_empty());
    for wrong in [
        JobFilter { kind: Some("diagnose".into()), ..queued.clone() },
        JobFilter { machine: Some("press 5".into()), ..queued.clone() },
        JobFilter { labels: vec![("shift".into(), "night".into())], ..queued.clone() },
        JobFilter { until_ms: Some(1_700_000_000_000), ..queued.clone() },
    ] {
        assert!(store.jobs(&wrong, &first).await.unwrap().is_empty(), "{wrong:?}");
    }
}

async fn an_idempotency_key_answers_the_same_request_only(store: &dyn Store) {
    let (first, second) = (id(), id());
    let insert = async |id: &str, key: &IdempotencyKey| {
        store.insert_measurement(&measurement(id), &[file(b"x")], Some(key)).await.unwrap()
    };
    assert_eq!(insert(&first, &key("k", "body")).await, Inserted::Created);
    assert_eq!(insert(&second, &key("k", "body")).await, Inserted::Replayed(first));
    assert_eq!(insert(&second, &key("k", "other body")).await, Inserted::KeyReused);
    assert_eq!(store.measurement(&second).await.unwrap(), None, "neither may store anything");
    assert_eq!(insert(&second, &key("another k", "body")).await, Inserted::Created);
}

async fn a_job_of_an_unknown_measurement_is_refused(store: &dyn Store) {
    let row = NewJobRow {
        id: id(),
        measurement_id: "nobody".into(),
        kind: "identify".into(),
        request: "{}".into(),
    };
    store.insert_job(&row, Some(&key("k", "body"))).await.unwrap_err();
    assert_eq!(store.job(&row.id).await.unwrap(), None);
}

async fn the_oldest_queued_job_is_leased_once(store: &dyn Store) {
    let (first, second) = (queued_job(store).await, queued_job(store).await);
    assert_eq!(store.lease(LONG).await.unwrap().expect("two are queued").job_id, first);
    assert_eq!(store.lease(LONG).await.unwrap().expect("one is queued").job_id, second);
    assert_eq!(store.lease(LONG).await.unwrap(), None);
    assert_eq!(status(store, &first).await, Status::Running);
}

async fn a_job_runs_and_succeeds_with_its_history(store: &dyn Store) {
    let lease = leased_job(store, LONG).await;
    let beat = store.heartbeat(&lease, LONG, Some("{\"done\":1}"), &[point(0), point(1)]).await;
    assert_eq!(beat.unwrap(), Beat::Renewed { cancel_requested: false });
    // Sent again, as after a lost answer, with one more row and no progress.
    store.heartbeat(&lease, LONG, None, &[point(1), point(2)]).await.unwrap();
    assert_eq!(store.result(&lease.job_id).await.unwrap(), None);

    let outcome = Outcome::Succeeded("{\"answer\":42}".into());
    assert!(store.finish(&lease, &outcome).await.unwrap());
    let job = store.job(&lease.job_id).await.unwrap().expect("it exists");
    assert_eq!(job.status, Status::Succeeded);
    assert_eq!(job.progress.as_deref(), Some("{\"done\":1}"));
    assert!(job.finished_at_ms >= job.started_at_ms && job.started_at_ms.is_some());
    assert_eq!(store.result(&job.id).await.unwrap().as_deref(), Some("{\"answer\":42}"));
    assert_eq!(store.convergence(&job.id).await.unwrap(), [point(0), point(1), point(2)]);
}

async fn a_failed_job_says_why_and_has_no_result(store: &dyn Store) {
    let lease = leased_job(store, LONG).await;
    let outcome = Outcome::Failed("{\"reason\":\"no\"}".into());
    assert!(store.finish(&lease, &outcome).await.unwrap());
    let job = store.job(&lease.job_id).await.unwrap().expect("it exists");
    assert_eq!((job.status, job.failure.as_deref()), (Status::Failed, Some("{\"reason\":\"no\"}")));
    assert_eq!(store.result(&job.id).await.unwrap(), None);
}

async fn nothing_is_written_after_the_end(store: &dyn Store) {
    let lease = leased_job(store, LONG).await;
    assert!(store.finish(&lease, &Outcome::Cancelled).await.unwrap());
    let late = Outcome::Succeeded("{}".into());
    assert!(!store.finish(&lease, &late).await.unwrap());
    assert!(!store.hand_back(&lease).await.unwrap());
    assert_eq!(store.heartbeat(&lease, LONG, None, &[point(0)]).await.unwrap(), Beat::Lost);
    assert_eq!(status(store, &lease.job_id).await, Status::Cancelled);
    assert!(store.convergence(&lease.job_id).await.unwrap().is_empty());
}

async fn an_expired_lease_writes_nothing_even_before_it_is_recovered(store: &dyn Store) {
    let lease = leased_job(store, EXPIRED).await;
    assert_eq!(store.heartbeat(&lease, LONG, Some("{}"), &[point(0)]).await.unwrap(), Beat::Lost);
    assert!(!store.finish(&lease, &Outcome::Succeeded("{}".into())).await.unwrap());
    assert!(!store.hand_back(&lease).await.unwrap());
    assert_eq!(status(store, &lease.job_id).await, Status::Running);
}

async fn a_stale_worker_cannot_spoil_its_successor(store: &dyn Store) {
    let stale = leased_job(store, EXPIRED).await;
    assert_eq!(store.recover_expired().await.unwrap().requeued, 1);
    let fresh = store.lease(LONG).await.unwrap().expect("it is queued again");
    assert_eq!(fresh.job_id, stale.job_id);
    assert_ne!(fresh.attempt, stale.attempt);
    store.heartbeat(&fresh, LONG, None, &[point(0)]).await.unwrap();

    assert_eq!(store.heartbeat(&stale, LONG, None, &[point(1)]).await.unwrap(), Beat::Lost);
    assert!(!store.finish(&stale, &Outcome::Failed("{}".into())).await.unwrap());
    assert!(store.finish(&fresh, &Outcome::Succeeded("{}".into())).await.unwrap());
    assert_eq!(store.convergence(&fresh.job_id).await.unwrap(), [point(0)]);
}

async fn a_job_that_kills_its_workers_fails_after_the_last_attempt(store: &dyn Store) {
    let job = queued_job(store).await;
    for _ in 1..MAX_ATTEMPTS {
        store.lease(EXPIRED).await.unwrap().expect("it is queued");
        assert_eq!(store.recover_expired().await.unwrap().requeued, 1);
    }
    store.lease(EXPIRED).await.unwrap().expect("it is queued a last time");
    let recovered = store.recover_expired().await.unwrap();
    let ended = EndedRow { kind: "identify".into(), status: Status::Failed };
    assert_eq!(recovered, Recovered { requeued: 0, ended: vec![ended] });
    let job = store.job(&job).await.unwrap().expect("it exists");
    assert_eq!(job.status, Status::Failed);
    assert!(job.failure.expect("it says why").contains("3 attempts"));
}

async fn a_job_handed_back_is_queued_and_not_charged(store: &dyn Store) {
    let job = queued_job(store).await;
    let mut attempts = Vec::new();
    for _ in 0..2 * MAX_ATTEMPTS {
        let lease = store.lease(LONG).await.unwrap().expect("it is queued");
        attempts.push(lease.attempt);
        assert!(store.hand_back(&lease).await.unwrap());
    }
    assert!(attempts.windows(2).all(|pair| pair[0] < pair[1]), "no lease number twice");
    let last = store.lease(EXPIRED).await.unwrap().expect("it is queued");
    assert_eq!(store.recover_expired().await.unwrap().requeued, 1);
    assert_eq!(last.job_id, job);
}

async fn a_queued_job_is_cancelled_at_once(store: &dyn Store) {
    let job = queued_job(store).await;
    assert_eq!(store.cancel(&job).await.unwrap(), Cancelling::Cancelled);
    assert_eq!(store.lease(LONG).await.unwrap(), None);
    assert_eq!(store.cancel(&job).await.unwrap(), Cancelling::Ended(Status::Cancelled));
    assert_eq!(store.cancel("nobody").await.unwrap(), Cancelling::Unknown);
}

async fn the_worker_of_a_running_job_learns_that_it_is_cancelled(store: &dyn Store) {
    let lease = leased_job(store, LONG).await;
    assert_eq!(store.cancel(&lease.job_id).await.unwrap(), Cancelling::Requested);
    let beat = store.heartbeat(&lease, LONG, None, &[]).await.unwrap();
    assert_eq!(beat, Beat::Renewed { cancel_requested: true });
    assert!(store.finish(&lease, &Outcome::Cancelled).await.unwrap());
    assert_eq!(status(store, &lease.job_id).await, Status::Cancelled);
}

async fn a_cancelled_job_does_not_come_back_to_the_queue(store: &dyn Store) {
    let lease = leased_job(store, LONG).await;
    store.cancel(&lease.job_id).await.unwrap();
    assert!(store.hand_back(&lease).await.unwrap());
    assert_eq!(status(store, &lease.job_id).await, Status::Cancelled);

    let lease = leased_job(store, EXPIRED).await;
    store.cancel(&lease.job_id).await.unwrap();
    let recovered = store.recover_expired().await.unwrap();
    let ended = EndedRow { kind: "identify".into(), status: Status::Cancelled };
    assert_eq!(recovered, Recovered { requeued: 0, ended: vec![ended] });
    assert_eq!(status(store, &lease.job_id).await, Status::Cancelled);
}

async fn history_goes_on_where_the_attempt_before_left_it(store: &dyn Store) {
    let first = leased_job(store, LONG).await;
    assert_eq!(first.next_seq, 0);
    store.heartbeat(&first, LONG, None, &[point(0), point(1)]).await.unwrap();
    assert!(store.hand_back(&first).await.unwrap());
    let second = store.lease(LONG).await.unwrap().expect("it is queued again");
    assert_eq!(second.next_seq, 2);
    store.heartbeat(&second, LONG, None, &[point(2)]).await.unwrap();
    assert_eq!(store.convergence(&second.job_id).await.unwrap(), [point(2)]);
    let from =
        async |position, limit| store.history(&second.job_id, position, limit).await.unwrap();
    assert_eq!(from(0, 10).await, [point(0), point(1), point(2)]);
    assert_eq!(from(1, 1).await, [point(1)]);
    assert!(from(3, 10).await.is_empty());
}

async fn a_deleted_measurement_takes_its_jobs_and_keys_with_it(store: &dyn Store) {
    let measured = id();
    let promise = key("k", "body");
    store.insert_measurement(&measurement(&measured), &[file(b"x")], Some(&promise)).await.unwrap();
    let row = NewJobRow {
        id: id(),
        measurement_id: measured.clone(),
        kind: "identify".into(),
        request: "{}".into(),
    };
    store.insert_job(&row, None).await.unwrap();
    let lease = store.lease(LONG).await.unwrap().expect("it is queued");
    assert!(store.delete_measurement(&measured).await.unwrap());
    assert!(!store.delete_measurement(&measured).await.unwrap());
    assert_eq!(store.job(&row.id).await.unwrap(), None);
    assert!(store.measurement_files(&measured).await.unwrap().is_empty());
    assert_eq!(store.heartbeat(&lease, LONG, None, &[point(0)]).await.unwrap(), Beat::Lost);
    assert!(!store.finish(&lease, &Outcome::Cancelled).await.unwrap());
    assert!(store.history(&row.id, 0, 10).await.unwrap().is_empty());
    let again = store.insert_measurement(&measurement(&id()), &[], Some(&promise)).await.unwrap();
    assert_eq!(again, Inserted::Created);
}

async fn a_deleted_job_takes_its_key_with_it(store: &dyn Store) {
    let ended = leased_job(store, LONG).await;
    store.finish(&ended, &Outcome::Cancelled).await.unwrap();
    let promise = key("k", "body");
    let job = || NewJobRow {
        id: id(),
        measurement_id: ended.measurement_id.clone(),
        kind: "identify".into(),
        request: "{}".into(),
    };
    let first = job();
    assert_eq!(store.insert_job(&first, Some(&promise)).await.unwrap(), Inserted::Created);
    store.cancel(&first.id).await.unwrap();
    store.delete_job(&first.id).await.unwrap();
    assert_eq!(store.insert_job(&job(), Some(&promise)).await.unwrap(), Inserted::Created);
}

async fn what_is_old_is_deleted_and_what_is_wanted_is_not(store: &dyn Store) {
    let ended = leased_job(store, LONG).await;
    store.finish(&ended, &Outcome::Succeeded("{}".into())).await.unwrap();
    let queued = queued_job(store).await;
    let nothing = store.delete_older(LONG, 10).await.unwrap();
    assert_eq!((nothing.jobs, nothing.measurements), (0, 0));
    tokio::time::sleep(Duration::from_millis(5)).await;
    let old = store.delete_older(Duration::from_millis(1), 10).await.unwrap();
    assert_eq!((old.jobs, old.measurements), (1, 1));
    assert_eq!(store.job(&ended.job_id).await.unwrap(), None);
    assert_eq!(store.measurement(&ended.measurement_id).await.unwrap(), None);
    let kept = store.job(&queued).await.unwrap().expect("it is still wanted");
    assert!(store.measurement(&kept.measurement_id).await.unwrap().is_some());
}

async fn results_are_listed_by_when_they_were_measured(store: &dyn Store) {
    let mut jobs = Vec::new();
    for (axis, measured_at) in [("x", Some("2024-05-06T07:08:09Z")), ("x", None), ("y", None)] {
        let row = MeasurementRow {
            axis: Some(axis.into()),
            measured_at: measured_at.map(str::to_owned),
            ..measurement(&id())
        };
        store.insert_measurement(&row, &[file(b"x")], None).await.unwrap();
        for _ in 0..2 {
            let job = NewJobRow {
                id: id(),
                measurement_id: row.id.clone(),
                kind: "identify".into(),
                request: "{}".into(),
            };
            store.insert_job(&job, None).await.unwrap();
            let lease = store.lease(LONG).await.unwrap().expect("it is queued");
            store.finish(&lease, &Outcome::Succeeded("{}".into())).await.unwrap();
            jobs.push(job.id);
        }
    }
    let listed = async |filter: ResultFilter| {
        let rows = store.results(&filter, 100).await.unwrap();
        rows.into_iter().map(|row| row.job_id).collect::<Vec<_>>()
    };
    let everything = ResultFilter::default;
    let newest_first: Vec<String> = jobs.iter().rev().cloned().collect();
    assert_eq!(listed(everything()).await, newest_first);
    let latest = ResultFilter { latest_only: true, axis: Some("x".into()), ..everything() };
    assert_eq!(listed(latest).await, [jobs[3].clone(), jobs[1].clone()]);
    // 2024-05-06T07:08:09Z: from is within, to is not.
    let at = Some(1_714_979_289_000);
    let before = ResultFilter { to_ms: at.map(|at| at + 1), ..everything() };
    assert_eq!(listed(before).await, [jobs[1].clone(), jobs[0].clone()]);
    assert!(listed(ResultFilter { to_ms: at, ..everything() }).await.is_empty());
    assert_eq!(listed(ResultFilter { from_ms: at, ..everything() }).await.len(), 6);

    let axes = store.axes(Some("press 4"), 100).await.unwrap();
    let counts: Vec<_> =
        axes.iter().map(|axis| (axis.axis.as_str(), axis.measurements, axis.results)).collect();
    assert_eq!(counts, [("x", 2, 2), ("y", 1, 1)]);
    assert_eq!(Some(axes[0].first_ms), at);
    assert!(store.axes(Some("press 5"), 100).await.unwrap().is_empty());
}

async fn the_queue_says_what_waits_and_how_long(store: &dyn Store) {
    assert_eq!(store.queue().await.unwrap(), QueueState::default());
    leased_job(store, LONG).await;
    queued_job(store).await;
    tokio::time::sleep(Duration::from_millis(5)).await;
    queued_job(store).await;
    let QueueState { queued, running, oldest_wait_ms } = store.queue().await.unwrap();
    assert_eq!((queued, running), (2, 1));
    assert!((5..60_000).contains(&oldest_wait_ms), "{oldest_wait_ms}");
}

/// Runs every test of the contract on a fresh store of one engine each.
macro_rules! engine {
    ($engine:ident, $open:expr, [$($test:ident),* $(,)?]) => {
        mod $engine {
            $(#[tokio::test]
            async fn $test() {
                let directory = tempfile::tempdir().unwrap();
                super::$test(&$open(directory.path()).await.unwrap()).await;
            })*
        }
    };
}

engine!(
    sqlite,
    super::Sqlite::open,
    [
        a_measurement_comes_back_as_it_was_stored,
        lists_are_paged_newest_first_and_filtered,
        an_idempotency_key_answers_the_same_request_only,
        a_deleted_job_takes_its_key_with_it,
        a_job_of_an_unknown_measurement_is_refused,
        the_oldest_queued_job_is_leased_once,
        a_job_runs_and_succeeds_with_its_history,
        a_failed_job_says_why_and_has_no_result,
        nothing_is_written_after_the_end,
        an_expired_lease_writes_nothing_even_before_it_is_recovered,
        a_stale_worker_cannot_spoil_its_successor,
        a_job_that_kills_its_workers_fails_after_the_last_attempt,
        a_job_handed_back_is_queued_and_not_charged,
        a_queued_job_is_cancelled_at_once,
        the_worker_of_a_running_job_learns_that_it_is_cancelled,
        a_cancelled_job_does_not_come_back_to_the_queue,
        history_goes_on_where_the_attempt_before_left_it,
        a_deleted_measurement_takes_its_jobs_and_keys_with_it,
        what_is_old_is_deleted_and_what_is_wanted_is_not,
        results_are_listed_by_when_they_were_measured,
        the_queue_says_what_waits_and_how_long,
    ]
);

#[tokio::test]
async fn leases_taken_at_once_from_two_connections_are_of_different_jobs() {
    let directory = tempfile::tempdir().unwrap();
    let first = Sqlite::open(directory.path()).await.unwrap();
    let second = Sqlite::open(directory.path()).await.unwrap();
    let mut queued = Vec::new();
    for _ in 0..8 {
        queued.push(queued_job(&first).await);
    }
    let take = async |store: &Sqlite| {
        let mut taken = Vec::new();
        while let Some(lease) = store.lease(LONG).await.unwrap() {
            taken.push(lease.job_id);
        }
        taken
    };
    let (mut taken, others) = tokio::join!(take(&first), take(&second));
    taken.extend(others);
    taken.sort();
    assert_eq!(taken, queued);
}

#[tokio::test]
async fn what_has_no_room_is_refused_whole_and_accepted_once_there_is() {
    let directory = tempfile::tempdir().unwrap();
    let store = Sqlite::open_limited(directory.path(), Some(1 << 20)).await.unwrap();
    let small = stored_measurement(&store).await;
    let large = file(&vec![b'x'; 700 << 10]);
    let first = id();
    store
        .insert_measurement(&measurement(&first), std::slice::from_ref(&large), None)
        .await
        .unwrap();
    let second = id();
    let refused =
        store.insert_measurement(&measurement(&second), std::slice::from_ref(&large), None).await;
    assert!(matches!(refused, Err(StoreError::Full(_))), "{refused:?}");
    assert_eq!(store.measurement(&second).await.unwrap(), None, "nothing is stored by half");
    assert!(store.measurement(&small).await.unwrap().is_some());
    assert!(store.delete_measurement(&first).await.unwrap());
    let accepted = store.insert_measurement(&measurement(&second), &[large], None).await;
    assert_eq!(accepted.unwrap(), Inserted::Created);
    store.ping().await.unwrap();
}
