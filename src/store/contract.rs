//! What every engine of [`Store`] must do. Each engine runs the whole list.

mod backup;
mod batches;
#[path = "../../tests/postgres_cluster.rs"]
pub(in crate::store) mod cluster;
mod earlier;
mod kept;
mod keys;
mod lists;
mod live;
mod mappings;
mod measurements;
mod outbox;
mod owners;
mod processes;
mod queue;
mod recovery;
mod restarts;
mod retention;
mod standby;
mod usage;

use std::time::Duration;

use super::{
    ALONE_AFTER, Beat, CancelledRows, Cancelling, ConvergencePoint, Description, EndedRow,
    FailureRow, FileRow, IdempotencyKey, Inserted, JobFilter, KeyRow, Lease, MAX_ATTEMPTS,
    MappingRow, MeasurementFilter, MeasurementRow, MemberRow, NewBatchRow, NewJobRow, NewMemberRow,
    Outcome, Page, Postgres, Priority, QueueState, Reach, Recovered, RereadRow, Rereading,
    ResultFilter, Sqlite, Standing, Status, Store, StoreError, Usage, Wake, WebhookRow,
};
use batches::*;
use keys::*;
use lists::*;
use mappings::*;
use measurements::*;
use outbox::*;
use owners::*;
use queue::*;
use recovery::*;
use retention::*;
use usage::*;

const LONG: Duration = Duration::from_secs(600);
/// A lease that has expired as soon as it is given.
const EXPIRED: Duration = Duration::ZERO;
/// Jobs run again at once.
const NO_WAIT: Duration = Duration::ZERO;

fn all() -> Reach {
    Reach::everything()
}

fn id() -> String {
    uuid::Uuid::now_v7().to_string()
}

fn measurement(id: &str) -> MeasurementRow {
    MeasurementRow {
        id: id.to_owned(),
        created_at_ms: 0,
        name: Some("stepped sine".into()),
        machine: Some("press 4".into()),
        axis: Some("x".into()),
        operator: None,
        measured_at: Some("2024-05-06T07:08:09Z".into()),
        labels: r#"{"site":"north"}"#.into(),
        sha256: "00ff".into(),
        experiments: 48,
        highest_harmonic: 9,
        magnitude_min: 1.0,
        magnitude_max: 3.0,
        omega_min_rad_s: 0.5,
        omega_max_rad_s: 200.0,
        notes: "[]".into(),
        quantities: Some("{}".into()),
        files: r#"["a.csv"]"#.into(),
        simulation_s: Some(1e-6),
        diagnosis_s: Some(2.5),
    }
}

fn file(bytes: &[u8]) -> FileRow {
    FileRow { name: "a.csv".into(), content_type: "text/csv".into(), bytes: bytes.to_vec() }
}

fn key(key: &str, body: &str) -> IdempotencyKey {
    IdempotencyKey { key: key.into(), body_sha256: body.into() }
}

fn point(seq: i64) -> ConvergencePoint {
    ConvergencePoint {
        seq,
        stage: "colony".into(),
        cycle: seq,
        evaluations: 20 * seq,
        best: 1.0 / (seq + 1) as f64,
        mean: (seq > 0).then_some(2.5),
        elapsed_s: 0.25 * seq as f64,
    }
}

async fn stored_measurement(store: &dyn Store) -> String {
    let id = id();
    store.insert_measurement(&all(), &measurement(&id), &[file(b"x")], None).await.unwrap();
    id
}

async fn queued_job(store: &dyn Store) -> String {
    let measurement_id = stored_measurement(store).await;
    queued_job_of(store, &measurement_id, "").await
}

async fn queued_job_of(store: &dyn Store, measurement_id: &str, submitter: &str) -> String {
    let row = NewJobRow { submitter: submitter.into(), ..new_job(measurement_id) };
    assert_eq!(store.insert_job(&all(), &row, None).await.unwrap(), Inserted::Created);
    row.id
}

fn new_job(measurement_id: &str) -> NewJobRow {
    NewJobRow {
        id: id(),
        measurement_id: measurement_id.to_owned(),
        submitter: String::new(),
        kind: "identify".into(),
        priority: Priority::Normal,
        request: "{}".into(),
    }
}

/// A lease for a worker of its own, as far as there is a job.
async fn lease(store: &dyn Store, duration: Duration) -> Option<Lease> {
    store.lease(&id(), duration).await.unwrap()
}

async fn leased_job(store: &dyn Store, duration: Duration) -> Lease {
    let job = queued_job(store).await;
    let lease = lease(store, duration).await.expect("a job is queued");
    assert_eq!(lease.job_id, job);
    lease
}

async fn status(store: &dyn Store, id: &str) -> Status {
    store.job(&all(), id).await.unwrap().expect("the job exists").status
}

/// Runs every test of the contract on a fresh store of each engine.
macro_rules! contract {
    ($($test:ident),* $(,)?) => {
        mod sqlite {
            $(#[tokio::test]
            async fn $test() {
                let directory = tempfile::tempdir().unwrap();
                super::$test(&super::Sqlite::open(directory.path()).await.unwrap()).await;
            })*
        }

        mod postgres {
            $(#[tokio::test]
            async fn $test() {
                let Some(cluster) = super::cluster::Cluster::shared() else { return };
                super::$test(&super::Postgres::open(&cluster.database()).await.unwrap()).await;
            })*
        }
    };
}

