//! Backups, from either engine into either.

use std::collections::BTreeMap;

use super::kept::Kept;
use super::*;
use crate::store::backup::{BackupError, Kind, Reader, TABLES, Writer};
use crate::store::{NewBatchRow, NewDeliveryRow, NewMemberRow, Settled};

/// At least a row of every table, and no job that runs.
async fn fill(store: &dyn Store) {
    let owner = Reach { owner: "rig".into(), reads_all: false, changes_all: false };
    let odd = "tab\t, line\nand\r\\N \\. 'quoted' \"ü\" {\"a\":[1]}";
    let every_byte: Vec<u8> = (0..=255).collect();
    let measured = MeasurementRow {
        name: Some(odd.into()),
        operator: Some(String::new()),
        measured_at: Some("2024-05-06T07:08:09.25+02:00".into()),
        magnitude_min: 1.0 / 3.0,
        omega_max_rad_s: 1e-300,
        ..measurement(&id())
    };
    let files = [file(&every_byte), file(b"")];
    store.insert_measurement(&owner, &measured, &files, Some(&key("k", "body"))).await.unwrap();
    let bare = MeasurementRow { measured_at: None, quantities: None, ..measurement(&id()) };
    store.insert_measurement(&all(), &bare, &[file(b"x")], None).await.unwrap();

    let hook = WebhookRow {
        id: "hook".into(),
        created_at_ms: 0,
        url: "https://receiver.example/hook".into(),
        secret: "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw".into(),
        events: r#"["job.finished"]"#.into(),
        disabled: None,
        owner: "rig".into(),
    };
    store.insert_webhook(&owner, &hook, 9).await.unwrap();
    // Measured after the other, though the text says less; and submitted before.
    let later =
        MeasurementRow { measured_at: Some("2024-05-06T06:00:00Z".into()), ..measurement(&id()) };
    store.insert_measurement(&owner, &later, &[], None).await.unwrap();
    for (measured, outcome) in [
        (&later, Outcome::Succeeded("{}".into())),
        (&measured, Outcome::Succeeded(odd.into())),
        (&measured, Outcome::Failed(odd.into())),
        (&measured, Outcome::Cancelled),
    ] {
        let row = NewJobRow { submitter: "rig".into(), ..new_job(&measured.id) };
        store.insert_job(&owner, &row, Some(&key(&row.id, "b"))).await.unwrap();
        let lease = lease(store, LONG).await.unwrap();
        let points: Vec<_> = (0..3).map(point).collect();
        store.heartbeat(&lease, LONG, Some(odd), &points).await.unwrap();
        store.finish(&lease, &outcome).await.unwrap();
    }
    let message = |id: &str, webhook_id: Option<&str>| NewDeliveryRow {
        id: format!("msg_{id}"),
        webhook_id: webhook_id.map(str::to_owned),
        event: "job.finished".into(),
        topic: "jobs/1/finished".into(),
        body: odd.into(),
    };
    let event = store.events(10).await.unwrap()[0].id;
    store.announce(event, &[message("a", Some("hook")), message("b", None)]).await.unwrap();
    let due = store.due(LONG, true).await.unwrap().unwrap();
    store.settle(&due, &Settled::Later(LONG), Some(503), Some(odd)).await.unwrap();
    let handed_back = NewJobRow { submitter: odd.into(), ..new_job(&bare.id) };
    store.insert_job(&all(), &handed_back, None).await.unwrap();
    let lease = lease(store, LONG).await.unwrap();
    store.hand_back(&lease).await.unwrap();
    queued_job(store).await;
    let member = NewMemberRow {
        job_id: id(),
        measurement_id: bare.id.clone(),
        request: "{}".into(),
        file: Some(odd.into()),
    };
    let batch = NewBatchRow {
        id: id(),
        name: Some(odd.into()),
        submitter: "rig".into(),
        kind: "diagnose".into(),
        priority: Priority::High,
        request: "{}".into(),
        jobs: vec![member],
    };
    store.insert_batch(&owner, &batch, None).await.unwrap();

    let mapping =
        MappingRow { name: odd.into(), settings: odd.into(), layout: None, updated_at_ms: 0 };
    store.put_mapping(&owner, &mapping, 10).await.unwrap();
    store.insert_key(&keys::key_row("rig", Some(1))).await.unwrap();
    store.insert_session("digest", "rig", 5).await.unwrap();
    store.ping().await.unwrap();
}

