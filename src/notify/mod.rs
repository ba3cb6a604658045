//! Messages to other programs: signed webhooks and MQTT.
//!
//! What is sent, to whom and when is decided by the service; here is how. A webhook
//! goes only to addresses that are public or that the operator allows, whatever its
//! name resolves to, and never by way of a redirect or a proxy.

mod addresses;
mod mqtt;
mod schedule;
mod secret;
mod tls;
mod webhook;

pub use addresses::Allowed;
pub use mqtt::{Broker, BrokerError};
pub use schedule::{broker_delay, webhook_delay};
pub use secret::Secret;
pub use tls::config as tls_config;
pub use webhook::Webhooks;

use std::net::IpAddr;
use std::time::Duration;

/// The longest that one attempt may take, from the look-up of the name to the answer.
pub const PATIENCE: Duration = Duration::from_secs(15);

/// Why a message was not taken. Texts are for whoever set the webhook up.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SendError {
    /// Nothing can be sent to this address.
    #[error("`{url}` cannot be used: {reason}")]
    Url {
        /// The address.
        url: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The name leads into a network that is not public. The text does not say where: whoever may
    /// add a webhook would learn the addresses of a network that only the server sees.
    #[error(
        "`{host}` leads to what is not a public address; the operator of this server can allow it \
         with --webhook-allow"
    )]
    Forbidden {
        /// The host of the URL.
        host: String,
        /// The first of its addresses that is not allowed.
        address: IpAddr,
    },
    /// The name has no address.
    #[error("`{host}` cannot be resolved: {reason}")]
    Unresolved {
        /// The host of the URL.
        host: String,
        /// What the resolver says.
        reason: String,
    },
    /// The receiver wants no more of them.
    #[error("the receiver answered 410: it wants no more events")]
    Gone,
    /// The receiver sends the message elsewhere.
    #[error("the receiver answered {0}, a redirect; redirects are not followed")]
    Redirected(u16),
    /// The receiver did not accept the message.
    #[error("the receiver answered {0}")]
    Status(u16),
    /// The receiver did not answer in time.
    #[error("no answer within {} s", PATIENCE.as_secs())]
    TimedOut,
    /// There was no connection, or it broke.
    #[error("no connection: {0}")]
    Connection(String),
    /// The broker did not take the message.
    #[error("the broker did not take it: {0}")]
    Broker(String),
}
