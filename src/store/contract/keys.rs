//! Keys, sessions, and rows of different owners.

use super::*;

/// Longer than the clock of the database is coarse.
const TICK: Duration = Duration::from_millis(5);

pub(super) fn key_row(id: &str, expires_at_ms: Option<i64>) -> KeyRow {
    KeyRow {
        id: id.into(),
        name: "rig 7".into(),
        scopes: "[\"read\"]".into(),
        sha256: format!("digest of {id}"),
        created_at_ms: 0,
        expires_at_ms,
        revoked_at_ms: None,
        used_at_ms: None,
        quotas: "{}".into(),
        now_ms: 0,
    }
}

pub(super) async fn a_key_is_valid_until_it_expires_or_is_revoked(store: &dyn Store) {
    assert!(!store.has_keys().await.unwrap());
    assert_eq!(store.key("a").await.unwrap(), None);
    assert!(store.insert_key(&key_row("a", None)).await.unwrap());
    let other = KeyRow { sha256: "another".into(), ..key_row("a", None) };
    assert!(!store.insert_key(&other).await.unwrap(), "the first one stays");
    let a = store.key("a").await.unwrap().unwrap();
    assert_eq!((a.sha256.as_str(), a.used_at_ms, a.is_valid()), ("digest of a", None, true));
    assert!(a.created_at_ms > 0 && a.now_ms >= a.created_at_ms);
    assert!(store.has_keys().await.unwrap() && store.has_valid_key().await.unwrap());

    store.key_used("a").await.unwrap();
    assert!(store.key("a").await.unwrap().unwrap().used_at_ms.is_some());
    assert!(store.replace_key("a", "new", Some(a.now_ms + 60_000)).await.unwrap());
    let replaced = store.key("a").await.unwrap().unwrap();
    assert_eq!((replaced.sha256.as_str(), replaced.is_valid()), ("new", true));

    assert!(store.revoke_key("a").await.unwrap() && !store.revoke_key("b").await.unwrap());
    let revoked = store.key("a").await.unwrap().unwrap();
    assert!(revoked.revoked_at_ms.is_some() && !revoked.is_valid());
    assert!(!store.replace_key("a", "newer", None).await.unwrap(), "it was revoked");
    assert!(store.insert_key(&key_row("b", Some(a.now_ms))).await.unwrap());
    assert!(!store.key("b").await.unwrap().unwrap().is_valid(), "it has expired");
    assert!(store.has_keys().await.unwrap() && !store.has_valid_key().await.unwrap());
    assert_eq!(store.keys(10).await.unwrap().len(), 2);
    assert_eq!(store.keys(1).await.unwrap().len(), 1);
}

pub(super) async fn a_key_has_quotas_of_its_own_from_its_start_or_later(store: &dyn Store) {
    let row = KeyRow { quotas: "{\"jobs\":1}".into(), ..key_row("a", None) };
    store.insert_key(&row).await.unwrap();
    store.insert_key(&key_row("b", None)).await.unwrap();
    let quotas = async |id: &str| store.key(id).await.unwrap().unwrap().quotas;
    assert_eq!((quotas("a").await, quotas("b").await), ("{\"jobs\":1}".into(), "{}".into()));
    assert!(store.limit_key("a", "{\"mib\":2}").await.unwrap());
    assert!(!store.limit_key("c", "{}").await.unwrap(), "there is none");
    assert_eq!((quotas("a").await, quotas("b").await), ("{\"mib\":2}".into(), "{}".into()));
    let end = store.key("a").await.unwrap().unwrap().now_ms + 600_000;
    store.insert_session("one", "a", end).await.unwrap();
    assert_eq!(store.session("one").await.unwrap().unwrap().quotas, "{\"mib\":2}");
    assert!(store.keys(10).await.unwrap().iter().any(|key| key.quotas == "{\"mib\":2}"));
    store.replace_key("a", "new", None).await.unwrap();
    assert_eq!(quotas("a").await, "{\"mib\":2}", "another secret changes nothing of it");
}

pub(super) async fn a_session_is_of_its_key_until_either_ends(store: &dyn Store) {
    store.insert_key(&key_row("a", None)).await.unwrap();
    let now = store.key("a").await.unwrap().unwrap().now_ms;
    store.insert_session("one", "a", now + 600_000).await.unwrap();
    store.insert_session("two", "a", now + 600_000).await.unwrap();
    store.insert_session("ended", "a", now).await.unwrap();
    store.insert_session("of nobody", "b", now + 600_000).await.unwrap_err();
    assert_eq!(store.session("one").await.unwrap().unwrap().id, "a");
    assert_eq!(store.session("ended").await.unwrap(), None);
    assert_eq!(store.session("nothing").await.unwrap(), None);
    store.delete_session("one").await.unwrap();
    assert_eq!(store.session("one").await.unwrap(), None);
    assert!(store.session("two").await.unwrap().is_some());
    store.replace_key("a", "new", None).await.unwrap();
    assert_eq!(store.session("two").await.unwrap(), None, "the key has another secret");
    store.insert_session("three", "a", now + 600_000).await.unwrap();
    store.revoke_key("a").await.unwrap();
    assert_eq!(store.session("three").await.unwrap(), None);
}