async fn backed_up(store: &dyn Store) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = Writer::new(&mut bytes).unwrap();
    store.back_up(&mut writer).await.unwrap();
    writer.finish().unwrap();
    bytes
}

async fn restored(store: &dyn Store, backup: &[u8]) -> Result<(), BackupError> {
    store.restore(&mut Reader::new(backup).unwrap()).await
}

#[tokio::test]
async fn every_table_and_column_of_either_engine_is_backed_up() {
    let kind = |kind: Kind, engine: [&'static str; 5]| match kind {
        Kind::Integer => engine[0],
        Kind::Real => engine[1],
        Kind::Text => engine[2],
        Kind::Bytes => engine[3],
        Kind::Flag => engine[4],
    };
    let known = |engine| -> BTreeMap<String, BTreeMap<String, String>> {
        let columns = |table: &'static crate::store::backup::Table| {
            let columns = table.columns.iter();
            columns.map(move |one| (one.name.into(), kind(one.kind, engine).into())).collect()
        };
        TABLES.iter().map(|table| (table.name.into(), columns(table))).collect()
    };
    let of_sqlite = ["INTEGER", "REAL", "TEXT", "BLOB", "INTEGER"];
    assert_eq!(Kept::sqlite().await.catalogue().await, known(of_sqlite));
    let Some(postgres) = Kept::postgres().await else { return };
    let of_postgres = ["bigint", "double precision", "text", "bytea", "boolean"];
    assert_eq!(postgres.catalogue().await, known(of_postgres));
}

#[tokio::test]
async fn everything_goes_from_sqlite_to_sqlite() {
    let (source, target) = (Kept::sqlite().await, Kept::sqlite().await);
    fill(source.store()).await;
    let before = source.dump().await;
    assert!(before.values().all(|rows| !rows.is_empty()), "{before:#?}");
    restored(target.store(), &backed_up(source.store()).await).await.unwrap();
    assert_eq!(target.dump().await, before);
}

#[tokio::test]
async fn everything_goes_from_either_engine_to_the_other_and_back() {
    for begins_in_sqlite in [true, false] {
        let Some(postgres) = Kept::postgres().await else { return };
        let mut stores = [Kept::sqlite().await, postgres];
        if !begins_in_sqlite {
            stores.reverse();
        }
        let [source, target] = stores;
        fill(source.store()).await;
        let before = source.dump().await;
        assert!(before.values().all(|rows| !rows.is_empty()), "{before:#?}");
        let backup = backed_up(source.store()).await;
        restored(target.store(), &backup).await.unwrap();
        assert_eq!(target.dump().await, before);
        assert!(backed_up(target.store()).await == backup, "the file depends on the engine");
        let times = async |store: &dyn Store| {
            let all = store.results(&all(), &ResultFilter::default(), 9).await.unwrap();
            all.into_iter().map(|result| result.at_ms).collect::<Vec<_>>()
        };
        let by_time = times(target.store()).await;
        assert_eq!(by_time, times(source.store()).await);
        assert_eq!(by_time.len(), 2);
        // What comes next does not collide with what was restored.
        let ended = lease(target.store(), LONG).await.unwrap();
        assert!(target.store().finish(&ended, &Outcome::Cancelled).await.unwrap());
        assert_eq!(target.store().events(10).await.unwrap().last().unwrap().job_id, ended.job_id);
    }
}

async fn a_store_that_has_something_is_left_alone(target: &Kept) {
    let source = Kept::sqlite().await;
    fill(source.store()).await;
    let backup = backed_up(source.store()).await;
    target.store().insert_key(&keys::key_row("first", None)).await.unwrap();
    let before = target.dump().await;
    let refused = restored(target.store(), &backup).await.unwrap_err().to_string();
    assert!(refused.contains("into an empty store only, and this one has rows in keys"));
    assert_eq!(target.dump().await, before);
}

