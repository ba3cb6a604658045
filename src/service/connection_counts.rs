//! What an operator watches of connections.

use prometheus_client::encoding::EncodeLabelSet;
use prometheus_client::metrics::counter::Counter;
use prometheus_client::metrics::family::Family;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::Registry;

/// Why the server closed a connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Closed {
    /// No request, or half a head of one, for as long as that may take.
    Idle,
    /// It was idle, and another needed its place.
    Room,
    /// Its client took nothing of an answer.
    Unread,
}

/// The same as a label.
#[derive(Debug, Clone, PartialEq, Eq, Hash, EncodeLabelSet)]
struct Why {
    why: &'static str,
}

/// Connections of one process.
#[derive(Debug, Clone, Default)]
pub struct ConnectionCounts {
    open: Gauge,
    refused: Counter,
    closed: Family<Why, Counter>,
}

impl ConnectionCounts {
    /// Counts that are exported.
    pub(super) fn registered(registry: &mut Registry) -> Self {
        let counts = Self::default();
        registry.register("connections_open", "Connections that are open", counts.open.clone());
        registry.register(
            "connections_refused",
            "Connections that came while as many were busy as may be",
            counts.refused.clone(),
        );
        registry.register(
            "connections_closed",
            "Connections that the server closed before their client did",
            counts.closed.clone(),
        );
        // Each is there from the start, so that its growth can be watched.
        for why in [Closed::Idle, Closed::Room, Closed::Unread] {
            let _ = counts.of(why);
        }
        counts
    }

    /// A connection is open until what is returned is dropped; `refused`: requests on it are.
    pub fn opened(&self, refused: bool) -> Open {
        if refused {
            self.refused.inc();
        }
        self.open.inc();
        Open(self.open.clone())
    }

    /// The server closed a connection.
    pub fn closed(&self, why: Closed) {
        self.of(why).inc();
    }

    fn of(&self, why: Closed) -> Counter {
        let why = match why {
            Closed::Idle => "idle",
            Closed::Room => "room",
            Closed::Unread => "unread",
        };
        self.closed.get_or_create(&Why { why }).clone()
    }
}

/// A connection that is open.
#[derive(Debug)]
pub struct Open(Gauge);

impl Drop for Open {
    fn drop(&mut self) {
        self.0.dec();
    }
}
