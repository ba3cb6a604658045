//! Measurements as a client sees them.

use std::collections::BTreeMap;

use serde::Serialize;
use utoipa::ToSchema;

use crate::service::{Measured, Quantities, Quantity};

use super::rfc3339;

/// A stored measurement.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Measurement)]
pub(in crate::http) struct MeasurementView {
    /// Its id.
    pub(in crate::http) id: String,
    /// When it was stored, RFC 3339.
    created_at: Option<String>,
    /// Its name.
    name: Option<String>,
    /// The machine.
    machine: Option<String>,
    /// The axis of the machine.
    axis: Option<String>,
    /// Who measured.
    operator: Option<String>,
    /// When it was measured, RFC 3339.
    measured_at: Option<String>,
    /// Labels of the upload.
    labels: BTreeMap<String, String>,
    /// Hexadecimal SHA-256 of the data.
    sha256: String,
    /// Number of experiments.
    experiments: i64,
    /// Highest harmonic of any experiment.
    highest_harmonic: i64,
    /// Smallest and largest magnitude, input units.
    magnitude_range: [f64; 2],
    /// Lowest and highest fundamental, rad/s.
    omega_range_rad_s: [f64; 2],
    /// The input; null for a measurement stored before this was kept.
    input: Option<SignalView>,
    /// The response; null for a measurement stored before this was kept.
    response: Option<SignalView>,
    /// `velocity`, `position` or `acceleration`; null for a measurement stored before this was
    /// kept.
    response_kind: Option<String>,
    /// `open` or `closed`; null where the upload does not say.
    r#loop: Option<String>,
    /// Remarks of the reader: unknown columns, dropped periods, …
    notes: Vec<String>,
    /// Names of its files.
    files: Vec<String>,
}

impl From<Measured> for MeasurementView {
    fn from(Measured { row, labels, quantities, notes, files }: Measured) -> Self {
        let (input, response, response_kind, r#loop) = SignalView::both(quantities);
        Self {
            id: row.id,
            created_at: rfc3339(row.created_at_ms),
            name: row.name,
            machine: row.machine,
            axis: row.axis,
            operator: row.operator,
            measured_at: row.measured_at,
            labels,
            sha256: row.sha256,
            experiments: row.experiments,
            highest_harmonic: row.highest_harmonic,
            magnitude_range: [row.magnitude_min, row.magnitude_max],
            omega_range_rad_s: [row.omega_min_rad_s, row.omega_max_rad_s],
            input,
            response,
            response_kind,
            r#loop,
            notes,
            files,
        }
    }
}

/// Name and unit of an input or a response.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Signal)]
pub(in crate::http) struct SignalView {
    /// `current`, `force`, `velocity` …; empty where the upload does not say.
    name: String,
    /// `A`, `N`, `rad/s` …; empty where the upload does not say.
    unit: String,
}

impl SignalView {
    /// Input, response, kind of the response and loop.
    pub(in crate::http) fn both(
        quantities: Option<Quantities>,
    ) -> (Option<Self>, Option<Self>, Option<String>, Option<String>) {
        let Some(Quantities { input, response, response_kind, r#loop }) = quantities else {
            return (None, None, None, None);
        };
        (Some(input.into()), Some(response.into()), Some(response_kind), r#loop)
    }
}

impl From<Quantity> for SignalView {
    fn from(Quantity { name, unit }: Quantity) -> Self {
        Self { name, unit }
    }
}