async fn a_damaged_backup_leaves_nothing_behind(target: &Kept) {
    let source = Kept::sqlite().await;
    fill(source.store()).await;
    let backup = backed_up(source.store()).await;
    let empty = target.dump().await;
    for share in [2, 3, 4, 5] {
        let cut = &backup[..backup.len() * (share - 1) / share];
        let refused = restored(target.store(), cut).await;
        assert!(matches!(refused, Err(BackupError::Damaged(_))), "{refused:?}");
        assert_eq!(target.dump().await, empty);
    }
    restored(target.store(), &backup).await.unwrap();
    assert_eq!(target.dump().await, source.dump().await);
}

async fn jobs_that_ran_are_queued_again_and_not_charged(target: &Kept) {
    let source = Kept::sqlite().await;
    let running = leased_job(source.store(), LONG).await;
    let unwanted = leased_job(source.store(), LONG).await;
    source.store().cancel(&all(), &unwanted.job_id).await.unwrap();
    restored(target.store(), &backed_up(source.store()).await).await.unwrap();
    let store = target.store();
    assert_eq!(store.recover_expired(NO_WAIT).await.unwrap(), Recovered::default());
    assert_eq!(status(store, &unwanted.job_id).await, Status::Cancelled);
    assert_eq!(store.events(9).await.unwrap()[0].job_id, unwanted.job_id);
    assert!(!store.finish(&running, &Outcome::Cancelled).await.unwrap(), "it was of the other");
    let again = lease(store, LONG).await.unwrap();
    assert_eq!((again.job_id, again.attempt), (running.job_id, running.attempt + 1));
    let job = &target.dump().await["jobs"];
    assert!(job.iter().all(|job| job["charged"] == "0" && job["handed_back"] == "1"), "{job:?}");
}

/// Runs tests on an empty store of each engine.
macro_rules! either {
    ($($test:ident),* $(,)?) => {
        mod into_sqlite {
            $(#[tokio::test]
            async fn $test() {
                super::$test(&super::Kept::sqlite().await).await;
            })*
        }

        mod into_postgres {
            $(#[tokio::test]
            async fn $test() {
                let Some(target) = super::Kept::postgres().await else { return };
                super::$test(&target).await;
            })*
        }
    };
}

either!(
    a_store_that_has_something_is_left_alone,
    a_damaged_backup_leaves_nothing_behind,
    jobs_that_ran_are_queued_again_and_not_charged,
);

/// Jobs of the large store.
const MANY: i64 = 10_000;

#[tokio::test]
#[ignore = "slow: ten thousand jobs"]
async fn ten_thousand_jobs_go_to_the_other_engine_and_back_while_others_write() {
    let source = Kept::sqlite().await;
    let store = source.store();
    let mut measured = String::new();
    for job in 0..MANY {
        if job % 50 == 0 {
            measured = id();
            let files = [file(&vec![b'x'; 20_000])];
            store.insert_measurement(&all(), &measurement(&measured), &files, None).await.unwrap();
        }
        queued_job_of(store, &measured, "").await;
        let lease = lease(store, LONG).await.unwrap();
        let points: Vec<_> = (0..20).map(point).collect();
        store.heartbeat(&lease, LONG, None, &points).await.unwrap();
        let result = Outcome::Succeeded(format!("{{\"text\":\"{}\"}}", "y".repeat(4000)));
        store.finish(&lease, &result).await.unwrap();
    }
    let before = source.dump().await;
    let write = async {
        for _ in 0..500 {
            queued_job_of(store, &measured, "").await;
        }
    };
    let (during, ()) = tokio::join!(backed_up(store), write);
    let again = Kept::sqlite().await;
    restored(again.store(), &during).await.unwrap();
    let (one_moment, after) = (again.dump().await, source.dump().await);
    for (table, rows) in &before {
        assert!(rows.iter().all(|row| one_moment[table].binary_search(row).is_ok()), "{table}");
        assert!(one_moment[table].iter().all(|row| after[table].binary_search(row).is_ok()));
    }

    let Some(postgres) = Kept::postgres().await else { return };
    let backup = backed_up(store).await;
    restored(postgres.store(), &backup).await.unwrap();
    let back = Kept::sqlite().await;
    restored(back.store(), &backed_up(postgres.store()).await).await.unwrap();
    for target in [&postgres, &back] {
        let moved = target.dump().await;
        for (table, rows) in &after {
            assert!(moved[table] == *rows, "{table} differs");
        }
    }
}
