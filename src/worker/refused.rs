//! An outcome that the database refuses for good: the job ends as failed, so that its place is free.

use tracing::error;

use crate::service::Failure;
use crate::store::{Outcome, StoreError};

/// How a job ends whose outcome is refused for good. The log says why under the reference.
pub(super) fn instead(refusal: &StoreError) -> Outcome {
    let reference = uuid::Uuid::now_v7().to_string();
    error!(reference, error = %refusal, "the database refuses the outcome; the job ends as failed");
    let reason = "the database refused to store how the job ended, for good; the same request will \
                  most likely end so again. Please report the reference to whoever operates the \
                  server: the log says more";
    let failure = Failure { reason: reason.into(), reference: Some(reference) };
    Outcome::Failed(serde_json::json!(failure).to_string())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::time::Duration;

    use servoscope_core::answers::ConvergenceRow;
    use servoscope_core::observer::Observer as _;

    use crate::service::testing::SUCCEED;
    use crate::store::{Beat, Outcome, Status};
    use crate::worker::Settings;
    use crate::worker::tests::{Bench, PATIENCE};

    const LONG: Duration = Duration::from_secs(600);

    /// A constraint forbids every result.
    const NO_RESULT: &str = "CREATE TRIGGER no_result BEFORE UPDATE OF status ON jobs
        WHEN NEW.status = 'succeeded'
        BEGIN UPDATE jobs SET kind = NULL WHERE id = NEW.id; END";

    /// A constraint forbids every end.
    const NO_END: &str = "CREATE TRIGGER no_end BEFORE UPDATE OF status ON jobs
        WHEN NEW.status IN ('succeeded', 'failed', 'cancelled')
        BEGIN UPDATE jobs SET kind = NULL WHERE id = NEW.id; END";

    #[tokio::test]
    async fn a_job_whose_result_is_refused_for_good_fails_and_says_so_and_frees_its_place() {
        let bench = Bench::new().await;
        bench.execute(NO_RESULT).await;
        let log = tempfile::NamedTempFile::new().unwrap();
        let subscriber = tracing_subscriber::fmt().with_writer(Arc::new(log.reopen().unwrap()));
        let _logging = tracing::subscriber::set_default(subscriber.with_ansi(false).finish());
        bench.work_with(Settings::new(1));
        let id = bench.submit(SUCCEED).await;
        let job = bench.ended(&id).await;
        assert_eq!((job.row.status, job.row.attempt), (Status::Failed, 1));
        let failure = job.failure.expect("it says why");
        assert!(failure.reason.contains("database refused"), "{failure:?}");
        let reference = failure.reference.expect("a reference to the log");
        let text = std::fs::read_to_string(log.path()).unwrap();
        let line = text.lines().find(|line| line.contains(&reference)).expect(&text);
        assert!(line.contains("NOT NULL constraint failed"), "{line}");

        bench.execute("DROP TRIGGER no_result").await;
        let next = bench.submit(SUCCEED).await;
        assert_eq!(bench.ended(&next).await.row.status, Status::Succeeded);
    }

    #[tokio::test]
    async fn a_job_whose_every_end_is_refused_for_good_is_left_until_its_lease_expires() {
        let bench = Bench::new().await;
        let id = bench.submit(SUCCEED).await;
        let attempt = bench.attempt(LONG).await;
        bench.execute(NO_END).await;
        let finished = attempt.finish(Outcome::Succeeded("{}".into()));
        tokio::time::timeout(PATIENCE, finished).await.expect("it is given up");
        assert_eq!(bench.service.job(&id).await.unwrap().row.status, Status::Running);
    }

    #[tokio::test]
    async fn a_job_that_fails_for_a_refused_result_is_still_only_ended_by_who_has_its_lease() {
        let bench = Bench::new().await;
        let id = bench.submit(SUCCEED).await;
        let mut stale = bench.attempt(LONG).await;
        bench.execute(NO_RESULT).await;
        let refusal = stale.store(&Outcome::Succeeded("{}".into())).await.unwrap_err();
        assert!(refusal.is_permanent(), "{refusal:?}");
        assert!(bench.store.hand_back(&stale.lease).await.unwrap());
        let _successor = bench.attempt(LONG).await;
        let finished = stale.finish(super::instead(&refusal));
        tokio::time::timeout(PATIENCE, finished).await.expect("it is given up");
        let job = bench.service.job(&id).await.unwrap().row;
        assert_eq!((job.status, job.attempt), (Status::Running, 2));
    }

    #[tokio::test]
    async fn what_a_computation_reports_and_the_database_refuses_for_good_is_left_out() {
        let bench = Bench::new().await;
        let id = bench.submit(SUCCEED).await;
        let mut attempt = bench.attempt(LONG).await;
        // SQLite takes what is no number for NULL, which the column does not hold.
        let (stage, best, elapsed_s) = ("colony".to_owned(), 0.5, f64::NAN);
        let row = ConvergenceRow { stage, cycle: 1, evaluations: 2, best, mean: None, elapsed_s };
        attempt.watch.row(row);
        let kept = attempt.beat().await.unwrap();
        assert_eq!(kept, Beat::Renewed { cancel_requested: false });
        assert_eq!(attempt.unsent.len(), 0, "it is not stored later");
        assert_eq!(bench.service.convergence(&id).await.unwrap().len(), 0);
    }
}
