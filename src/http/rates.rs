//! How often a key may ask.
//!
//! Each key has a bucket of tokens: a request takes one, and they come back at a steady pace. A
//! full bucket holds those of a minute.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// A bucket that was full for so long is forgotten.
const FORGOTTEN_AFTER: Duration = Duration::from_secs(600);

/// From so many buckets on those are sought that can be forgotten.
const MANY: usize = 1024;

/// Buckets of all keys.
#[derive(Debug)]
pub(super) struct Rates {
    per_minute: f64,
    buckets: Mutex<HashMap<String, Bucket>>,
}

/// Tokens as they were at a time.
#[derive(Debug, Clone, Copy)]
struct Bucket {
    tokens: f64,
    at: Instant,
}

impl Rates {
    /// So many requests a minute for each key; `None`: as many as it likes.
    pub(super) fn new(per_minute: Option<usize>) -> Self {
        let per_minute = per_minute.map_or(f64::INFINITY, |count| count as f64);
        Self { per_minute, buckets: Mutex::default() }
    }

    /// Takes a token of a key.
    ///
    /// # Errors
    /// After how many seconds there is one.
    pub(super) fn take(&self, key: &str, now: Instant) -> Result<(), u64> {
        if self.per_minute.is_infinite() {
            return Ok(());
        }
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if buckets.len() >= MANY {
            buckets.retain(|_, bucket| now.duration_since(bucket.at) < FORGOTTEN_AFTER);
        }
        let full = Bucket { tokens: self.per_minute, at: now };
        let bucket = buckets.entry(key.to_owned()).or_insert(full);
        let per_second = self.per_minute / 60.0;
        let since_s = now.duration_since(bucket.at).as_secs_f64();
        let tokens = (bucket.tokens + since_s * per_second).min(self.per_minute);
        if tokens < 1.0 {
            *bucket = Bucket { tokens, at: now };
            return Err(((1.0 - tokens) / per_second).ceil().max(1.0) as u64);
        }
        *bucket = Bucket { tokens: tokens - 1.0, at: now };
        Ok(())
    }

    /// Requests a minute.
    pub(super) fn per_minute(&self) -> f64 {
        self.per_minute
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_may_ask_as_often_as_a_minute_allows_and_then_at_that_pace() {
        let rates = Rates::new(Some(30));
        let start = Instant::now();
        for _ in 0..30 {
            assert_eq!(rates.take("rig", start), Ok(()));
        }
        assert_eq!(rates.take("rig", start), Err(2), "one token in two seconds");
        assert_eq!(rates.take("other", start), Ok(()), "each key has its own");
        let later = start + Duration::from_secs(2);
        assert_eq!((rates.take("rig", later), rates.take("rig", later)), (Ok(()), Err(2)));
        let much_later = start + Duration::from_secs(3600);
        let allowed = (0..100).filter(|_| rates.take("rig", much_later).is_ok()).count();
        assert_eq!(allowed, 30, "an hour without a request gives no more than a minute");
    }

    #[test]
    fn without_a_limit_nothing_is_counted() {
        let rates = Rates::new(None);
        assert!((0..10_000).all(|_| rates.take("rig", Instant::now()).is_ok()));
        assert!(rates.buckets.lock().unwrap().is_empty());
    }
}
