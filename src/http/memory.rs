//! How much memory the bodies of all requests may take together, and those of one key.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use axum::http::{Extensions, StatusCode};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::service::{Caller, Service};

use super::problem::Problem;

/// Memory is given in pieces of this size, bytes.
const PIECE: usize = 16 << 10;

/// Memory for bodies, shared by all requests.
#[derive(Debug, Clone)]
pub(super) struct Memory {
    free: Arc<Semaphore>,
    /// Pieces that one key may hold.
    each: usize,
    /// What is free of that, for each key that holds or asks for memory.
    of_keys: Arc<Mutex<HashMap<String, Arc<Semaphore>>>>,
}

/// Memory that one request holds; it is free again when this is dropped.
#[derive(Debug)]
pub(super) struct Held {
    /// What all requests may still take and, for a key, what that key may.
    free: Vec<Arc<Semaphore>>,
    /// What is held of each.
    permits: Vec<OwnedSemaphorePermit>,
}

impl Memory {
    /// So many bytes for all requests, of which one key may hold half. Where that is less than the
    /// largest request takes, a key may hold one such request.
    pub(super) fn new(bytes: usize, largest: usize) -> Self {
        let pieces = |bytes: usize| bytes.div_ceil(PIECE).min(Semaphore::MAX_PERMITS);
        Self {
            free: Arc::new(Semaphore::new(pieces(bytes))),
            each: pieces(bytes / 2).max(pieces(largest)),
            of_keys: Arc::default(),
        }
    }

    /// No memory yet, for a request that asks for more as it goes on; `of`: the service for its caller.
    pub(super) fn none(&self, of: &Extensions) -> Held {
        match of.get::<Service>().map(Service::caller) {
            Some(Caller::Holder(key)) => self.none_for(&key.id),
            // Strangers share what one key may hold.
            Some(Caller::Nobody) => self.none_for(""),
            // Where no keys are used, nobody knows whose requests are whose.
            Some(Caller::Everybody) | None => Held::nothing([&self.free]),
        }
    }

    fn none_for(&self, key: &str) -> Held {
        let mut of_keys = self.of_keys.lock().unwrap_or_else(PoisonError::into_inner);
        of_keys.retain(|_, free| Arc::strong_count(free) > 1);
        let new = || Arc::new(Semaphore::new(self.each));
        Held::nothing([&self.free, of_keys.entry(key.to_owned()).or_insert_with(new)])
    }
}

impl Held {
    fn nothing<'f>(free: impl IntoIterator<Item = &'f Arc<Semaphore>>) -> Self {
        Self { free: free.into_iter().map(Arc::clone).collect(), permits: Vec::new() }
    }

    /// Holds so many bytes in all. `false`: they are not free, and nothing has changed.
    pub(super) fn grow_to(&mut self, bytes: usize) -> bool {
        let held = self.permits.first().map_or(0, OwnedSemaphorePermit::num_permits);
        let more = bytes.div_ceil(PIECE).saturating_sub(held);
        if more == 0 {
            return true;
        }
        let Ok(more) = u32::try_from(more) else { return false };
        let taken = self.free.iter().map(|free| Arc::clone(free).try_acquire_many_owned(more));
        let Ok(taken) = taken.collect::<Result<Vec<_>, _>>() else { return false };
        if self.permits.is_empty() {
            self.permits = taken;
        } else {
            self.permits.iter_mut().zip(taken).for_each(|(permit, more)| permit.merge(more));
        }
        true
    }

    /// Gives back what is held beyond so many bytes.
    pub(super) fn shrink_to(&mut self, bytes: usize) {
        for permit in &mut self.permits {
            let surplus = permit.num_permits().saturating_sub(bytes.div_ceil(PIECE));
            drop(permit.split(surplus));
        }
    }
}

/// Says that other requests hold all memory there is for bodies, or all that a key may hold.
pub(super) fn refusal() -> Box<Problem> {
    let detail = "the bodies of other requests take all memory that the server has for them, or all that \
                  one key may take of it; nothing of this one was stored; send it again in some seconds";
    Problem::of_status(StatusCode::SERVICE_UNAVAILABLE, detail)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_together_hold_no_more_than_there_is() {
        let memory = Memory::new(4 * PIECE, PIECE);
        let none = || memory.none(&Extensions::new());
        let (mut one, mut other) = (none(), none());
        assert!(one.grow_to(1) && one.grow_to(PIECE) && one.grow_to(PIECE + 1));
        assert!(other.grow_to(2 * PIECE) && !other.grow_to(2 * PIECE + 1));
        drop(one);
        assert!(other.grow_to(4 * PIECE));
        other.shrink_to(PIECE);
        assert!(none().grow_to(3 * PIECE) && !none().grow_to(4 * PIECE));
    }

    #[test]
    fn the_requests_of_a_key_hold_half_of_what_there_is_or_one_of_the_largest() {
        let memory = Memory::new(8 * PIECE, PIECE);
        let of = |key: &str| memory.none_for(key);
        let (mut one, mut other) = (of("flood"), of("flood"));
        assert!(one.grow_to(3 * PIECE) && !other.grow_to(2 * PIECE) && other.grow_to(PIECE));
        assert!(!of("flood").grow_to(1));
        assert!(of("rig").grow_to(4 * PIECE) && memory.none(&Extensions::new()).grow_to(4 * PIECE));
        one.shrink_to(PIECE);
        assert!(of("flood").grow_to(2 * PIECE) && !of("flood").grow_to(3 * PIECE));
        let small = Memory::new(8 * PIECE, 6 * PIECE);
        assert!(small.none_for("rig").grow_to(6 * PIECE));
    }
}
