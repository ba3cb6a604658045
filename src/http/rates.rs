//! How often somebody may ask.
//!
//! Each key, and each address from which somebody signs in, has a bucket of tokens: a request takes
//! one, and they come back at a steady pace. A full bucket holds those of a minute.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::shares::Who;

/// A bucket that was full for so long is forgotten.
const FORGOTTEN_AFTER: Duration = Duration::from_secs(600);

/// From so many buckets on those are sought that can be forgotten.
const MANY: usize = 1024;

/// Buckets of all who asked of late.
#[derive(Debug, Default)]
pub(super) struct Rates {
    buckets: Mutex<HashMap<Who, Bucket>>,
}

/// Tokens as they were at a time.
#[derive(Debug, Clone, Copy)]
struct Bucket {
    tokens: f64,
    at: Instant,
}

impl Rates {
    /// Takes a token of somebody who may ask so often a minute.
    ///
    /// # Errors
    /// After how many seconds there is one.
    pub(super) fn take(&self, who: Who, per_minute: usize, now: Instant) -> Result<(), u64> {
        let per_minute = per_minute as f64;
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if buckets.len() >= MANY {
            buckets.retain(|_, bucket| now.duration_since(bucket.at) < FORGOTTEN_AFTER);
        }
        let full = Bucket { tokens: per_minute, at: now };
        let bucket = buckets.entry(who).or_insert(full);
        let per_second = per_minute / 60.0;
        let since_s = now.duration_since(bucket.at).as_secs_f64();
        let tokens = (bucket.tokens + since_s * per_second).min(per_minute);
        if tokens < 1.0 {
            *bucket = Bucket { tokens, at: now };
            return Err(((1.0 - tokens) / per_second).ceil().max(1.0) as u64);
        }
        *bucket = Bucket { tokens: tokens - 1.0, at: now };
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(id: &str) -> Who {
        Who::Key(id.to_owned())
    }

    #[test]
    fn a_key_may_ask_as_often_as_a_minute_allows_and_then_at_that_pace() {
        let rates = Rates::default();
        let start = Instant::now();
        for _ in 0..30 {
            assert_eq!(rates.take(key("rig"), 30, start), Ok(()));
        }
        assert_eq!(rates.take(key("rig"), 30, start), Err(2), "one token in two seconds");
        assert_eq!(rates.take(key("other"), 1, start), Ok(()), "each key has its own");
        let later = start + Duration::from_secs(2);
        assert_eq!(
            (rates.take(key("rig"), 30, later), rates.take(key("rig"), 30, later)),
            (Ok(()), Err(2))
        );
        let much_later = start + Duration::from_secs(3600);
        let allowed = (0..100).filter(|_| rates.take(key("rig"), 30, much_later).is_ok()).count();
        assert_eq!(allowed, 30, "an hour without a request gives no more than a minute");
    }

    #[test]
    fn a_key_whose_pace_is_changed_goes_on_at_the_new_one() {
        let rates = Rates::default();
        let start = Instant::now();
        let allowed = |per_minute| {
            (0..100).filter(|_| rates.take(key("rig"), per_minute, start).is_ok()).count()
        };
        assert_eq!(allowed(30), 30);
        assert_eq!(rates.take(key("rig"), 60, start), Err(1));
        let later = start + Duration::from_secs(60);
        assert_eq!((0..100).filter(|_| rates.take(key("rig"), 5, later).is_ok()).count(), 5);
    }
}
