//! What is to be told, from the end of a job to the answer of a receiver.

use super::*;
use crate::store::{DueRow, NewDeliveryRow, Settled, WebhookRow};

fn webhook(id: &str) -> WebhookRow {
    WebhookRow {
        id: id.to_owned(),
        created_at_ms: 0,
        url: "https://receiver.example/hook".into(),
        secret: "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw".into(),
        events: r#"["job.finished"]"#.into(),
        disabled: None,
        owner: String::new(),
    }
}

async fn stored_webhook(store: &dyn Store) -> String {
    let id = id();
    assert!(store.insert_webhook(&all(), &webhook(&id), 100).await.unwrap());
    id
}

/// Ends a job and turns its event into a message to each receiver, oldest first.
async fn announced(store: &dyn Store, receivers: &[Option<&str>]) -> Vec<String> {
    let lease = leased_job(store, LONG).await;
    store.finish(&lease, &Outcome::Cancelled).await.unwrap();
    let event = store.events(10).await.unwrap().pop().expect("the job has ended");
    assert_eq!(event.job_id, lease.job_id);
    let row = |webhook: &Option<&str>| NewDeliveryRow {
        id: format!("msg_{}", id()),
        webhook_id: webhook.map(str::to_owned),
        event: "job.finished".into(),
        topic: "jobs/1/finished".into(),
        body: "{}".into(),
    };
    let rows: Vec<_> = receivers.iter().map(row).collect();
    assert!(store.announce(event.id, &rows).await.unwrap());
    rows.into_iter().map(|row| row.id).collect()
}

async fn taken(store: &dyn Store) -> DueRow {
    store.due(LONG, true).await.unwrap().expect("one is due")
}

pub(super) async fn every_way_to_end_a_job_leaves_one_event(store: &dyn Store) {
    let mut ended = Vec::new();
    for outcome in
        [Outcome::Succeeded("{}".into()), Outcome::Failed("{}".into()), Outcome::Cancelled]
    {
        let lease = leased_job(store, LONG).await;
        assert!(store.finish(&lease, &outcome).await.unwrap());
        assert!(!store.finish(&lease, &outcome).await.unwrap());
        ended.push(lease.job_id);
    }
    let queued = queued_job(store).await;
    store.cancel(&all(), &queued).await.unwrap();
    ended.push(queued);
    let unwanted = leased_job(store, LONG).await;
    store.cancel(&all(), &unwanted.job_id).await.unwrap();
    store.hand_back(&unwanted).await.unwrap();
    ended.push(unwanted.job_id);
    let killed = leased_job(store, EXPIRED).await;
    store.cancel(&all(), &killed.job_id).await.unwrap();
    store.recover_expired(NO_WAIT).await.unwrap();
    ended.push(killed.job_id);
    // Back in the queue is no end.
    let handed_back = leased_job(store, LONG).await;
    store.hand_back(&handed_back).await.unwrap();
    let events = store.events(100).await.unwrap();
    assert_eq!(
        events.iter().map(|event| &event.job_id).collect::<Vec<_>>(),
        Vec::from_iter(&ended)
    );
    store.delete_job(&all(), &ended[0]).await.unwrap();
    assert_eq!(store.events(100).await.unwrap().len(), ended.len() - 1);
}

pub(super) async fn an_event_is_announced_once(store: &dyn Store) {
    let hook = stored_webhook(store).await;
    let lease = leased_job(store, LONG).await;
    store.finish(&lease, &Outcome::Cancelled).await.unwrap();
    let event = store.events(10).await.unwrap().pop().unwrap();
    let row = |webhook: &str| NewDeliveryRow {
        id: id(),
        webhook_id: Some(webhook.to_owned()),
        event: "job.finished".into(),
        topic: String::new(),
        body: "{}".into(),
    };
    assert!(store.announce(event.id, &[row(&hook), row("nobody")]).await.unwrap());
    assert!(!store.announce(event.id, &[row(&hook)]).await.unwrap());
    assert_eq!(store.deliveries(&all(), &hook, 10).await.unwrap().len(), 1);
    assert_eq!((store.waiting().await.unwrap(), store.events(10).await.unwrap().len()), (1, 0));
}

pub(super) async fn one_message_at_a_time_is_under_way_to_a_receiver(store: &dyn Store) {
    let [first, second] = [stored_webhook(store).await, stored_webhook(store).await];
    let receivers = [Some(first.as_str()), Some(second.as_str()), None];
    let ids = [announced(store, &receivers).await, announced(store, &receivers).await].concat();
    let under_way = [taken(store).await, taken(store).await, taken(store).await];
    assert_eq!(under_way.each_ref().map(|due| &due.id), [&ids[0], &ids[1], &ids[2]]);
    assert_eq!(store.due(LONG, true).await.unwrap(), None);
    let DueRow { attempt, url, secret, topic, .. } = &under_way[0];
    let sent = webhook(&first);
    assert_eq!((*attempt, url, secret), (1, &sent.url, &sent.secret));
    assert_eq!(topic, "jobs/1/finished");
    for due in &under_way {
        assert!(store.settle(due, &Settled::Delivered, Some(204), None).await.unwrap());
    }
    assert_eq!(taken(store).await.id, ids[3]);
    assert_eq!(taken(store).await.id, ids[4]);
    assert_eq!(store.due(LONG, false).await.unwrap(), None, "without a broker its own wait");
    assert_eq!(taken(store).await.id, ids[5]);
}

