//! Batches and their jobs.

use super::*;

async fn measured(store: &dyn Store, count: usize) -> Vec<String> {
    let mut ids = Vec::new();
    for _ in 0..count {
        ids.push(stored_measurement(store).await);
    }
    ids
}

pub(super) fn new_batch(measurements: &[String], submitter: &str) -> NewBatchRow {
    let job = |measurement_id: &String| NewMemberRow {
        job_id: id(),
        measurement_id: measurement_id.clone(),
        request: format!("{{\"of\": \"{measurement_id}\"}}"),
        file: Some("a.csv".into()),
    };
    NewBatchRow {
        id: id(),
        name: Some("press hall".into()),
        submitter: submitter.into(),
        kind: "diagnose".into(),
        priority: Priority::Normal,
        request: "{}".into(),
        jobs: measurements.iter().map(job).collect(),
    }
}

async fn stored_batch(store: &dyn Store, jobs: usize) -> NewBatchRow {
    let batch = new_batch(&measured(store, jobs).await, "");
    assert_eq!(store.insert_batch(&all(), &batch, None).await.unwrap(), Inserted::Created);
    batch
}

/// Status, verdict, cause and number, in the order of the names.
async fn tallied(store: &dyn Store, id: &str) -> Vec<(&'static str, Option<String>, i64)> {
    let tallies = store.batch_tallies(&all(), &[id.to_owned()]).await.unwrap();
    let mut counts: Vec<_> =
        tallies.into_iter().map(|row| (row.status.name(), row.cause, row.jobs)).collect();
    counts.sort();
    counts
}

pub(super) async fn the_jobs_of_a_batch_are_ordinary_jobs_in_its_order(store: &dyn Store) {
    let batch = stored_batch(store, 3).await;
    let row = store.batch(&all(), &batch.id).await.unwrap().expect("it was stored");
    assert_eq!((row.jobs, row.name.as_deref()), (3, Some("press hall")));
    for member in &batch.jobs {
        let lease = lease(store, LONG).await.expect("it is queued");
        assert_eq!((&lease.job_id, &lease.request), (&member.job_id, &member.request));
        assert_eq!(lease.measurement_id, member.measurement_id);
        let job = store.job(&all(), &lease.job_id).await.unwrap().unwrap();
        assert_eq!((job.batch_id.as_ref(), job.kind.as_str()), (Some(&batch.id), "diagnose"));
    }
    assert_eq!(lease(store, LONG).await, None);
    let other = queued_job(store).await;
    assert_eq!(store.job(&all(), &other).await.unwrap().unwrap().batch_id, None);
    let of_batch = JobFilter { batch_id: Some(batch.id.clone()), ..JobFilter::default() };
    let page = Page { limit: 10, before: None };
    assert_eq!(store.jobs(&all(), &of_batch, &page).await.unwrap().len(), 3);
}

pub(super) async fn a_batch_is_stored_whole_or_not_at_all(store: &dyn Store) {
    let mut measurements = measured(store, 2).await;
    let promise = key("k", "body");
    measurements.push("nobody".into());
    let batch = new_batch(&measurements, "");
    store.insert_batch(&all(), &batch, Some(&promise)).await.unwrap_err();
    assert_eq!(store.batch(&all(), &batch.id).await.unwrap(), None);
    assert_eq!(store.queue().await.unwrap().queued, 0);
    // The key was not taken either.
    let whole = new_batch(&measurements[..2], "");
    let insert = async |batch, key: &IdempotencyKey| {
        store.insert_batch(&all(), batch, Some(key)).await.unwrap()
    };
    assert_eq!(insert(&whole, &promise).await, Inserted::Created);
    let again = new_batch(&measurements[..2], "");
    assert_eq!(insert(&again, &promise).await, Inserted::Replayed(whole.id.clone()));
    assert_eq!(insert(&again, &key("k", "another body")).await, Inserted::KeyReused);
    assert_eq!(store.queue().await.unwrap().queued, 2);
}

pub(super) async fn a_batch_delays_the_job_of_another_by_one_job(store: &dyn Store) {
    let measurements = measured(store, 20).await;
    let flood = new_batch(&measurements, "flood");
    store.insert_batch(&all(), &flood, None).await.unwrap();
    let mut of_flood = flood.jobs.iter().map(|job| job.job_id.clone());
    let next = async || lease(store, LONG).await.expect("many are queued").job_id;
    assert_eq!(Some(next().await), of_flood.next());
    let few = queued_job_of(store, &measurements[0], "few").await;
    assert_eq!(Some(next().await), of_flood.next());
    assert_eq!(next().await, few);
    // A second batch of the same submitter stands behind the first, another's beside it.
    let second = new_batch(&measurements[..2], "flood");
    store.insert_batch(&all(), &second, None).await.unwrap();
    let others = new_batch(&measurements[..2], "few");
    store.insert_batch(&all(), &others, None).await.unwrap();
    for job in &others.jobs {
        assert_eq!(Some(next().await), of_flood.next());
        assert_eq!(next().await, job.job_id);
    }
    for job in of_flood.chain(second.jobs.iter().map(|job| job.job_id.clone())) {
        assert_eq!(next().await, job);
    }
}

