//! Rows of different owners.

use super::*;

/// Longer than the clock of the database is coarse.
const TICK: Duration = Duration::from_millis(5);

pub(super) fn of(owner: &str) -> Reach {
    Reach { owner: owner.into(), reads_all: false, changes_all: false }
}

pub(super) async fn rows_of_another_owner_are_not_there(store: &dyn Store) {
    let (mine, theirs) = (of("a"), of("b"));
    let reader = Reach { reads_all: true, ..theirs.clone() };
    let measured = id();
    let promise = key("k", "body");
    let insert = async |reach: &Reach, id: &str| {
        let row = measurement(id);
        store.insert_measurement(reach, &row, &[file(b"x")], Some(&promise)).await.unwrap()
    };
    assert_eq!(insert(&mine, &measured).await, Inserted::Created);
    assert_eq!(insert(&mine, &id()).await, Inserted::Replayed(measured.clone()));
    let others = id();
    assert_eq!(insert(&theirs, &others).await, Inserted::Created);
    assert!(store.delete_measurement(&theirs, &others).await.unwrap());
    let job = NewJobRow {
        id: id(),
        submitter: String::new(),
        measurement_id: measured.clone(),
        kind: "identify".into(),
        priority: Priority::Normal,
        request: "{}".into(),
    };
    store.insert_job(&mine, &job, None).await.unwrap();
    let lease = lease(store, LONG).await.unwrap();
    store.heartbeat(&lease, LONG, None, &[point(0)]).await.unwrap();
    store.finish(&lease, &Outcome::Succeeded("{}".into())).await.unwrap();
    let hook = WebhookRow {
        id: id(),
        created_at_ms: 0,
        url: "https://receiver.example/hook".into(),
        secret: "whsec_".into(),
        events: "[]".into(),
        disabled: None,
        owner: "a".into(),
    };
    assert!(store.insert_webhook(&mine, &hook, 1).await.unwrap());
    assert!(
        !store.insert_webhook(&mine, &WebhookRow { id: id(), ..hook.clone() }, 1).await.unwrap()
    );

    // How much of it each of them finds.
    let page = Page { limit: 10, before: None };
    let found = async |reach: &Reach| {
        let (filter, jobs) = (MeasurementFilter::default(), JobFilter::default());
        [
            store.measurement(reach, &measured).await.unwrap().iter().count(),
            store.measurement_files(reach, &measured).await.unwrap().len(),
            store.measurements(reach, &filter, &page).await.unwrap().len(),
            store.job(reach, &job.id).await.unwrap().iter().count(),
            store.jobs(reach, &jobs, &page).await.unwrap().len(),
            store.result(reach, &job.id).await.unwrap().iter().count(),
            store.results(reach, &ResultFilter::default(), 10).await.unwrap().len(),
            store.axes(reach, None, 10).await.unwrap().len(),
            store.convergence(reach, &job.id).await.unwrap().len(),
            store.history(reach, &job.id, 0, 10).await.unwrap().len(),
            store.webhooks(reach, None).await.unwrap().len(),
            store.webhook(reach, &hook.id).await.unwrap().iter().count(),
        ]
    };
    assert_eq!(found(&mine).await, [1; 12]);
    assert_eq!(found(&all()).await, [1; 12]);
    assert_eq!(found(&reader).await, [1; 12]);
    assert_eq!(found(&theirs).await, [0; 12]);
    assert_eq!(found(&Reach::nothing()).await, [0; 12]);

    for stranger in [&theirs, &reader, &Reach::nothing()] {
        assert_eq!(store.cancel(stranger, &job.id).await.unwrap(), Cancelling::Unknown);
        assert!(!store.delete_job(stranger, &job.id).await.unwrap());
        let none = Description::default();
        assert!(!store.describe_measurement(stranger, &measured, &none).await.unwrap());
        let again = store.reread_measurement(stranger, &measured, &reread(None)).await.unwrap();
        assert_eq!(again, Rereading::Unknown);
        assert!(!store.delete_measurement(stranger, &measured).await.unwrap());
        assert!(!store.delete_webhook(stranger, &hook.id).await.unwrap());
    }
    assert_eq!(found(&mine).await, [1; 12], "nothing is gone");
    let ended = Cancelling::Ended(Status::Succeeded);
    assert_eq!(store.cancel(&mine, &job.id).await.unwrap(), ended);
    assert!(store.delete_job(&all(), &job.id).await.unwrap());
    assert!(store.delete_webhook(&mine, &hook.id).await.unwrap());
    assert!(store.delete_measurement(&mine, &measured).await.unwrap());
}

pub(super) async fn a_later_job_of_another_owner_does_not_hide_a_result(store: &dyn Store) {
    let measured = stored_measurement(store).await;
    for owner in ["a", "b"] {
        let row = NewJobRow {
            id: id(),
            submitter: String::new(),
            measurement_id: measured.clone(),
            kind: "identify".into(),
            priority: Priority::Normal,
            request: "{}".into(),
        };
        store.insert_job(&of(owner), &row, None).await.unwrap();
        let lease = lease(store, LONG).await.unwrap();
        store.finish(&lease, &Outcome::Succeeded(format!("\"{owner}\""))).await.unwrap();
        tokio::time::sleep(TICK).await;
    }
    let latest = ResultFilter { latest_only: true, ..ResultFilter::default() };
    for (reach, expected) in [(of("a"), "\"a\""), (of("b"), "\"b\""), (all(), "\"b\"")] {
        let results = store.results(&reach, &latest, 10).await.unwrap();
        let results: Vec<&str> = results.iter().map(|row| row.result.as_str()).collect();
        assert_eq!(results, [expected]);
    }
}

pub(super) async fn each_owner_has_mappings_of_its_own(store: &dyn Store) {
    let row = |machine: &str| MappingRow {
        name: "rig".into(),
        settings: machine.into(),
        layout: Some("layout".into()),
        updated_at_ms: 0,
    };
    let (first, second) = (of("a"), of("b"));
    let admin = Reach { owner: "c".into(), ..all() };
    let put = async |reach: &Reach, settings: &str| {
        store.put_mapping(reach, &row(settings), 10).await.unwrap()
    };
    assert_eq!(put(&first, "one").await, Some(true));
    assert_eq!(put(&second, "two").await, Some(true));
    assert_eq!(put(&first, "three").await, Some(false));
    let settings = async |reach: &Reach| {
        let by_name = store.mapping(reach, "rig").await.unwrap();
        let by_layout = store.mapping_of_layout(reach, "layout").await.unwrap();
        [by_name, by_layout].map(|row| row.map(|row| row.settings))
    };
    let both = |text: &str| [Some(text.to_owned()), Some(text.to_owned())];
    assert_eq!(settings(&first).await, both("three"));
    assert_eq!(settings(&second).await, both("two"));
    // An admin finds one by its name, but it changes nothing by itself.
    assert_eq!(settings(&admin).await, [Some("three".into()), None]);
    put(&admin, "own").await;
    assert_eq!(settings(&admin).await, both("own"));
    let counts = async |reach: &Reach| store.mappings(reach, 10).await.unwrap().len();
    assert_eq!((counts(&first).await, counts(&admin).await), (1, 3));
    assert!(store.delete_mapping(&admin, "rig").await.unwrap());
    assert_eq!(counts(&admin).await, 2);
    assert!(store.delete_mapping(&first, "rig").await.unwrap());
    assert!(!store.delete_mapping(&first, "rig").await.unwrap(), "the other is not its own");
    assert_eq!(settings(&second).await, both("two"));
}
