//! Lists, their pages and filters.

use super::*;

pub(super) async fn lists_are_paged_newest_first_and_filtered(store: &dyn Store) {
    let ids = [
        stored_measurement(store).await,
        stored_measurement(store).await,
        stored_measurement(store).await,
    ];
    let everything = MeasurementFilter::default();
    let first = Page { limit: 2, before: None };
    let rows = store.measurements(&all(), &everything, &first).await.unwrap();
    assert_eq!(rows.iter().map(|row| &row.id).collect::<Vec<_>>(), [&ids[2], &ids[1]]);
    let second = Page { limit: 2, before: Some(ids[1].clone()) };
    let rows = store.measurements(&all(), &everything, &second).await.unwrap();
    assert_eq!(rows.iter().map(|row| &row.id).collect::<Vec<_>>(), [&ids[0]]);

    let elsewhere = MeasurementFilter { machine: Some("press 5".into()), ..everything.clone() };
    assert!(store.measurements(&all(), &elsewhere, &first).await.unwrap().is_empty());
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
    assert_eq!(store.measurements(&all(), &here, &first).await.unwrap().len(), 2);
    for text in ["press", "PRESS 4", "north", "A.csv"] {
        let found = MeasurementFilter { text: Some(text.into()), ..here.clone() };
        assert_eq!(store.measurements(&all(), &found, &first).await.unwrap().len(), 2, "{text}");
    }
    for wrong in [
        MeasurementFilter { text: Some("press_4".into()), ..here.clone() },
        MeasurementFilter { sha256: Some("00".into()), ..here.clone() },
        MeasurementFilter { labels: vec![("site".into(), "south".into())], ..here.clone() },
        MeasurementFilter { until_ms: Some(1_700_000_000_000), ..here.clone() },
        MeasurementFilter { measured_since_ms: Some(1_714_979_289_001), ..here.clone() },
        MeasurementFilter { measured_until_ms: Some(1_714_979_289_000), ..here.clone() },
    ] {
        assert!(store.measurements(&all(), &wrong, &first).await.unwrap().is_empty(), "{wrong:?}");
    }

    let job = queued_job(store).await;
    let queued = JobFilter {
        status: Some(Status::Queued),
        kind: Some("identify".into()),
        machine: Some("press 4".into()),
        axis: Some("x".into()),
        labels: vec![("site".into(), "north".into())],
        since_ms: Some(1_700_000_000_000),
        text: Some("press 4".into()),
        ..JobFilter::default()
    };
    let running = JobFilter { status: Some(Status::Running), ..JobFilter::default() };
    assert_eq!(store.jobs(&all(), &queued, &first).await.unwrap()[0].id, job);
    assert!(store.jobs(&all(), &running, &first).await.unwrap().is_empty());
    for wrong in [
        JobFilter { kind: Some("diagnose".into()), ..queued.clone() },
        JobFilter { machine: Some("press 5".into()), ..queued.clone() },
        JobFilter { text: Some("press 5".into()), ..queued.clone() },
        JobFilter { verdict: Some("explained".into()), ..queued.clone() },
        JobFilter { labels: vec![("shift".into(), "night".into())], ..queued.clone() },
        JobFilter { until_ms: Some(1_700_000_000_000), ..queued.clone() },
    ] {
        assert!(store.jobs(&all(), &wrong, &first).await.unwrap().is_empty(), "{wrong:?}");
    }
}

pub(super) async fn a_measurement_says_something_else_of_itself(store: &dyn Store) {
    let (one, other) = (stored_measurement(store).await, stored_measurement(store).await);
    let description = Description {
        name: Some("before the repair".into()),
        machine: None,
        axis: Some("z".into()),
        operator: None,
        measured_at: None,
        labels: "{}".into(),
    };
    assert!(store.describe_measurement(&all(), &one, &description).await.unwrap());
    let row = store.measurement(&all(), &one).await.unwrap().unwrap();
    let said = (row.name.as_deref(), row.machine.as_deref(), row.axis.as_deref());
    assert_eq!(said, (Some("before the repair"), None, Some("z")));
    assert_eq!((row.measured_at, row.labels.as_str()), (None, "{}"));
    let row = store.measurement(&all(), &other).await.unwrap().unwrap();
    assert_eq!(row.machine.as_deref(), Some("press 4"));
    assert!(!store.describe_measurement(&all(), "nobody", &description).await.unwrap());
}

