//! Jobs on their way through the queue.

use std::sync::Arc;
use std::time::{Duration, Instant};

use futures_util::future::join_all;
use servoscope::store::{
    FileRow, Lease, MeasurementRow, NewJobRow, Outcome, Priority, Reach, Store,
};

/// Longer than anything here takes.
const LEASE: Duration = Duration::from_secs(3600);

fn id() -> String {
    uuid::Uuid::now_v7().to_string()
}

/// Stores a measurement for the jobs, and gives its id.
pub async fn measurement(store: &dyn Store) -> String {
    let row = MeasurementRow {
        id: id(),
        created_at_ms: 0,
        name: None,
        machine: None,
        axis: None,
        operator: None,
        measured_at: None,
        labels: "{}".into(),
        sha256: String::new(),
        experiments: 1,
        highest_harmonic: 1,
        magnitude_min: 1.0,
        magnitude_max: 1.0,
        omega_min_rad_s: 1.0,
        omega_max_rad_s: 1.0,
        notes: "[]".into(),
        quantities: None,
        files: String::new(),
        simulation_s: None,
        diagnosis_s: None,
    };
    let file = FileRow { name: "a.csv".into(), content_type: "text/csv".into(), bytes: vec![] };
    let reach = Reach::everything();
    store.insert_measurement(&reach, &row, &[file], None).await.expect("it is stored");
    row.id
}

/// Queues one job.
pub async fn queue_one(store: &dyn Store, measurement: &str, submitter: &str) {
    let row = NewJobRow {
        id: id(),
        measurement_id: measurement.into(),
        submitter: submitter.into(),
        kind: "identify".into(),
        priority: Priority::Normal,
        request: "{}".into(),
    };
    store.insert_job(&Reach::everything(), &row, None).await.expect("it is queued");
}

/// Queues jobs of as many submitters as there are stores, at once.
pub async fn queue(stores: &[Arc<dyn Store>], measurement: &str, count: usize) {
    let tasks = stores.iter().enumerate().map(|(at, store)| {
        let (store, measurement) = (Arc::clone(store), measurement.to_owned());
        let share = (at..count).step_by(stores.len()).count();
        tokio::spawn(async move {
            for _ in 0..share {
                queue_one(store.as_ref(), &measurement, &at.to_string()).await;
            }
        })
    });
    for task in join_all(tasks).await {
        task.expect("no task panics");
    }
}

/// Takes a job, and says how long that took.
pub async fn take(store: &dyn Store, worker: &str) -> Option<(Lease, Duration)> {
    let began = Instant::now();
    let lease = store.lease(worker, LEASE).await.expect("the queue is read")?;
    Some((lease, began.elapsed()))
}

/// Ends a job.
pub async fn end(store: &dyn Store, lease: &Lease) {
    let ended = store.finish(lease, &Outcome::Succeeded("{}".into())).await;
    assert!(ended.expect("it is stored"), "the lease is valid");
}

/// Every store takes and ends jobs until there are none; how long each took to be taken.
pub async fn take_all(stores: &[Arc<dyn Store>]) -> Vec<Duration> {
    let tasks = stores.iter().enumerate().map(|(at, store)| {
        let store = Arc::clone(store);
        tokio::spawn(async move {
            let (worker, mut times) = (at.to_string(), Vec::new());
            while let Some((lease, time)) = take(store.as_ref(), &worker).await {
                times.push(time);
                end(store.as_ref(), &lease).await;
            }
            times
        })
    });
    let times = join_all(tasks).await.into_iter();
    times.flat_map(|times| times.expect("no task panics")).collect()
}

/// Times that shares of them did not exceed, in milliseconds.
pub fn shares(mut times: Vec<Duration>) -> String {
    times.sort_unstable();
    let at = |share: f64| {
        let rank = (share * times.len() as f64).ceil() as usize;
        times[rank.clamp(1, times.len()) - 1].as_secs_f64() * 1e3
    };
    format!(
        "median {:.2}, 90 % {:.2}, 99 % {:.2}, 99.9 % {:.2}, at most {:.2}",
        at(0.5),
        at(0.9),
        at(0.99),
        at(0.999),
        at(1.0)
    )
}
