//! Wake-up calls of other processes, passed on to this one.

use std::sync::Arc;
use std::time::Duration;

use tracing::warn;

use crate::service::Signals;
use crate::store::{Store, Wake};

/// How long after a failure it is tried again. Until then others are heard of by looking.
const PAUSE: Duration = Duration::from_secs(1);

/// Passes on what other processes say of jobs until the process stops, or at once where the store
/// has no such word to pass on.
pub async fn relay(store: Arc<dyn Store>, signals: Arc<Signals>) {
    let heard = |wake: Wake| match wake {
        Wake::Queued => signals.job_queued(),
        Wake::Changed => signals.job_changed(),
        Wake::Unwanted => signals.job_unwanted(),
        Wake::Ended => signals.job_ended(),
    };
    loop {
        tokio::select! {
            listened = store.listen(&heard) => match listened {
                Ok(()) => return,
                Err(error) => warn!(%error, "other processes cannot be heard"),
            },
            () = signals.stopped() => return,
        }
        tokio::select! {
            () = tokio::time::sleep(PAUSE) => {}
            () = signals.stopped() => return,
        }
    }
}