pub(super) async fn of_more_sessions_than_a_key_may_have_the_oldest_end(store: &dyn Store) {
    store.insert_key(&key_row("a", None)).await.unwrap();
    store.insert_key(&key_row("b", None)).await.unwrap();
    let end = store.key("a").await.unwrap().unwrap().now_ms + 600_000;
    // Of another key, and older than all.
    store.insert_session("other", "b", end - 1).await.unwrap();
    for (session, later) in [("one", 0), ("three", 2), ("two", 1)] {
        store.insert_session(session, "a", end + later).await.unwrap();
    }
    let left = async || {
        let mut left = Vec::new();
        for session in ["one", "two", "three", "other"] {
            if store.session(session).await.unwrap().is_some() {
                left.push(session);
            }
        }
        left
    };
    store.end_oldest_sessions("a", 3).await.unwrap();
    assert_eq!(left().await, ["one", "two", "three", "other"]);
    store.end_oldest_sessions("a", 1).await.unwrap();
    assert_eq!(left().await, ["three", "other"]);
}

fn of(owner: &str) -> Reach {
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

pub(super) async fn the_usage_of_a_key_is_what_it_has_stored_queued_and_computed(
    store: &dyn Store,
) {
    let of = |owner: &str| Reach { owner: owner.into(), ..Reach::nothing() };
    let usage = async |owner: &str, last| store.usage(owner, last).await.unwrap();
    assert_eq!(usage("a", LONG).await, Usage::default());
    for (owner, bytes) in [("a", 5), ("a", 7), ("b", 11)] {
        let (id, files) = (id(), [file(&vec![b'x'; bytes]), file(b"y")]);
        store.insert_measurement(&of(owner), &measurement(&id), &files, None).await.unwrap();
        store.insert_job(&of(owner), &new_job(&id), None).await.unwrap();
    }
    let stored = Usage { measurements: 2, bytes: 14, unfinished: 2, computed_ms: 0 };
    assert_eq!(usage("a", LONG).await, stored);
    let first = lease(store, LONG).await.unwrap();
    tokio::time::sleep(Duration::from_millis(60)).await;
    let running = usage("a", LONG).await;
    assert!(running.unfinished == 2 && running.computed_ms >= 50, "{running:?}");
    assert!(store.finish(&first, &Outcome::Cancelled).await.unwrap());
    let ended = usage("a", LONG).await;
    assert!(ended.unfinished == 1 && ended.computed_ms >= 50, "{ended:?}");
    tokio::time::sleep(Duration::from_millis(60)).await;
    assert_eq!(usage("a", LONG).await, ended, "it runs no longer");
    let of_late = usage("a", Duration::from_millis(20)).await;
    assert_eq!(of_late.computed_ms, 0, "it ended before");
}

pub(super) async fn what_a_key_computed_counts_in_every_attempt_and_after_its_jobs_are_gone(
    store: &dyn Store,
) {
    let mine = of("a");
    let computed = async |owner: &str| store.usage(owner, LONG).await.unwrap().computed_ms;
    let submit = async || {
        let (id, files) = (id(), [file(b"x")]);
        store.insert_measurement(&mine, &measurement(&id), &files, None).await.unwrap();
        store.insert_job(&mine, &new_job(&id), None).await.unwrap();
        id
    };
    // One that runs for a while.
    let run = async |duration| {
        let lease = lease(store, duration).await.unwrap();
        tokio::time::sleep(Duration::from_millis(60)).await;
        lease
    };
    submit().await;
    let ended = run(LONG).await;
    assert!(store.finish(&ended, &Outcome::Succeeded("{}".into())).await.unwrap());
    let of_one = computed("a").await;
    assert!(of_one >= 50, "{of_one}");
    assert!(store.delete_job(&mine, &ended.job_id).await.unwrap());
    assert_eq!(computed("a").await, of_one, "it is gone, and has been computed");

    let measured = submit().await;
    assert!(store.hand_back(&run(LONG).await).await.unwrap());
    let of_two = computed("a").await;
    assert!(of_two >= of_one + 50, "an attempt that was handed back counts: {of_two}");
    let running = run(LONG).await;
    assert!(store.delete_measurement(&mine, &measured).await.unwrap());
    assert_eq!(store.job(&all(), &running.job_id).await.unwrap(), None);
    let of_three = computed("a").await;
    assert!(of_three >= of_two + 50, "what ran when it was deleted counts: {of_three}");

    // A worker that is heard of no more computes for as long as its lease at most.
    submit().await;
    let lost = run(EXPIRED).await;
    assert!(computed("a").await < of_three + 50);
    store.recover_expired(NO_WAIT).await.unwrap();
    store.cancel(&mine, &lost.job_id).await.unwrap();
    assert!(computed("a").await < of_three + 50);
    assert_eq!(computed("b").await, 0);
}
