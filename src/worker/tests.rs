//! Jobs from the queue to their end, on a real store and a scripted computation.

use std::sync::Arc;
use std::time::Duration;

use sqlx::Connection as _;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use tempfile::TempDir;
use tokio::task::JoinHandle;

use super::attempt::Attempt;
use super::{Settings, Shared, start};
use crate::service::testing::{PANIC, RUN_UNTIL_CANCELLED, SUCCEED, Scripted, UNUSABLE};
use crate::service::{Job, Service, ServiceError, Signals, Submission, Upload};
use crate::store::{FileRow, Reach, Sqlite, Status, Store};

/// Far more than anything here takes: it ends a test that hangs.
pub(super) const PATIENCE: Duration = Duration::from_secs(60);

pub(super) struct Bench {
    directory: TempDir,
    pub(super) store: Arc<dyn Store>,
    pub(super) service: Service,
    pub(super) signals: Arc<Signals>,
    measurement: String,
}

impl Bench {
    pub(super) async fn new() -> Self {
        Self::limited(None).await
    }

    /// One whose database may not grow beyond so many bytes.
    pub(super) async fn limited(bytes: Option<u64>) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let store = Sqlite::open_limited(directory.path(), bytes).await.unwrap();
        let store: Arc<dyn Store> = Arc::new(store);
        let signals = Arc::new(Signals::default());
        let service = Service::new(Arc::clone(&store), Arc::new(Scripted), Arc::clone(&signals));
        let file = FileRow {
            name: "a.csv".into(),
            content_type: "text/csv".into(),
            bytes: b"any".to_vec(),
        };
        let upload = Upload { files: vec![file], ..Upload::default() };
        let measurement = service.add_measurement(upload, None).await.unwrap().resource.row.id;
        Self { directory, store, service, signals, measurement }
    }

    fn work(&self) -> JoinHandle<()> {
        self.work_for(Settings::new(2).limit)
    }

    fn work_for(&self, limit: Duration) -> JoinHandle<()> {
        self.work_with(Settings { limit, ..Settings::new(2) })
    }

    pub(super) fn work_with(&self, settings: Settings) -> JoinHandle<()> {
        let settings = Settings { beat: Duration::from_millis(10), ..settings };
        start(Arc::clone(&self.store), self.service.clone(), Arc::clone(&self.signals), settings)
    }

    /// The next job, in the hands of nobody else.
    pub(super) async fn attempt(&self, lease: Duration) -> Attempt {
        let Self { store, service, signals, .. } = self;
        let shared = Shared {
            id: "one".into(),
            store: Arc::clone(store),
            service: service.clone(),
            signals: Arc::clone(signals),
            settings: Settings { lease, ..Settings::new(1) },
        };
        let lease = store.lease("one", lease).await.unwrap().expect("a job is queued");
        Attempt::new(Arc::new(shared), lease)
    }

    /// Does something to the database that the program does not do.
    pub(super) async fn execute(&self, statement: &'static str) {
        let file = self.directory.path().join("servoscope.sqlite3");
        let options = SqliteConnectOptions::new().filename(file);
        let mut connection = SqliteConnection::connect_with(&options).await.unwrap();
        sqlx::query(statement).execute(&mut connection).await.unwrap();
        connection.close().await.unwrap();
    }

    pub(super) async fn submit(&self, seed: u64) -> String {
        let mut submission = Submission {
            measurement_id: self.measurement.clone(),
            kind: "identify".into(),
            ..Submission::default()
        };
        submission.options.seed = seed;
        self.service.submit(&submission, None).await.unwrap().resource.row.id
    }

    pub(super) async fn ended(&self, id: &str) -> Job {
        let job = self.service.job_when_ended(id, PATIENCE).await.unwrap();
        assert!(job.row.status.is_final(), "{:?} after {PATIENCE:?}", job.row.status);
        job
    }

    /// Waits until the computation of a job has reported something.
    pub(super) async fn running(&self, id: &str) {
        while self.service.convergence(id).await.unwrap().is_empty() {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    }
}

#[tokio::test]
async fn a_job_succeeds_with_result_and_history() {
    let bench = Bench::new().await;
    bench.work();
    let id = bench.submit(SUCCEED).await;
    assert_eq!(bench.ended(&id).await.row.status, Status::Succeeded);
    let result: serde_json::Value =
        serde_json::from_str(&bench.service.result(&id).await.unwrap()).unwrap();
    assert_eq!(result["seed"], SUCCEED);
    let rows = bench.service.convergence(&id).await.unwrap();
    assert_eq!((rows.len(), rows[0].best), (1, 0.125));
}

#[tokio::test]
async fn a_job_queued_before_the_worker_starts_is_run() {
    let bench = Bench::new().await;
    let id = bench.submit(SUCCEED).await;
    bench.work();
    assert_eq!(bench.ended(&id).await.row.status, Status::Succeeded);
}

#[tokio::test]
async fn a_panic_fails_its_job_with_a_reference_and_nothing_else() {
    let bench = Bench::new().await;
    bench.work();
    let (bad, good) = (bench.submit(PANIC).await, bench.submit(SUCCEED).await);
    let job = bench.ended(&bad).await;
    assert_eq!(job.row.status, Status::Failed);
    let failure = job.failure.expect("it says why");
    assert!(failure.reference.is_some() && !failure.reason.contains("scripted"), "{failure:?}");
    assert_eq!(bench.ended(&good).await.row.status, Status::Succeeded);
}

