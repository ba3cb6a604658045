//! What is deleted because it is old.

use super::*;

pub(super) async fn what_is_old_is_deleted_and_what_is_wanted_is_not(store: &dyn Store) {
    let ended = leased_job(store, LONG).await;
    store.finish(&ended, &Outcome::Succeeded("{}".into())).await.unwrap();
    let queued = queued_job(store).await;
    let nothing = store.delete_older(LONG, 10).await.unwrap();
    assert_eq!((nothing.jobs, nothing.measurements), (0, 0));
    tokio::time::sleep(Duration::from_millis(5)).await;
    let old = store.delete_older(Duration::from_millis(1), 10).await.unwrap();
    assert_eq!((old.jobs, old.measurements), (1, 1));
    assert_eq!(store.job(&all(), &ended.job_id).await.unwrap(), None);
    assert_eq!(store.measurement(&all(), &ended.measurement_id).await.unwrap(), None);
    let kept = store.job(&all(), &queued).await.unwrap().expect("it is still wanted");
    assert!(store.measurement(&all(), &kept.measurement_id).await.unwrap().is_some());
}

pub(super) async fn what_is_old_takes_all_its_keys_with_it(store: &dyn Store) {
    let (measured, promise) = (id(), key("k", "body"));
    let measure = async |id: &str| {
        store.insert_measurement(&all(), &measurement(id), &[], Some(&promise)).await.unwrap()
    };
    let submit = async |measured: &str| {
        store.insert_job(&all(), &new_job(measured), Some(&promise)).await.unwrap()
    };
    assert_eq!(measure(&measured).await, Inserted::Created);
    assert_eq!(submit(&measured).await, Inserted::Created);
    let ended = lease(store, LONG).await.expect("it is queued");
    store.finish(&ended, &Outcome::Succeeded("{}".into())).await.unwrap();
    tokio::time::sleep(Duration::from_millis(5)).await;
    let old = store.delete_older(Duration::from_millis(1), 1).await.unwrap();
    assert_eq!((old.jobs, old.measurements), (1, 1));
    let again = id();
    assert_eq!(measure(&again).await, Inserted::Created);
    assert_eq!(submit(&again).await, Inserted::Created);
}
