//! Telling others what happened: from the ends of jobs to messages, and these to their
//! receivers. It has a task of its own, so that no receiver delays a job.

use std::pin::pin;
use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio::task::JoinSet;
use tracing::{error, info, warn};

use crate::service::{Service, Signals};
use crate::store::Store;

/// How often what is due is looked for without a signal.
const LOOK_AGAIN: Duration = Duration::from_secs(1);

/// Messages under way at once.
const MOST: usize = 16;

/// How long a message can be looked at. The last attempt is long past then.
const KEPT: Duration = Duration::from_secs(14 * 24 * 3600);

/// How often old messages are removed.
const SWEEP: Duration = Duration::from_secs(3600);

/// Messages that are removed in one transaction.
const BATCH: u32 = 500;

/// Sends messages until the process stops. What is under way then is sent again by the next.
pub async fn tell(store: Arc<dyn Store>, service: Service, signals: Arc<Signals>) {
    let mut under_way = JoinSet::new();
    let mut swept: Option<Instant> = None;
    let mut stopped = pin!(signals.stopped());
    while !signals.is_stopping() {
        let mut ended = pin!(signals.ended());
        // Before looking: a job that ends in between is not missed.
        ended.as_mut().enable();
        if let Err(error) = service.announce().await {
            warn!(%error, "ended jobs cannot be announced");
        }
        while under_way.len() < MOST {
            match service.due().await {
                Ok(Some(due)) => {
                    let service = service.clone();
                    under_way.spawn(async move { service.deliver(due).await });
                }
                Ok(None) => break,
                Err(error) => {
                    warn!(%error, "messages cannot be read");
                    break;
                }
            }
        }
        if swept.is_none_or(|swept| swept.elapsed() > SWEEP) {
            swept = Some(Instant::now());
            sweep(store.as_ref()).await;
        }
        tokio::select! {
            () = &mut stopped => {}
            () = ended => {}
            Some(told) = under_way.join_next() => match told {
                Ok(Ok(())) => {}
                Ok(Err(error)) => warn!(%error, "what came of a message cannot be stored"),
                Err(error) => error!(%error, "the task that sends a message ended badly"),
            },
            () = tokio::time::sleep(LOOK_AGAIN) => {}
        }
    }
}

async fn sweep(store: &dyn Store) {
    loop {
        match store.delete_deliveries(KEPT, BATCH).await {
            Ok(0) => return,
            Ok(messages) => info!(messages, "old ones deleted"),
            Err(error) => return warn!(%error, "old messages cannot be deleted"),
        }
    }
}
