//! How many requests of one caller are under way at the same time.
//!
//! Each keeps a connection busy, however little is computed for it: events are followed for hours, and
//! a body may come slowly. So one caller has half of the connections at most.

use std::collections::HashMap;
use std::fmt;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::problem::Problem;

/// Seconds after which to ask again.
const WAIT_S: u64 = 5;

/// Who is told apart from others.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum Who {
    /// The holder of the key with this id.
    Key(String),
    /// Whoever sends from this network, without a key.
    Network(IpAddr),
}

impl Who {
    /// Whoever sends from an address. One who has an address of IPv6 mostly has 2⁶⁴ of them.
    pub(super) fn at(address: IpAddr) -> Self {
        Self::Network(match address {
            IpAddr::V4(_) => address,
            IpAddr::V6(address) => {
                let [a, b, c, d, ..] = address.segments();
                Ipv6Addr::new(a, b, c, d, 0, 0, 0, 0).into()
            }
        })
    }
}

impl fmt::Display for Who {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Key(_) => "this key",
            Self::Network(_) => "whoever asks from your address without a key",
        })
    }
}

/// The requests of everybody that are under way.
#[derive(Debug)]
pub(super) struct Shares {
    /// How many one caller may have.
    each: usize,
    under_way: Mutex<HashMap<Who, usize>>,
}

/// A request is under way for as long as this is kept.
#[derive(Debug)]
pub(super) struct Share {
    shares: Arc<Shares>,
    who: Who,
}

impl Shares {
    /// Of so many connections.
    pub(super) fn new(connections: usize) -> Arc<Self> {
        Arc::new(Self { each: (connections / 2).max(1), under_way: Mutex::default() })
    }

    /// Counts a request.
    ///
    /// # Errors
    /// The caller has as many as one may have.
    pub(super) fn take(self: &Arc<Self>, who: Who) -> Result<Share, Box<Problem>> {
        let mut under_way = self.under_way();
        let count = under_way.entry(who.clone()).or_default();
        if *count >= self.each {
            let detail = format!(
                "{who} has {count} requests under way, as many as one may have at the same time; send it \
                 again when one of them has been answered"
            );
            return Err(Box::new(Problem::over_quota(detail, Some(WAIT_S))));
        }
        *count += 1;
        Ok(Share { shares: Arc::clone(self), who })
    }

    fn under_way(&self) -> MutexGuard<'_, HashMap<Who, usize>> {
        // A panic cannot leave it half-written: every change is one assignment.
        self.under_way.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        let mut under_way = self.shares.under_way();
        let Some(count) = under_way.get_mut(&self.who) else { return };
        *count -= 1;
        if *count == 0 {
            under_way.remove(&self.who);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caller_has_half_of_the_connections_until_a_request_of_it_has_been_answered() {
        let shares = Shares::new(5);
        let key = || Who::Key("rig".into());
        let held = [shares.take(key()).unwrap(), shares.take(key()).unwrap()];
        shares.take(key()).unwrap_err();
        shares.take(Who::Key("other".into())).unwrap();
        drop(held);
        assert!(shares.under_way().is_empty(), "nothing is kept of those who ask nothing");
        shares.take(key()).unwrap();
        Shares::new(1).take(key()).unwrap();
    }

    #[test]
    fn addresses_of_one_network_of_ipv6_are_one_caller() {
        let at = |address: &str| Who::at(address.parse().unwrap());
        assert_eq!(at("2001:db8:1:2::1"), at("2001:db8:1:2:ffff::9"));
        assert_ne!(at("2001:db8:1:2::1"), at("2001:db8:1:3::1"));
        assert_ne!(at("192.0.2.1"), at("192.0.2.2"));
    }
}
