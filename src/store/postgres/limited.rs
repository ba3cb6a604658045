//! The limit to every call: one that the database does not answer is given up.
//!
//! A database that accepts a connection and then says nothing, or a link that is cut without a word, would
//! keep whoever asked waiting until the system gives the connection up: for a quarter of an hour, or for
//! ever where nothing is left to send. So requests, the sending of messages and the deletion of what is
//! old all have one limit, here. The connection is then given up as well, as told in `connections`.

use std::time::Duration;

use async_trait::async_trait;

use crate::store::{
    AxisRow, BackupError, BatchRow, Batches, Beat, CancelledRows, Cancelling, ConvergencePoint,
    DeliveryRow, Description, DueRow, EventRow, Expired, FailureRow, FileRow, IdempotencyKey,
    Inserted, JobFilter, JobRow, KeyRow, Keyring, Lease, MappingRow, Mappings, MeasurementFilter,
    MeasurementRow, MemberRow, Millis, NewBatchRow, NewDeliveryRow, NewJobRow, Outbox, Outcome,
    Page, Portable, QueueState, Reach, Reader, Recovered, RereadRow, Rereading, ResultFilter,
    Settled, Standing, Store, StoreError, StoredResult, TallyRow, Usage, Wake, WebhookRow, Writer,
};

use super::Postgres;

/// How long a call may take: longer than a gibibyte takes to be stored over a slow network, and than one
/// call waits for other transactions.
pub(super) const LIMIT: Duration = Duration::from_secs(120);

impl Postgres {
    /// What the database answers, if it does so in time.
    async fn answer<T>(
        &self,
        asked: impl Future<Output = Result<T, StoreError>>,
    ) -> Result<T, StoreError> {
        tokio::time::timeout(self.limit, asked).await.unwrap_or(Err(StoreError::Silent))
    }
}

/// Writes the methods of interfaces, each of which asks the engine and has the limit, and after `and`
/// those that have none.
macro_rules! limited {
    ($(impl $interface:ident {
        $(async fn $method:ident($($name:ident: $kind:ty),*) -> $answer:ty;)*
    } $(and { $($unlimited:tt)* })?)*) => { $(
        #[async_trait]
        impl $interface for Postgres {
            $(async fn $method(&self, $($name: $kind),*) -> Result<$answer, StoreError> {
                self.answer(self.engine.$method($($name),*)).await
            })*
            $($($unlimited)*)?
        }
    )* };
}