contract!(
    a_measurement_comes_back_as_it_was_stored,
    a_text_with_the_character_nul_is_kept_or_refused_as_such,
    lists_are_paged_newest_first_and_filtered,
    a_mapping_is_found_by_its_name_and_by_the_latest_of_its_layout,
    an_owner_has_so_many_mappings_and_may_still_replace_them,
    an_idempotency_key_answers_the_same_request_only,
    requests_with_one_key_at_once_make_one_measurement,
    a_deleted_job_takes_its_key_with_it,
    a_job_of_an_unknown_measurement_is_refused,
    the_oldest_queued_job_is_leased_once,
    submitters_take_turns_however_much_each_queues,
    jobs_queued_at_once_have_turns_of_their_own,
    a_higher_priority_goes_first_within_one_submitter_and_takes_no_turn_of_another,
    expired_leases_are_recovered_once,
    a_job_runs_and_succeeds_with_its_history,
    a_failed_job_says_why_and_has_no_result,
    jobs_that_have_ended_or_are_gone_are_told_from_the_others,
    nothing_is_written_after_the_end,
    an_expired_lease_writes_nothing_even_before_it_is_recovered,
    a_stale_worker_cannot_spoil_its_successor,
    a_job_that_kills_its_workers_fails_after_the_last_attempt,
    ten_kills_in_company_end_no_job,
    after_two_kills_all_places_are_filled_at_once,
    a_poisonous_job_ends_and_none_of_its_siblings,
    a_job_that_is_lost_by_a_living_worker_is_charged,
    a_job_waits_longer_with_each_death_but_the_first,
    a_job_that_waited_is_leased_after_those_that_passed_it,
    a_job_handed_back_is_queued_and_not_charged,
    a_queued_job_is_cancelled_at_once,
    the_worker_of_a_running_job_learns_that_it_is_cancelled,
    a_cancelled_job_does_not_come_back_to_the_queue,
    history_goes_on_where_the_attempt_before_left_it,
    a_deleted_measurement_takes_its_jobs_and_keys_with_it,
    what_is_old_is_deleted_and_what_is_wanted_is_not,
    what_is_old_takes_all_its_keys_with_it,
    a_measurement_says_something_else_of_itself,
    files_are_read_again_until_there_is_a_job,
    results_are_listed_by_when_they_were_measured,
    the_queue_says_what_waits_and_how_long,
    every_way_to_end_a_job_leaves_one_event,
    an_event_is_announced_once,
    one_message_at_a_time_is_under_way_to_a_receiver,
    a_failed_message_waits_and_keeps_its_reason,
    a_message_under_way_is_due_again_when_its_sender_is_killed,
    a_receiver_that_wants_no_more_is_told_no_more,
    webhooks_are_listed_counted_and_deleted_with_their_messages,
    old_messages_are_deleted,
    a_key_is_valid_until_it_expires_or_is_revoked,
    a_key_has_quotas_of_its_own_from_its_start_or_later,
    a_session_is_of_its_key_until_either_ends,
    of_more_sessions_than_a_key_may_have_the_oldest_end,
    rows_of_another_owner_are_not_there,
    a_later_job_of_another_owner_does_not_hide_a_result,
    each_owner_has_mappings_of_its_own,
    the_usage_of_a_key_is_what_it_has_stored_queued_and_computed,
    what_a_key_computed_counts_in_every_attempt_and_after_its_jobs_are_gone,
    the_jobs_of_a_batch_are_ordinary_jobs_in_its_order,
    a_batch_is_stored_whole_or_not_at_all,
    a_batch_delays_the_job_of_another_by_one_job,
    a_batch_says_where_its_jobs_stand_and_what_came_of_them,
    a_batch_is_cancelled_step_by_step,
    a_batch_is_deleted_step_by_step_with_its_jobs_and_its_key,
    an_old_batch_is_forgotten_with_the_last_of_its_jobs,
    a_batch_of_another_owner_is_not_there,
);

#[tokio::test]
async fn what_has_no_room_is_refused_whole_and_accepted_once_there_is() {
    let directory = tempfile::tempdir().unwrap();
    let store = Sqlite::open_limited(directory.path(), Some(1 << 20)).await.unwrap();
    let small = stored_measurement(&store).await;
    let large = file(&vec![b'x'; 700 << 10]);
    let first = id();
    store
        .insert_measurement(&all(), &measurement(&first), std::slice::from_ref(&large), None)
        .await
        .unwrap();
    let second = id();
    let refused = store
        .insert_measurement(&all(), &measurement(&second), std::slice::from_ref(&large), None)
        .await;
    assert!(matches!(refused, Err(StoreError::Full(_))), "{refused:?}");
    assert_eq!(
        store.measurement(&all(), &second).await.unwrap(),
        None,
        "nothing is stored by half"
    );
    assert!(store.measurement(&all(), &small).await.unwrap().is_some());
    assert!(store.delete_measurement(&all(), &first).await.unwrap());
    let accepted = store.insert_measurement(&all(), &measurement(&second), &[large], None).await;
    assert_eq!(accepted.unwrap(), Inserted::Created);
    store.ping().await.unwrap();
}