#[tokio::test]
async fn the_log_says_under_the_reference_of_a_panic_what_it_was() {
    let bench = Bench::new().await;
    let log = tempfile::NamedTempFile::new().unwrap();
    let subscriber = tracing_subscriber::fmt().with_writer(Arc::new(log.reopen().unwrap()));
    let _logging = tracing::subscriber::set_default(subscriber.with_ansi(false).finish());
    bench.work();
    let id = bench.submit(PANIC).await;
    let failure = bench.ended(&id).await.failure.expect("it says why");
    let reference = failure.reference.expect("a reference to the log");
    let text = std::fs::read_to_string(log.path()).unwrap();
    let line = text.lines().find(|line| line.contains(&reference)).expect(&text);
    assert!(line.contains("scripted"), "{line}");
}

#[tokio::test]
async fn data_that_cannot_be_fitted_fails_its_job_with_the_reason() {
    let bench = Bench::new().await;
    bench.work();
    let id = bench.submit(UNUSABLE).await;
    let failure = bench.ended(&id).await.failure.expect("it says why");
    assert!(failure.reason.contains("one frequency only"), "{failure:?}");
    let Err(ServiceError::NoResult { how, .. }) = bench.service.result(&id).await else {
        panic!("there is no result");
    };
    assert!(how.contains("one frequency only"), "{how}");
}

#[tokio::test]
async fn a_running_job_is_cancelled_even_from_another_process() {
    let bench = Bench::new().await;
    bench.work();
    let id = bench.submit(RUN_UNTIL_CANCELLED).await;
    bench.running(&id).await;
    let progress = bench.service.job(&id).await.unwrap().progress.expect("it has begun");
    assert_eq!((progress.stage.as_str(), progress.fraction), ("searching", 0.5));
    // The store is all that two processes share.
    bench.store.cancel(&Reach::everything(), &id).await.unwrap();
    assert_eq!(bench.ended(&id).await.row.status, Status::Cancelled);
}

#[tokio::test]
async fn more_jobs_than_places_wait_their_turn() {
    let bench = Bench::new().await;
    bench.work();
    let long = [bench.submit(RUN_UNTIL_CANCELLED).await, bench.submit(RUN_UNTIL_CANCELLED).await];
    for id in &long {
        bench.running(id).await;
    }
    let waiting = bench.submit(SUCCEED).await;
    assert_eq!(bench.service.job(&waiting).await.unwrap().row.status, Status::Queued);
    bench.service.cancel(&long[0]).await.unwrap();
    assert_eq!(bench.ended(&waiting).await.row.status, Status::Succeeded);
    assert_eq!(bench.service.job(&long[1]).await.unwrap().row.status, Status::Running);
    bench.service.cancel(&long[1]).await.unwrap();
}

#[tokio::test]
async fn a_stopping_worker_hands_its_jobs_back_uncharged() {
    let bench = Bench::new().await;
    let worker = bench.work();
    let id = bench.submit(RUN_UNTIL_CANCELLED).await;
    bench.running(&id).await;
    bench.signals.stop();
    tokio::time::timeout(PATIENCE, worker).await.expect("it stops").unwrap();
    let job = bench.service.job(&id).await.unwrap();
    assert_eq!(job.row.status, Status::Queued);
    assert_eq!(job.progress, None);
}

#[tokio::test]
async fn a_stopping_worker_does_not_take_up_again_what_it_hands_back() {
    // Which of two signals it sees first is chance.
    for _ in 0..8 {
        let bench = Bench::new().await;
        let worker = bench.work();
        let id = bench.submit(RUN_UNTIL_CANCELLED).await;
        bench.running(&id).await;
        bench.signals.job_queued();
        bench.signals.stop();
        tokio::time::timeout(PATIENCE, worker).await.expect("it stops").unwrap();
        assert_eq!(bench.service.job(&id).await.unwrap().row.attempt, 1);
    }
}

#[tokio::test]
async fn a_result_asked_for_too_early_says_what_to_do() {
    let bench = Bench::new().await;
    let id = bench.submit(SUCCEED).await;
    let text = bench.service.result(&id).await.unwrap_err().to_string();
    assert!(text.contains("is queued") && text.contains("?wait="), "{text}");
}

#[tokio::test]
async fn waiting_ends_when_the_process_stops() {
    let bench = Bench::new().await;
    let id = bench.submit(SUCCEED).await;
    let waiting = bench.service.job_when_ended(&id, PATIENCE);
    let (job, ()) = tokio::join!(waiting, async { bench.signals.stop() });
    assert_eq!(job.unwrap().row.status, Status::Queued);
}

#[tokio::test]
async fn a_job_that_takes_too_long_fails_and_says_so() {
    let bench = Bench::new().await;
    bench.work_for(Duration::from_millis(60));
    let id = bench.submit(RUN_UNTIL_CANCELLED).await;
    let job = bench.ended(&id).await;
    assert_eq!(job.row.status, Status::Failed);
    let reason = job.failure.expect("it says why").reason;
    assert!(reason.contains("longer than the 0.001 minutes"), "{reason}");
}

#[tokio::test]
async fn a_deleted_job_frees_its_place() {
    let bench = Bench::new().await;
    bench.work();
    let long = [bench.submit(RUN_UNTIL_CANCELLED).await, bench.submit(RUN_UNTIL_CANCELLED).await];
    for id in &long {
        bench.running(id).await;
        bench.service.delete_job(id).await.unwrap();
    }
    let next = bench.submit(SUCCEED).await;
    assert_eq!(bench.ended(&next).await.row.status, Status::Succeeded);
}