limited! {
    impl Outbox {
        async fn insert_webhook(reach: &Reach, row: &WebhookRow, most: u32) -> bool;
        async fn webhooks(reach: &Reach, limit: Option<u32>) -> Vec<WebhookRow>;
        async fn webhook(reach: &Reach, id: &str) -> Option<WebhookRow>;
        async fn delete_webhook(reach: &Reach, id: &str) -> bool;
        async fn events(limit: u32) -> Vec<EventRow>;
        async fn announce(event: i64, rows: &[NewDeliveryRow]) -> bool;
        async fn due(lease: Duration, broker: bool) -> Option<DueRow>;
        async fn settle(
            due: &DueRow,
            settled: &Settled,
            answered: Option<u16>,
            error: Option<&str>
        ) -> bool;
        async fn deliveries(reach: &Reach, webhook: &str, limit: u32) -> Vec<DeliveryRow>;
        async fn waiting() -> i64;
        async fn delete_deliveries(age: Duration, limit: u32) -> u64;
    }
    impl Keyring {
        async fn insert_key(row: &KeyRow) -> bool;
        async fn replace_key(id: &str, sha256: &str, expires_at_ms: Option<Millis>) -> bool;
        async fn key(id: &str) -> Option<KeyRow>;
        async fn keys(limit: u32) -> Vec<KeyRow>;
        async fn has_keys() -> bool;
        async fn has_valid_key() -> bool;
        async fn revoke_key(id: &str) -> bool;
        async fn limit_key(id: &str, quotas: &str) -> bool;
        async fn key_used(id: &str) -> ();
        async fn usage(id: &str, last: Duration) -> Usage;
        async fn insert_session(sha256: &str, key_id: &str, expires_at_ms: Millis) -> ();
        async fn end_oldest_sessions(key_id: &str, most: u32) -> ();
        async fn session(sha256: &str) -> Option<KeyRow>;
        async fn delete_session(sha256: &str) -> ();
    }
    impl Batches {
        async fn measurements_of(reach: &Reach, ids: &[String]) -> Vec<MeasurementRow>;
        async fn insert_batch(
            reach: &Reach,
            row: &NewBatchRow,
            key: Option<&IdempotencyKey>
        ) -> Inserted;
        async fn batch(reach: &Reach, id: &str) -> Option<BatchRow>;
        async fn batches(reach: &Reach, page: &Page) -> Vec<BatchRow>;
        async fn batch_tallies(reach: &Reach, ids: &[String]) -> Vec<TallyRow>;
        async fn batch_failures(reach: &Reach, id: &str, limit: u32) -> Vec<FailureRow>;
        async fn batch_members(
            reach: &Reach,
            id: &str,
            standing: Option<Standing>,
            after: Option<&str>,
            limit: u32
        ) -> Vec<MemberRow>;
        async fn cancel_batch(reach: &Reach, id: &str, limit: u32) -> Option<CancelledRows>;
        async fn delete_batch(reach: &Reach, id: &str, limit: u32) -> Option<u64>;
    }
    impl Mappings {
        async fn put_mapping(reach: &Reach, row: &MappingRow, most: u32) -> Option<bool>;
        async fn mapping(reach: &Reach, name: &str) -> Option<MappingRow>;
        async fn mapping_of_layout(reach: &Reach, layout: &str) -> Option<MappingRow>;
        async fn mappings(reach: &Reach, limit: u32) -> Vec<MappingRow>;
        async fn delete_mapping(reach: &Reach, name: &str) -> bool;
    }
    impl Store {
        async fn ping() -> ();
        async fn insert_measurement(
            reach: &Reach,
            row: &MeasurementRow,
            files: &[FileRow],
            key: Option<&IdempotencyKey>
        ) -> Inserted;
        async fn measurement(reach: &Reach, id: &str) -> Option<MeasurementRow>;
        async fn measurement_files(reach: &Reach, id: &str) -> Vec<FileRow>;
        async fn measurements(
            reach: &Reach,
            filter: &MeasurementFilter,
            page: &Page
        ) -> Vec<MeasurementRow>;
        async fn describe_measurement(reach: &Reach, id: &str, description: &Description) -> bool;
        async fn reread_measurement(reach: &Reach, id: &str, reread: &RereadRow) -> Rereading;
        async fn delete_measurement(reach: &Reach, id: &str) -> bool;
        async fn insert_job(
            reach: &Reach,
            row: &NewJobRow,
            key: Option<&IdempotencyKey>
        ) -> Inserted;
        async fn job(reach: &Reach, id: &str) -> Option<JobRow>;
        async fn unended(ids: &[String]) -> Vec<String>;
        async fn jobs(reach: &Reach, filter: &JobFilter, page: &Page) -> Vec<JobRow>;
        async fn delete_job(reach: &Reach, id: &str) -> bool;
        async fn delete_older(age: Duration, limit: u32) -> Expired;
        async fn result(reach: &Reach, id: &str) -> Option<String>;
        async fn results(reach: &Reach, filter: &ResultFilter, limit: u32) -> Vec<StoredResult>;
        async fn axes(reach: &Reach, machine: Option<&str>, limit: u32) -> Vec<AxisRow>;
        async fn convergence(reach: &Reach, id: &str) -> Vec<ConvergencePoint>;
        async fn history(reach: &Reach, id: &str, from: i64, limit: u32) -> Vec<ConvergencePoint>;
        async fn queue() -> QueueState;
        async fn cancel(reach: &Reach, id: &str) -> Cancelling;
        async fn lease(worker: &str, duration: Duration) -> Option<Lease>;
        async fn heartbeat(
            lease: &Lease,
            duration: Duration,
            progress: Option<&str>,
            rows: &[ConvergencePoint]
        ) -> Beat;
        async fn finish(lease: &Lease, outcome: &Outcome) -> bool;
        async fn hand_back(lease: &Lease) -> bool;
        async fn recover_expired(wait: Duration) -> Recovered;
    } and {
        async fn listen(&self, heard: &(dyn Fn(Wake) + Send + Sync)) -> Result<(), StoreError> {
            // It ends by itself where nothing is heard any more.
            self.engine.listen(heard).await
        }
    }
}

/// However long they take: whoever asked for a copy of everything is there to stop it.
#[async_trait]
impl Portable for Postgres {
    async fn back_up(&self, into: &mut Writer<'_>) -> Result<(), BackupError> {
        self.engine.back_up(into).await
    }

    async fn restore(&self, from: &mut Reader<'_>) -> Result<(), BackupError> {
        self.engine.restore(from).await
    }
}

#[cfg(test)]
mod tests {
    use sqlx::{Connection as _, PgConnection};

    use super::*;
    use crate::store::contract::cluster::Cluster;

    #[tokio::test]
    async fn a_call_that_is_not_answered_is_given_up_and_the_next_one_is_answered() {
        let Some(cluster) = Cluster::shared() else { return };
        let address = cluster.database();
        let store = Postgres::open(&address).await.unwrap();
        // Less than it waits for a lock.
        let store = Postgres { limit: Duration::from_secs(1), ..store };
        let mut other = PgConnection::connect(&address).await.unwrap();
        let mut held = other.begin().await.unwrap();
        let lock = "LOCK TABLE measurements, jobs, deliveries, keys";
        sqlx::query(lock).execute(&mut *held).await.unwrap();
        let reach = Reach::everything();
        // More of them than there are connections: each one's is free again.
        for _ in 0..3 {
            let asked = tokio::join!(
                store.job(&reach, "none"),
                store.measurement(&reach, "none"),
                store.delete_older(Duration::ZERO, 1),
                store.due(Duration::from_secs(1), true),
                store.key("none"),
            );
            assert!(matches!(asked.0, Err(StoreError::Silent)), "{:?}", asked.0);
            assert!(matches!(asked.1, Err(StoreError::Silent)), "{:?}", asked.1);
            assert!(matches!(asked.2, Err(StoreError::Silent)), "{:?}", asked.2);
            assert!(matches!(asked.3, Err(StoreError::Silent)), "{:?}", asked.3);
            assert!(matches!(asked.4, Err(StoreError::Silent)), "{:?}", asked.4);
        }
        held.rollback().await.unwrap();
        let store = Postgres { limit: LIMIT, ..store };
        assert_eq!(store.job(&reach, "none").await.unwrap(), None);
    }
}