pub(super) async fn a_batch_says_where_its_jobs_stand_and_what_came_of_them(store: &dyn Store) {
    let batch = stored_batch(store, 7).await;
    let result = r#"{"verdict": "explained", "causes": [{"effect": "backlash", "confidence": 0.9},
                     {"effect": "spring", "confidence": 0.8}]}"#;
    let failure = r#"{"reason": "too short", "reference": null}"#;
    let outcomes = [
        Outcome::Succeeded(result.into()),
        Outcome::Succeeded(result.into()),
        Outcome::Succeeded("{}".into()),
        Outcome::Failed(failure.into()),
    ];
    for outcome in &outcomes {
        let lease = lease(store, LONG).await.expect("it is queued");
        assert!(store.finish(&lease, outcome).await.unwrap());
    }
    lease(store, LONG).await.expect("it is queued");
    assert!(store.delete_job(&all(), &batch.jobs[5].job_id).await.unwrap());
    let cause = || Some("backlash".to_owned());
    let expected = [
        ("failed", None, 1),
        ("queued", None, 1),
        ("running", None, 1),
        ("succeeded", None, 1),
        ("succeeded", cause(), 2),
    ];
    assert_eq!(tallied(store, &batch.id).await, expected);
    let tallies = store.batch_tallies(&all(), std::slice::from_ref(&batch.id)).await.unwrap();
    let named = tallies.iter().find(|row| row.cause.is_some()).unwrap();
    assert_eq!(named.verdict.as_deref(), Some("explained"));
    assert!(named.started_ms.is_some() && named.finished_ms >= named.started_ms);
    let failures = store.batch_failures(&all(), &batch.id, 10).await.unwrap();
    assert_eq!(failures, [FailureRow { reason: "too short".into(), jobs: 1 }]);

    let members = async |standing, after: Option<&str>, limit| {
        store.batch_members(&all(), &batch.id, standing, after, limit).await.unwrap()
    };
    let rows = members(None, None, 10).await;
    let ids = |rows: &[MemberRow]| rows.iter().map(|row| row.job_id.clone()).collect::<Vec<_>>();
    let all_ids: Vec<String> = batch.jobs.iter().map(|job| job.job_id.clone()).collect();
    assert_eq!(ids(&rows), all_ids);
    assert_eq!((rows[0].cause.as_deref(), rows[0].confidence), (Some("backlash"), Some(0.9)));
    assert_eq!(rows[0].file.as_deref(), Some("a.csv"));
    assert_eq!((rows[3].status, rows[3].failure.as_deref()), (Some(Status::Failed), Some(failure)));
    assert_eq!((rows[5].status, &rows[5].measurement_id), (None, &batch.jobs[5].measurement_id));
    assert_eq!(ids(&members(None, Some(&all_ids[1]), 2).await), all_ids[2..4]);
    assert_eq!(ids(&members(Some(Standing::Deleted), None, 10).await), all_ids[5..6]);
    let succeeded = Some(Standing::At(Status::Succeeded));
    assert_eq!(ids(&members(succeeded, None, 10).await), all_ids[..3]);
}

pub(super) async fn a_batch_is_cancelled_step_by_step(store: &dyn Store) {
    let batch = stored_batch(store, 5).await;
    let running = lease(store, LONG).await.expect("it is queued");
    let mut sum = CancelledRows::default();
    loop {
        let step = store.cancel_batch(&all(), &batch.id, 2).await.unwrap().expect("it is there");
        assert!(step.cancelled + step.requested <= 2);
        if step == CancelledRows::default() {
            break;
        }
        sum.cancelled += step.cancelled;
        sum.requested += step.requested;
    }
    assert_eq!(sum, CancelledRows { cancelled: 4, requested: 1 });
    assert_eq!(lease(store, LONG).await, None);
    let beat = store.heartbeat(&running, LONG, None, &[]).await.unwrap();
    assert_eq!(beat, Beat::Renewed { cancel_requested: true });
    assert!(store.finish(&running, &Outcome::Cancelled).await.unwrap());
    assert_eq!(tallied(store, &batch.id).await, [("cancelled", None, 5)]);
    assert_eq!(store.events(10).await.unwrap().len(), 5, "each end is told");
    assert_eq!(store.cancel_batch(&all(), "nobody", 2).await.unwrap(), None);
}

