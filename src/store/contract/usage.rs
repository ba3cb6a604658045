//! What a key has stored, queued and computed.

use super::owners::of;
use super::*;

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
