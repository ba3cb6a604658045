//! What an upload says of itself.

use std::collections::BTreeMap;

/// What the response is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ResponseKind {
    /// Yₖ = Vₖ.
    #[default]
    Velocity,
    /// Yₖ = Vₖ/(jkω); the mean velocity is 0 and harmonic 0 is not compared.
    Position,
    /// Yₖ = jkω·Vₖ; harmonic 0 is not compared.
    Acceleration,
}

/// A physical quantity by name and unit, as the upload writes them.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Quantity {
    /// `current`, `force`, `velocity` …; empty where not said.
    pub name: String,
    /// `A`, `N`, `rad/s` …; empty where not said.
    pub unit: String,
}

/// Whether a controller closed a loop around the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loop {
    /// Open loop.
    Open,
    /// Closed loop: the input carries the noise.
    Closed,
}

/// What an upload says of itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Metadata {
    /// Free name of the measurement.
    pub name: Option<String>,
    /// The input quantity.
    pub input: Quantity,
    /// The response quantity.
    pub response: Quantity,
    /// What the response is.
    pub response_kind: ResponseKind,
    /// Open or closed loop, where said.
    pub feedback: Option<Loop>,
    /// The machine.
    pub machine: Option<String>,
    /// The axis of the machine.
    pub axis: Option<String>,
    /// When it was measured (RFC 3339).
    pub measured_at: Option<jiff::Timestamp>,
    /// Who measured it.
    pub operator: Option<String>,
    /// `label.*` entries, by which lists are filtered.
    pub labels: BTreeMap<String, String>,
}
