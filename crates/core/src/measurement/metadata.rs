//! Metadata of a measurement, as stated in the upload.

use std::collections::BTreeMap;

/// Physical kind of the response Yₖ, relative to the velocity Vₖ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ResponseKind {
    /// Yₖ = Vₖ.
    #[default]
    Velocity,
    /// Yₖ = Vₖ/(jkω). The mean velocity is 0, and harmonic 0 is not compared.
    Position,
    /// Yₖ = jkω·Vₖ. Harmonic 0 is not compared.
    Acceleration,
}

/// Name and unit of a physical quantity, as written in the upload.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Quantity {
    /// `current`, `force`, `velocity` …; empty if not stated.
    pub name: String,
    /// `A`, `N`, `rad/s` …; empty if not stated.
    pub unit: String,
}

/// A unit as it follows a number, after a space; nothing if it is not stated.
pub(crate) fn after_number(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// Whether the axis was measured under feedback control.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loop {
    /// Open loop.
    Open,
    /// Closed loop: the controller feeds measurement noise back into the input.
    Closed,
}

/// Metadata of a measurement.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Metadata {
    /// Name of the measurement, free text.
    pub name: Option<String>,
    /// The input quantity.
    pub input: Quantity,
    /// The response quantity.
    pub response: Quantity,
    /// Whether the response is a velocity, a position or an acceleration.
    pub response_kind: ResponseKind,
    /// Open or closed loop, if stated.
    pub feedback: Option<Loop>,
    /// The machine.
    pub machine: Option<String>,
    /// The axis of the machine.
    pub axis: Option<String>,
    /// Time of the measurement (RFC 3339).
    pub measured_at: Option<jiff::Timestamp>,
    /// Name of the person who measured it.
    pub operator: Option<String>,
    /// The `label.*` entries; the service filters its lists by them.
    pub labels: BTreeMap<String, String>,
}
