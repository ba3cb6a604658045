//! What a measurement says of itself, changed after it was stored.
//!
//! Its data, units, response and loop stay as they were read; see the module `readings`.

use std::collections::BTreeMap;

use servoscope_core::measurement::Measurement;
use servoscope_core::measurement::formats::{Given, ParseError};

use crate::store::Description;

use super::{Measured, Service, ServiceError};

/// What is changed; what is `None` stays. An empty text takes away what was said.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Redescribed {
    /// Its name.
    pub name: Option<String>,
    /// The machine.
    pub machine: Option<String>,
    /// The axis of the machine.
    pub axis: Option<String>,
    /// Who measured.
    pub operator: Option<String>,
    /// When it was measured, RFC 3339.
    pub measured_at: Option<String>,
    /// All labels.
    pub labels: Option<BTreeMap<String, String>>,
}

impl Service {
    /// Changes what a measurement says of itself. Lists, histories, exports and reports say it from
    /// then on, those of jobs that have ended, too.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id; [`ServiceError::Request`] for what
    /// means nothing.
    pub async fn describe_measurement(
        &self,
        id: &str,
        change: Redescribed,
    ) -> Result<Measured, ServiceError> {
        let Measured { row, labels, .. } = self.measurement(id).await?;
        let Redescribed { name, machine, axis, operator, measured_at, labels: changed } = change;
        let labels = changed.unwrap_or(labels);
        let mut given = Given::default();
        let refused = |error: ParseError| ServiceError::Request {
            member: "labels".into(),
            reason: error.reason,
        };
        for (label, value) in &labels {
            given.set(&format!("label.{label}"), value).map_err(refused)?;
        }
        given.check().map_err(refused)?;
        let description = Description {
            name: changed_to("name", name, row.name)?,
            machine: changed_to("machine", machine, row.machine)?,
            axis: changed_to("axis", axis, row.axis)?,
            operator: changed_to("operator", operator, row.operator)?,
            measured_at: changed_to("measured_at", measured_at, row.measured_at)?,
            labels: serde_json::json!(labels).to_string(),
        };
        if !self.store.describe_measurement(&self.reach, id, &description).await? {
            return Err(ServiceError::Unknown { what: "measurement", id: id.into() });
        }
        self.measurement(id).await
    }
}

/// What is said after a change.
fn changed_to(
    key: &'static str,
    change: Option<String>,
    before: Option<String>,
) -> Result<Option<String>, ServiceError> {
    let Some(text) = change else { return Ok(before) };
    let text = text.trim();
    if text.is_empty() {
        return Ok(None);
    }
    // By the rules for what is given beside a file.
    let checked = Given::default().set(key, text);
    checked.map_err(|error| ServiceError::Request { member: key.into(), reason: error.reason })?;
    Ok(Some(text.to_owned()))
}

/// A measurement as it was read, which says of itself what is stored.
pub(super) fn described(measurement: Measurement, stored: &Measured) -> Measurement {
    let Measured { row, labels, .. } = stored;
    let mut metadata = measurement.metadata().clone();
    metadata.name.clone_from(&row.name);
    metadata.machine.clone_from(&row.machine);
    metadata.axis.clone_from(&row.axis);
    metadata.operator.clone_from(&row.operator);
    metadata.measured_at = row.measured_at.as_ref().and_then(|time| time.parse().ok());
    metadata.labels.clone_from(labels);
    measurement.with_metadata(metadata)
}