pub(super) async fn a_failed_message_waits_and_keeps_its_reason(store: &dyn Store) {
    let hook = stored_webhook(store).await;
    let ids = announced(store, &[Some(&hook)]).await;
    let due = taken(store).await;
    let later = Settled::Later(LONG);
    assert!(store.settle(&due, &later, Some(500), Some("it answered 500")).await.unwrap());
    assert_eq!(store.due(LONG, true).await.unwrap(), None);
    let rows = store.deliveries(&all(), &hook, 10).await.unwrap();
    assert_eq!((rows[0].id.as_str(), rows[0].attempts), (ids[0].as_str(), 1));
    assert_eq!((rows[0].answered, rows[0].error.as_deref()), (Some(500), Some("it answered 500")));
    assert!(rows[0].due_ms - rows[0].created_at_ms >= 600_000 && rows[0].ended_at_ms.is_none());

    announced(store, &[Some(&hook)]).await;
    let due = taken(store).await;
    assert!(store.settle(&due, &Settled::GivenUp, None, Some("no")).await.unwrap());
    let rows = store.deliveries(&all(), &hook, 10).await.unwrap();
    assert_eq!(rows[0].status, "given_up");
    assert!(rows[0].ended_at_ms.is_some());
}

pub(super) async fn a_message_under_way_is_due_again_when_its_sender_is_killed(store: &dyn Store) {
    let hook = stored_webhook(store).await;
    announced(store, &[Some(&hook)]).await;
    let killed = store.due(EXPIRED, true).await.unwrap().expect("one is due");
    let second = taken(store).await;
    assert_eq!((&second.id, second.attempt), (&killed.id, 2));
    assert!(!store.settle(&killed, &Settled::Delivered, Some(200), None).await.unwrap());
    assert!(store.settle(&second, &Settled::Delivered, Some(200), None).await.unwrap());
}

pub(super) async fn a_receiver_that_wants_no_more_is_told_no_more(store: &dyn Store) {
    let hook = stored_webhook(store).await;
    announced(store, &[Some(&hook)]).await;
    announced(store, &[Some(&hook)]).await;
    let due = taken(store).await;
    assert!(store.settle(&due, &Settled::Disabled, Some(410), Some("gone")).await.unwrap());
    let row = store.webhook(&all(), &hook).await.unwrap().expect("it stays");
    assert_eq!(row.disabled.as_deref(), Some("gone"));
    let rows = store.deliveries(&all(), &hook, 10).await.unwrap();
    assert!(rows.iter().all(|row| row.status == "given_up"), "{rows:?}");
    announced(store, &[Some(&hook)]).await;
    assert_eq!(store.waiting().await.unwrap(), 0);
}

pub(super) async fn webhooks_are_listed_counted_and_deleted_with_their_messages(store: &dyn Store) {
    let [first, second] = [stored_webhook(store).await, stored_webhook(store).await];
    assert!(!store.insert_webhook(&all(), &webhook(&id()), 2).await.unwrap());
    assert_eq!(
        store.webhooks(&all(), Some(1)).await.unwrap()[..],
        [store.webhook(&all(), &second).await.unwrap().unwrap()]
    );
    let listed = store.webhooks(&all(), None).await.unwrap();
    assert_eq!(listed.iter().map(|row| &row.id).collect::<Vec<_>>(), [&second, &first]);
    let created_at_ms = listed[1].created_at_ms;
    assert_eq!(listed[1], WebhookRow { created_at_ms, ..webhook(&first) });
    announced(store, &[Some(&first), Some(&second)]).await;
    let due = taken(store).await;
    assert!(store.delete_webhook(&all(), &first).await.unwrap());
    assert!(!store.delete_webhook(&all(), &first).await.unwrap());
    assert!(!store.settle(&due, &Settled::Delivered, Some(200), None).await.unwrap());
    assert_eq!(
        (store.webhook(&all(), &first).await.unwrap(), store.waiting().await.unwrap()),
        (None, 1)
    );
}

pub(super) async fn old_messages_are_deleted(store: &dyn Store) {
    let hook = stored_webhook(store).await;
    announced(store, &[Some(&hook), None]).await;
    assert_eq!(store.delete_deliveries(LONG, 10).await.unwrap(), 0);
    tokio::time::sleep(Duration::from_millis(5)).await;
    assert_eq!(store.delete_deliveries(Duration::from_millis(1), 1).await.unwrap(), 1);
    assert_eq!(store.delete_deliveries(Duration::from_millis(1), 10).await.unwrap(), 1);
    assert!(store.webhook(&all(), &hook).await.unwrap().is_some());
}
