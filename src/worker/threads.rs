//! Threads that compute, below everything else in priority.
//!
//! Each running job has a thread of its own, and all of them share rayon's global
//! pool of one thread a core for what they compute in parallel. The job itself
//! does not run *in* that pool: a pool thread that waits for a part of its job
//! takes up any other work it finds, and would not return to a short job, nor to
//! one that is cancelled, before a long one that it took up is done.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

use tokio::sync::oneshot;
use tracing::warn;

/// Added to the nice value of a thread that computes: requests, heartbeats and
/// other people's work on the machine come first.
const NICE: i32 = 10;

/// What a computation came to: its value, or what it panicked with.
pub(super) type Ended<T> = Result<T, Box<dyn Any + Send>>;

/// Sets up the shared pool, once in a process.
pub(super) fn prepare() {
    // An error says that the pool exists already, from an earlier worker or from
    // somebody else's choice; both are as good.
    let _ = rayon::ThreadPoolBuilder::new()
        .thread_name(|index| format!("compute-{index}"))
        .start_handler(|_| lower_priority())
        .build_global();
}

/// Computes on a new thread. A panic stays within it and is returned.
pub(super) fn spawn<T: Send + 'static>(
    compute: impl FnOnce() -> T + Send + 'static,
) -> std::io::Result<oneshot::Receiver<Ended<T>>> {
    let (sender, receiver) = oneshot::channel();
    std::thread::Builder::new().name("job".into()).spawn(move || {
        lower_priority();
        // Nobody sees what the computation left behind half-done: it owns it all.
        let ended = catch_unwind(AssertUnwindSafe(compute));
        // Nobody listens where the job was handed back or its lease was lost.
        let _ = sender.send(ended);
    })?;
    Ok(receiver)
}

/// What a panic says, as far as it is text.
pub(super) fn panic_text(payload: &(dyn Any + Send)) -> &str {
    payload
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| payload.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("a panic without text")
}

fn lower_priority() {
    // On Linux the nice value is a thread's own; elsewhere it is the process's,
    // and lowering it would slow the service down with the computation.
    if cfg!(target_os = "linux")
        && let Err(error) = rustix::process::nice(NICE)
    {
        warn!(%error, "a compute thread keeps its priority");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_panic_is_returned_with_its_text() {
        let ended = spawn(|| -> () { panic!("no {}", "way") }).unwrap().await.unwrap();
        let payload: Box<dyn Any + Send> = ended.unwrap_err();
        assert_eq!(panic_text(payload.as_ref()), "no way");
    }

    #[cfg(target_os = "linux")]
    #[tokio::test]
    async fn only_the_thread_that_computes_is_lowered() {
        let before = rustix::process::nice(0).unwrap();
        let there = spawn(|| rustix::process::nice(0).unwrap()).unwrap().await.unwrap().unwrap();
        assert_eq!(there, (before + NICE).min(19));
        assert_eq!(rustix::process::nice(0).unwrap(), before);
    }
}
