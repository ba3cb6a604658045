//! What is done now and then only.

use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How often it is done.
const EVERY: Duration = Duration::from_secs(1);

/// Lets something be done once a second.
#[derive(Debug, Default)]
pub(super) struct Pace(Mutex<Option<Instant>>);

impl Pace {
    /// Whether it is to be done this time, for which the caller then sees to it.
    pub(super) fn is_due(&self) -> bool {
        // A panic cannot leave it half-written.
        let mut done = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let due = done.is_none_or(|done| done.elapsed() > EVERY);
        if due {
            *done = Some(Instant::now());
        }
        due
    }

    /// Lets it be done the next time, however soon that is.
    pub(super) fn make_due(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

/// From where on events are read. While any transaction is held open, entries of the index stay behind
/// for every event that was announced since, and all of them would be passed over each time.
#[derive(Debug, Default)]
pub(super) struct Lowest {
    /// The highest that was the oldest at some time.
    seen: AtomicI64,
    /// The same a moment ago. Transactions that end side by side may be committed in another order than
    /// that of their events.
    from: AtomicI64,
    /// Looks for what is below all the same.
    whole: Pace,
}

impl Lowest {
    /// The lowest number that is looked for this time.
    pub(super) fn from(&self) -> i64 {
        if self.whole.is_due() {
            self.from.store(self.seen.load(Ordering::Relaxed), Ordering::Relaxed);
            return 0;
        }
        self.from.load(Ordering::Relaxed)
    }

    /// The oldest event that was found has this number.
    pub(super) fn saw(&self, oldest: i64) {
        self.seen.fetch_max(oldest, Ordering::Relaxed);
    }
}
