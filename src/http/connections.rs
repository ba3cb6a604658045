//! Which connections are open, and which of them makes room for another.
//!
//! Every connection is an open file, and a process may open only so many. So at most
//! [`Connections::new`]'s number of them are open. One more takes the place of the one that has
//! been idle longest; a connection is idle while no request of it is being answered, also before
//! its first and while the head of a request comes in bit by bit. Where none is idle, a few more
//! are let in that are answered only by the routes an operator watches: whoever fills the server
//! cannot hide that it is full.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;

/// Connections beyond the limit that are let in to be told so, and for the operator.
const RESERVE: usize = 32;

/// How long the next connection waits at most before it is looked again for room.
const LOOK_AGAIN: Duration = Duration::from_millis(100);

/// The open connections of a listener.
#[derive(Debug)]
pub(super) struct Connections {
    most: usize,
    table: Mutex<Table>,
    /// One was closed, or became idle.
    changed: Notify,
}

#[derive(Debug, Default)]
struct Table {
    /// Counts everything that happens, as a clock without equal times.
    now: u64,
    open: BTreeMap<u64, Entry>,
}

#[derive(Debug)]
struct Entry {
    /// Since when it has been idle; `None` while a request is being answered.
    idle_since: Option<u64>,
    /// It has been told to make room.
    leaving: bool,
    leave: Arc<Notify>,
}

/// The place of one connection, given back when it is dropped.
#[derive(Debug)]
pub(super) struct Place {
    connections: Arc<Connections>,
    id: u64,
    leave: Arc<Notify>,
    /// Whether it is one of the [`RESERVE`].
    pub(super) reserved: bool,
}

/// A request of a connection is being answered for as long as this is kept.
#[derive(Debug)]
pub(super) struct Busy(Arc<Place>);

impl Connections {
    /// At most `most` at once, and [`RESERVE`].
    pub(super) fn new(most: usize) -> Arc<Self> {
        let (table, changed) = Default::default();
        Arc::new(Self { most, table, changed })
    }

    /// A place for a new connection, as soon as there is one. The caller must be the only one.
    pub(super) async fn admit(self: &Arc<Self>) -> Place {
        loop {
            if let Some(place) = self.room() {
                return place;
            }
            let _ = tokio::time::timeout(LOOK_AGAIN, self.changed.notified()).await;
        }
    }

    fn room(self: &Arc<Self>) -> Option<Place> {
        let mut table = self.table();
        // Those told to leave are as good as gone.
        let staying = table.staying();
        let full = staying >= self.most;
        if table.open.len() >= self.most + RESERVE {
            // Where one leaves already, its place is the next; another would leave for nothing.
            if staying == table.open.len() {
                table.send_away();
            }
            return None;
        }
        let makes_room = full && table.send_away();
        let id = table.tick();
        let leave = Arc::new(Notify::new());
        let entry = Entry { idle_since: Some(id), leaving: false, leave: Arc::clone(&leave) };
        table.open.insert(id, entry);
        let connections = Arc::clone(self);
        Some(Place { connections, id, leave, reserved: full && !makes_room })
    }

    fn table(&self) -> MutexGuard<'_, Table> {
        // A panic cannot leave it half-written: every change is one assignment.
        self.table.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Table {
    fn tick(&mut self) -> u64 {
        self.now += 1;
        self.now
    }

    /// How many have not been told to make room.
    fn staying(&self) -> usize {
        self.open.values().filter(|entry| !entry.leaving).count()
    }

    /// Tells the connection that has been idle longest to make room; `false`: none is idle.
    fn send_away(&mut self) -> bool {
        let idle = self.open.values_mut().filter(|entry| !entry.leaving);
        let idle = idle.filter_map(|entry| entry.idle_since.map(|since| (since, entry)));
        let Some((_, longest)) = idle.min_by_key(|(since, _)| *since) else { return false };
        longest.leaving = true;
        longest.leave.notify_one();
        true
    }
}

impl Place {
    /// Waits until another connection needs the place.
    pub(super) async fn needed(&self) {
        self.leave.notified().await;
    }

    /// A request has come.
    pub(super) fn busy(self: &Arc<Self>) -> Busy {
        self.set_idle_since(|_| None);
        Busy(Arc::clone(self))
    }

    fn set_idle_since(&self, since: impl FnOnce(u64) -> Option<u64>) {
        let mut table = self.connections.table();
        let now = table.tick();
        if let Some(entry) = table.open.get_mut(&self.id) {
            entry.idle_since = since(now);
        }
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.set_idle_since(Some);
        self.0.connections.changed.notify_one();
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.connections.table().open.remove(&self.id);
        self.connections.changed.notify_one();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a place is needed by another connection.
    async fn is_needed(place: &Place) -> bool {
        tokio::time::timeout(Duration::ZERO, place.needed()).await.is_ok()
    }

    #[tokio::test]
    async fn the_longest_idle_makes_room_and_one_that_is_busy_does_not() {
        let connections = Connections::new(3);
        let [first, second, third] =
            [(); 3].map(|()| Arc::new(connections.room().expect("there is room")));
        let busy = first.busy();
        drop(second.busy());
        // The third has waited longest now: the second was just answered.
        let fourth = connections.room().expect("one makes room");
        assert!(!fourth.reserved);
        assert!(is_needed(&third).await && !is_needed(&second).await && !is_needed(&first).await);
        drop(busy);
        connections.room().expect("another makes room");
        assert!(is_needed(&second).await && !is_needed(&first).await);
    }

    #[tokio::test]
    async fn connections_that_come_faster_than_others_leave_are_served_all_the_same() {
        let connections = Connections::new(2);
        let mut places: Vec<Arc<Place>> = Vec::new();
        for _ in 0..2 + RESERVE {
            let place = connections.room().expect("there is room");
            assert!(!place.reserved, "others make room for it");
            places.push(Arc::new(place));
        }
        for _ in 0..3 {
            assert!(connections.room().is_none());
        }
        // The last two stay, however often a place was asked for.
        let staying = places.split_off(RESERVE);
        for place in &places {
            assert!(is_needed(place).await);
        }
        for place in &staying {
            assert!(!is_needed(place).await);
        }
        drop(places);
        assert!(!connections.room().expect("there is room").reserved);
    }

    #[tokio::test]
    async fn where_all_are_busy_a_few_more_are_let_in_and_then_none() {
        let connections = Connections::new(2);
        let places = [(); 2].map(|()| Arc::new(connections.room().expect("there is room")));
        let _busy = places.each_ref().map(Place::busy);
        let mut reserve: Vec<_> = (0..RESERVE)
            .map(|_| {
                let place = Arc::new(connections.room().expect("the reserve"));
                assert!(place.reserved);
                (place.busy(), place)
            })
            .collect();
        assert!(connections.room().is_none());
        let (busy, idle) = reserve.pop().expect("one of them");
        drop(busy);
        assert!(connections.room().is_none() && is_needed(&idle).await, "it has to leave first");
        let waiting = Arc::clone(&connections);
        let waiting = tokio::spawn(async move { waiting.admit().await.reserved });
        drop((reserve, idle));
        assert!(waiting.await.unwrap(), "its place is still beyond the limit");
        drop((_busy, places));
        assert!(!connections.room().expect("there is room").reserved);
    }
}
