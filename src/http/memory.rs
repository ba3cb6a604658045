//! How much memory the bodies of all requests may take together.

use std::sync::Arc;

use axum::http::StatusCode;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use super::problem::Problem;

/// Memory is given in pieces of this size, bytes.
const PIECE: usize = 16 << 10;

/// Memory for bodies, shared by all requests.
#[derive(Debug, Clone)]
pub(super) struct Memory {
    free: Arc<Semaphore>,
}

/// Memory that one request holds; it is free again when this is dropped.
#[derive(Debug)]
pub(super) struct Held {
    memory: Memory,
    permit: Option<OwnedSemaphorePermit>,
}

impl Memory {
    /// So many bytes for all requests.
    pub(super) fn new(bytes: usize) -> Self {
        Self { free: Arc::new(Semaphore::new(bytes.div_ceil(PIECE).min(Semaphore::MAX_PERMITS))) }
    }

    /// No memory yet, for a request that asks for more as it goes on.
    pub(super) fn none(&self) -> Held {
        Held { memory: self.clone(), permit: None }
    }
}

impl Held {
    /// Holds so many bytes in all. `false`: they are not free, and nothing has changed.
    pub(super) fn grow_to(&mut self, bytes: usize) -> bool {
        let held = self.permit.as_ref().map_or(0, OwnedSemaphorePermit::num_permits);
        let more = bytes.div_ceil(PIECE).saturating_sub(held);
        if more == 0 {
            return true;
        }
        let Ok(more) = u32::try_from(more) else { return false };
        let Ok(more) = Arc::clone(&self.memory.free).try_acquire_many_owned(more) else {
            return false;
        };
        match &mut self.permit {
            Some(permit) => permit.merge(more),
            None => self.permit = Some(more),
        }
        true
    }

    /// Gives back what is held beyond so many bytes.
    pub(super) fn shrink_to(&mut self, bytes: usize) {
        let Some(permit) = &mut self.permit else { return };
        let surplus = permit.num_permits().saturating_sub(bytes.div_ceil(PIECE));
        drop(permit.split(surplus));
    }
}

/// Says that other requests hold all memory there is for bodies.
pub(super) fn refusal() -> Box<Problem> {
    let detail = "the bodies of other requests take all memory that the server has for them; nothing of \
                  this one was stored; send it again in some seconds";
    Problem::of_status(StatusCode::SERVICE_UNAVAILABLE, detail)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_together_hold_no_more_than_there_is() {
        let memory = Memory::new(4 * PIECE);
        let (mut one, mut other) = (memory.none(), memory.none());
        assert!(one.grow_to(1) && one.grow_to(PIECE) && one.grow_to(PIECE + 1));
        assert!(other.grow_to(2 * PIECE) && !other.grow_to(2 * PIECE + 1));
        drop(one);
        assert!(other.grow_to(4 * PIECE));
        other.shrink_to(PIECE);
        assert!(memory.none().grow_to(3 * PIECE) && !memory.none().grow_to(4 * PIECE));
    }
}