pub(super) async fn a_batch_is_deleted_step_by_step_with_its_jobs_and_its_key(store: &dyn Store) {
    let measurements = measured(store, 5).await;
    let (batch, promise) = (new_batch(&measurements, ""), key("k", "body"));
    store.insert_batch(&all(), &batch, Some(&promise)).await.unwrap();
    let running = lease(store, LONG).await.expect("it is queued");
    let step = async || store.delete_batch(&all(), &batch.id, 2).await.unwrap();
    assert_eq!([step().await, step().await], [Some(2), Some(2)]);
    assert!(store.batch(&all(), &batch.id).await.unwrap().is_some());
    assert_eq!([step().await, step().await], [Some(1), None]);
    assert_eq!(store.batch(&all(), &batch.id).await.unwrap(), None);
    assert_eq!(store.heartbeat(&running, LONG, None, &[]).await.unwrap(), Beat::Lost);
    assert!(store.measurement(&all(), &measurements[0]).await.unwrap().is_some());
    let again = new_batch(&measurements, "");
    let inserted = store.insert_batch(&all(), &again, Some(&promise)).await.unwrap();
    assert_eq!(inserted, Inserted::Created);
}

pub(super) async fn an_old_batch_is_forgotten_with_the_last_of_its_jobs(store: &dyn Store) {
    let measurements = measured(store, 2).await;
    let (batch, promise) = (new_batch(&measurements, ""), key("k", "body"));
    store.insert_batch(&all(), &batch, Some(&promise)).await.unwrap();
    let first = lease(store, LONG).await.expect("it is queued");
    store.finish(&first, &Outcome::Succeeded("{}".into())).await.unwrap();
    tokio::time::sleep(Duration::from_millis(5)).await;
    let old = Duration::from_millis(1);
    // The key of a batch that is there is no key of nothing.
    store.delete_older(LONG, 10).await.unwrap();
    let again = store.insert_batch(&all(), &new_batch(&measurements, ""), Some(&promise)).await;
    assert_eq!(again.unwrap(), Inserted::Replayed(batch.id.clone()));
    store.delete_older(old, 10).await.unwrap();
    assert!(store.batch(&all(), &batch.id).await.unwrap().is_some(), "one of its jobs waits");
    let last = lease(store, LONG).await.expect("it is queued");
    store.finish(&last, &Outcome::Succeeded("{}".into())).await.unwrap();
    tokio::time::sleep(Duration::from_millis(5)).await;
    store.delete_older(old, 10).await.unwrap();
    assert_eq!(store.batch(&all(), &batch.id).await.unwrap(), None);
}

pub(super) async fn a_batch_of_another_owner_is_not_there(store: &dyn Store) {
    let of = |owner: &str| Reach { owner: owner.into(), reads_all: false, changes_all: false };
    let (mine, theirs) = (of("a"), of("b"));
    let reader = Reach { reads_all: true, ..theirs.clone() };
    let measurement = id();
    let row = super::measurement(&measurement);
    store.insert_measurement(&mine, &row, &[file(b"x")], None).await.unwrap();
    let batch = new_batch(&[measurement], "");
    store.insert_batch(&mine, &batch, None).await.unwrap();
    let lease = lease(store, LONG).await.expect("it is queued");
    store.finish(&lease, &Outcome::Failed(r#"{"reason": "x"}"#.into())).await.unwrap();
    let ids = [batch.id.clone()];
    let page = Page { limit: 10, before: None };
    let found = async |reach: &Reach| {
        [
            store.measurements_of(reach, std::slice::from_ref(&row.id)).await.unwrap().len(),
            store.batch(reach, &batch.id).await.unwrap().iter().count(),
            store.batches(reach, &page).await.unwrap().len(),
            store.batch_tallies(reach, &ids).await.unwrap().len(),
            store.batch_failures(reach, &batch.id, 10).await.unwrap().len(),
            store.batch_members(reach, &batch.id, None, None, 10).await.unwrap().len(),
        ]
    };
    for reach in [&mine, &reader, &all()] {
        assert_eq!(found(reach).await, [1; 6], "{reach:?}");
    }
    for stranger in [&theirs, &Reach::nothing()] {
        assert_eq!(found(stranger).await, [0; 6]);
    }
    for stranger in [&theirs, &reader] {
        assert_eq!(store.cancel_batch(stranger, &batch.id, 9).await.unwrap(), None);
        assert_eq!(store.delete_batch(stranger, &batch.id, 9).await.unwrap(), None);
    }
    assert_eq!(store.delete_batch(&mine, &batch.id, 9).await.unwrap(), Some(1));
}
