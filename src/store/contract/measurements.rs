//! Measurements, idempotency keys, and what goes when something is deleted.

use super::*;

pub(super) async fn a_measurement_comes_back_as_it_was_stored(store: &dyn Store) {
    let id = id();
    let files = [file(b"one"), file(&[0, 255, 10])];
    store.insert_measurement(&all(), &measurement(&id), &files, None).await.unwrap();

    let row = store.measurement(&all(), &id).await.unwrap().expect("it was stored");
    let created_at_ms = row.created_at_ms;
    assert!(created_at_ms > 1_700_000_000_000, "{created_at_ms} is not a time of today in ms");
    let files_of_two = r#"["a.csv","a.csv"]"#.to_owned();
    let stored = MeasurementRow { created_at_ms, files: files_of_two, ..measurement(&id) };
    assert_eq!(row, stored);
    assert_eq!(store.measurement_files(&all(), &id).await.unwrap(), files);
    assert_eq!(store.measurement(&all(), "nobody").await.unwrap(), None);
}

pub(super) async fn a_text_with_the_character_nul_is_kept_or_refused_as_such(store: &dyn Store) {
    let id = id();
    let named = MeasurementRow { name: Some("a\0b".into()), ..measurement(&id) };
    let stored = store.insert_measurement(&all(), &named, &[file(b"x")], None).await;
    assert!(matches!(stored, Ok(_) | Err(StoreError::Unkeepable(_))), "{stored:?}");
    let kept = store.measurement(&all(), &id).await.unwrap();
    assert_eq!(kept.is_some(), stored.is_ok());
    assert!(kept.is_none_or(|row| row.name == named.name), "whole, or not at all");
    let asked = store.job(&all(), "\0").await;
    assert!(matches!(asked, Ok(None) | Err(StoreError::Unkeepable(_))), "{asked:?}");
    stored_measurement(store).await;
}

pub(super) async fn an_idempotency_key_answers_the_same_request_only(store: &dyn Store) {
    let (first, second) = (id(), id());
    let insert = async |id: &str, key: &IdempotencyKey| {
        store.insert_measurement(&all(), &measurement(id), &[file(b"x")], Some(key)).await.unwrap()
    };
    assert_eq!(insert(&first, &key("k", "body")).await, Inserted::Created);
    assert_eq!(insert(&second, &key("k", "body")).await, Inserted::Replayed(first));
    assert_eq!(insert(&second, &key("k", "other body")).await, Inserted::KeyReused);
    assert_eq!(
        store.measurement(&all(), &second).await.unwrap(),
        None,
        "neither may store anything"
    );
    assert_eq!(insert(&second, &key("another k", "body")).await, Inserted::Created);
}

pub(super) async fn requests_with_one_key_at_once_make_one_measurement(store: &dyn Store) {
    let promise = key("k", "body");
    let rows = [(); 4].map(|()| measurement(&id()));
    let inserts = rows.iter().map(async |row| {
        store.insert_measurement(&all(), row, &[file(b"x")], Some(&promise)).await.unwrap()
    });
    let inserted = futures_util::future::join_all(inserts).await;
    let made = inserted.iter().position(|one| *one == Inserted::Created).expect("one is made");
    for (index, one) in inserted.iter().enumerate() {
        let others = Inserted::Replayed(rows[made].id.clone());
        assert_eq!(*one, if index == made { Inserted::Created } else { others });
    }
}

pub(super) async fn a_deleted_measurement_takes_its_jobs_and_keys_with_it(store: &dyn Store) {
    let measured = id();
    let promise = key("k", "body");
    store
        .insert_measurement(&all(), &measurement(&measured), &[file(b"x")], Some(&promise))
        .await
        .unwrap();
    let row = new_job(&measured);
    store.insert_job(&all(), &row, None).await.unwrap();
    let lease = lease(store, LONG).await.expect("it is queued");
    assert!(store.delete_measurement(&all(), &measured).await.unwrap());
    assert!(!store.delete_measurement(&all(), &measured).await.unwrap());
    assert_eq!(store.job(&all(), &row.id).await.unwrap(), None);
    assert!(store.measurement_files(&all(), &measured).await.unwrap().is_empty());
    assert_eq!(store.heartbeat(&lease, LONG, None, &[point(0)]).await.unwrap(), Beat::Lost);
    assert!(!store.finish(&lease, &Outcome::Cancelled).await.unwrap());
    assert!(store.history(&all(), &row.id, 0, 10).await.unwrap().is_empty());
    let again =
        store.insert_measurement(&all(), &measurement(&id()), &[], Some(&promise)).await.unwrap();
    assert_eq!(again, Inserted::Created);
}

pub(super) async fn a_job_of_an_unknown_measurement_is_refused(store: &dyn Store) {
    let row = new_job("nobody");
    store.insert_job(&all(), &row, Some(&key("k", "body"))).await.unwrap_err();
    assert_eq!(store.job(&all(), &row.id).await.unwrap(), None);
}

pub(super) async fn a_deleted_job_takes_its_key_with_it(store: &dyn Store) {
    let ended = leased_job(store, LONG).await;
    store.finish(&ended, &Outcome::Cancelled).await.unwrap();
    let promise = key("k", "body");
    let job = || new_job(&ended.measurement_id);
    let first = job();
    assert_eq!(store.insert_job(&all(), &first, Some(&promise)).await.unwrap(), Inserted::Created);
    store.cancel(&all(), &first.id).await.unwrap();
    store.delete_job(&all(), &first.id).await.unwrap();
    assert_eq!(store.insert_job(&all(), &job(), Some(&promise)).await.unwrap(), Inserted::Created);
}