/// Another reading, with what is given beside the files, if anything.
pub(super) fn reread(given: Option<&[u8]>) -> RereadRow {
    let row = MeasurementRow {
        name: Some("not taken over".into()),
        sha256: "11ff".into(),
        experiments: 7,
        magnitude_max: 30.0,
        quantities: Some(r#"{"input":"force"}"#.into()),
        notes: r#"["read again"]"#.into(),
        ..measurement("not taken over")
    };
    let given = given.map(|bytes| FileRow { name: "given".into(), ..file(bytes) });
    RereadRow { row, given_name: "given", given }
}

pub(super) async fn files_are_read_again_until_there_is_a_job(store: &dyn Store) {
    let (one, other) = (stored_measurement(store).await, stored_measurement(store).await);
    let files = async || {
        let files = store.measurement_files(&all(), &one).await.unwrap();
        files.into_iter().map(|file| (file.name, file.bytes)).collect::<Vec<_>>()
    };
    let own = ("a.csv".to_owned(), b"x".to_vec());
    for bytes in [b"a", b"b"] {
        let again = reread(Some(bytes));
        let outcome = store.reread_measurement(&all(), &one, &again).await.unwrap();
        assert_eq!(outcome, Rereading::Stored);
        assert_eq!(files().await, [own.clone(), ("given".to_owned(), bytes.to_vec())]);
    }
    let row = store.measurement(&all(), &one).await.unwrap().unwrap();
    assert_eq!((row.id.as_str(), row.name.as_deref()), (one.as_str(), Some("stepped sine")));
    let wanted = reread(None).row;
    assert_eq!((row.sha256, row.experiments), (wanted.sha256, 7));
    assert_eq!((row.quantities, row.notes), (wanted.quantities, wanted.notes));
    assert_eq!((row.magnitude_min, row.magnitude_max), (1.0, 30.0));
    let untouched = store.measurement(&all(), &other).await.unwrap().unwrap();
    assert_eq!(untouched.sha256, "00ff");

    let nothing = reread(None);
    let outcome = store.reread_measurement(&all(), &one, &nothing).await.unwrap();
    assert_eq!((outcome, files().await), (Rereading::Stored, vec![own]));
    let job = queued_job_of(store, &one, "").await;
    let late = reread(Some(b"late"));
    let outcome = store.reread_measurement(&all(), &one, &late).await.unwrap();
    assert_eq!((outcome, files().await.len()), (Rereading::HasJobs, 1));
    assert!(store.delete_job(&all(), &job).await.unwrap());
    let outcome = store.reread_measurement(&all(), &one, &late).await.unwrap();
    assert_eq!((outcome, files().await.len()), (Rereading::Stored, 2));
    let outcome = store.reread_measurement(&all(), "nobody", &late).await.unwrap();
    assert_eq!(outcome, Rereading::Unknown);
}

pub(super) async fn results_are_listed_by_when_they_were_measured(store: &dyn Store) {
    let mut jobs = Vec::new();
    for (axis, measured_at) in [("x", Some("2024-05-06T07:08:09Z")), ("x", None), ("y", None)] {
        let row = MeasurementRow {
            axis: Some(axis.into()),
            measured_at: measured_at.map(str::to_owned),
            ..measurement(&id())
        };
        store.insert_measurement(&all(), &row, &[file(b"x")], None).await.unwrap();
        for _ in 0..2 {
            let job = new_job(&row.id);
            store.insert_job(&all(), &job, None).await.unwrap();
            let lease = lease(store, LONG).await.expect("it is queued");
            store.finish(&lease, &Outcome::Succeeded("{}".into())).await.unwrap();
            jobs.push(job.id);
        }
    }
    let listed = async |filter: ResultFilter| {
        let rows = store.results(&all(), &filter, 100).await.unwrap();
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

    let axes = store.axes(&all(), Some("press 4"), 100).await.unwrap();
    let counts: Vec<_> =
        axes.iter().map(|axis| (axis.axis.as_str(), axis.measurements, axis.results)).collect();
    assert_eq!(counts, [("x", 2, 2), ("y", 1, 1)]);
    assert_eq!(Some(axes[0].first_ms), at);
    assert!(store.axes(&all(), Some("press 5"), 100).await.unwrap().is_empty());
}
