//! Forgetting what is older than anybody wants to keep.

use std::sync::Arc;
use std::time::Duration;

use tracing::{info, warn};

use crate::service::Signals;
use crate::store::{Expired, Store, StoreError};

/// How often old things are looked for; also at the start.
const LOOK_AGAIN: Duration = Duration::from_secs(3600);

/// What is deleted in one transaction: others wait for its end.
const BATCH: u32 = 100;

/// Deletes what ended longer than `age` ago, now and every hour, until the process
/// stops.
pub async fn forget(store: Arc<dyn Store>, signals: Arc<Signals>, age: Duration) {
    loop {
        match forget_once(store.as_ref(), age).await {
            Ok(Expired { measurements: 0, jobs: 0 }) => {}
            Ok(Expired { measurements, jobs }) => info!(measurements, jobs, "old ones deleted"),
            Err(error) => warn!(%error, "old measurements and jobs cannot be deleted"),
        }
        tokio::select! {
            () = tokio::time::sleep(LOOK_AGAIN) => {}
            () = signals.stopped() => return,
        }
    }
}

async fn forget_once(store: &dyn Store, age: Duration) -> Result<Expired, StoreError> {
    let mut all = Expired::default();
    loop {
        let Expired { measurements, jobs } = store.delete_older(age, BATCH).await?;
        all.measurements += measurements;
        all.jobs += jobs;
        if measurements + jobs == 0 {
            return Ok(all);
        }
    }
}
