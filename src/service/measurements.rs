//! Uploading and looking up measurements.

use std::collections::BTreeMap;

use servoscope_core::measurement::formats::{Given, MAX_EXPERIMENTS, Source};
use servoscope_core::measurement::{Experiment, Measurement, Transient};
use sha2::{Digest, Sha256};

use crate::store::{FileRow, IdempotencyKey, Inserted, MeasurementFilter, MeasurementRow};

use super::cost::Cost;
use super::quantities::Quantities;
use super::{Added, Listed, Service, ServiceError, page, paged, reading};

/// Most files that are read as one measurement.
pub const MAX_FILES: usize = 64;

/// Most experiments of one measurement: a fit simulates each of them thousands
/// of times.
pub const MAX_POINTS: usize = MAX_EXPERIMENTS;

/// Most bytes of the name of a measurement or of a file, and of the type of a file.
pub const MAX_NAME_BYTES: usize = 1000;

/// Files to be read as one measurement.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Upload {
    /// Name of the measurement where the files do not give one.
    pub name: Option<String>,
    /// Metadata that is given beside the files, and takes precedence over theirs.
    pub given: BTreeMap<String, String>,
    /// Stored mapping that is used.
    pub mapping: Option<String>,
    /// The files.
    pub files: Vec<FileRow>,
}

impl Upload {
    /// Whether metadata of this name can be given beside the files.
    pub fn can_give(key: &str) -> bool {
        Given::knows(key)
    }

    /// What tells two uploads apart: a mapping by its name, whatever it says.
    fn digest(&self) -> Result<String, ServiceError> {
        let mut hash = Sha256::new();
        let mut add = |part: &[u8]| {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        };
        add(self.name.as_deref().unwrap_or_default().as_bytes());
        let given = reading::text(&self.given)?;
        for file in self.files.iter().chain(&given) {
            add(file.name.as_bytes());
            add(file.content_type.as_bytes());
            add(&file.bytes);
        }
        if let Some(mapping) = &self.mapping {
            add(mapping.as_bytes());
        }
        Ok(hexadecimal(&hash.finalize()))
    }
}

/// A stored measurement as it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// What the store keeps of it.
    pub row: MeasurementRow,
    /// `label.*` entries.
    pub labels: BTreeMap<String, String>,
    /// What input and response are; `None` for a measurement stored by an earlier version.
    pub quantities: Option<Quantities>,
    /// Remarks of the reader.
    pub notes: Vec<String>,
    /// Names of its files.
    pub files: Vec<String>,
}

impl Service {
    /// Reads and stores a measurement; nothing is stored when it cannot be read.
    ///
    /// # Errors
    /// [`ServiceError::Upload`] says where the data is wrong; [`ServiceError::Request`] for too many
    /// files and names that are too long; [`ServiceError::OverQuota`].
    pub async fn add_measurement(
        &self,
        upload: Upload,
        key: Option<String>,
    ) -> Result<Added<Measured>, ServiceError> {
        check_files(&upload)?;
        let body_sha256 = upload.digest()?;
        let key = key.map(|key| IdempotencyKey { key, body_sha256 });
        let Upload { name, given, mapping, files } = upload;
        let reading = self.read_upload(files, given, mapping.as_deref()).await?;
        let measurement = reading.measurement?;
        check_points(&measurement)?;
        let row = row(name, reading.note, &measurement);
        match self.store.insert_measurement(&self.reach, &row, &reading.files, key.as_ref()).await?
        {
            Inserted::Created => {
                self.keep_measurement_within_quotas(&row.id).await?;
                Ok(Added { resource: self.measurement(&row.id).await?, replayed: false })
            }
            Inserted::Replayed(id) => {
                Ok(Added { resource: self.measurement(&id).await?, replayed: true })
            }
            Inserted::KeyReused => {
                Err(ServiceError::KeyReused { key: key.map(|key| key.key).unwrap_or_default() })
            }
        }
    }

    /// One measurement.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn measurement(&self, id: &str) -> Result<Measured, ServiceError> {
        let row = self.store.measurement(&self.reach, id).await?;
        measured(row.ok_or_else(|| ServiceError::Unknown { what: "measurement", id: id.into() })?)
    }

    /// Removes a measurement with its files and every job on it. Jobs that run are
    /// stopped.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn delete_measurement(&self, id: &str) -> Result<(), ServiceError> {
        if !self.store.delete_measurement(&self.reach, id).await? {
            return Err(ServiceError::Unknown { what: "measurement", id: id.into() });
        }
        self.signals.job_unwanted();
        self.signals.job_ended();
        Ok(())
    }

    /// Measurements, newest first.
    ///
    /// # Errors
    /// [`ServiceError::Request`] for a limit or cursor that cannot be used.
    pub async fn measurements(
        &self,
        filter: &MeasurementFilter,
        limit: u32,
        cursor: Option<String>,
    ) -> Result<Listed<Measured>, ServiceError> {
        let rows = self.store.measurements(&self.reach, filter, &page(limit, cursor)?).await?;
        let bytes = |row: &MeasurementRow| row.notes.len() + row.labels.len() + row.files.len();
        paged(rows, limit, |row| &row.id, bytes, measured)
    }
}

/// Checks how many files an upload has, and how long what it calls things is.
pub(super) fn check_files(upload: &Upload) -> Result<(), ServiceError> {
    let Upload { name, mapping, files, .. } = upload;
    at_most("files", files.len(), MAX_FILES)?;
    for (member, text) in [("name", name), ("mapping", mapping)] {
        short(member, "it", text.as_deref().unwrap_or_default())?;
    }
    for (file, number) in files.iter().zip(1..) {
        short("files", &format!("the name of file {number}"), &file.name)?;
        short("files", &format!("the content type of file {number}"), &file.content_type)?;
    }
    Ok(())
}

/// Checks that a text can be a name.
fn short(member: &str, what: &str, text: &str) -> Result<(), ServiceError> {
    if text.len() <= MAX_NAME_BYTES {
        return Ok(());
    }
    let reason = format!("{what} has {} bytes, more than {MAX_NAME_BYTES}", text.len());
    Err(ServiceError::Request { member: member.into(), reason })
}

pub(super) fn check_points(measurement: &Measurement) -> Result<(), ServiceError> {
    at_most("experiments", measurement.experiments().len(), MAX_POINTS)
}

fn at_most(what: &str, count: usize, most: usize) -> Result<(), ServiceError> {
    if count <= most {
        return Ok(());
    }
    let reason = format!("{count} are more than the {most} that are taken as one measurement");
    Err(ServiceError::Request { member: what.into(), reason })
}

/// Stored files as the reader takes them.
pub(super) fn sources(files: &[FileRow]) -> Vec<Source<'_>> {
    files.iter().map(|file| Source { name: &file.name, bytes: &file.bytes }).collect()
}

/// Bytes as hexadecimal digits.
pub(crate) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

pub(super) fn measured(row: MeasurementRow) -> Result<Measured, ServiceError> {
    let corrupt = |what| move |source| ServiceError::Corrupt { what, source };
    let labels = serde_json::from_str(&row.labels).map_err(corrupt("labels"))?;
    let notes = serde_json::from_str(&row.notes).map_err(corrupt("notes"))?;
    let quantities = row.quantities.as_deref().map(serde_json::from_str).transpose();
    let quantities = quantities.map_err(corrupt("quantities"))?;
    let mut files: Vec<String> = serde_json::from_str(&row.files).map_err(corrupt("files"))?;
    files.retain(|name| name != Given::NAME);
    Ok(Measured { row, labels, quantities, notes, files })
}

/// What is kept of a measurement; `note` comes before the remarks of its reader.
pub(super) fn row(
    name: Option<String>,
    note: Option<String>,
    measurement: &Measurement,
) -> MeasurementRow {
    let metadata = measurement.metadata();
    let (experiments, transients) = (measurement.experiments(), measurement.transients());
    let range = |of_experiment: fn(&Experiment) -> f64, of_transient: fn(&Transient) -> f64| {
        experiments
            .iter()
            .map(of_experiment)
            .chain(transients.iter().map(of_transient))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let (magnitude_min, magnitude_max) =
        range(|experiment| experiment.magnitude, Transient::magnitude);
    // A motion that does not repeat has no fundamental: once over its duration stands for it.
    let once = |transient: &Transient| std::f64::consts::TAU / transient.duration_s();
    let (omega_min_rad_s, omega_max_rad_s) = range(|experiment| experiment.omega_rad_s, once);
    let notes: Vec<&String> = note.iter().chain(measurement.notes()).collect();
    let highest_harmonic = experiments.iter().map(Experiment::highest_harmonic).max();
    let cost = Cost::of(measurement);
    MeasurementRow {
        id: uuid::Uuid::now_v7().to_string(),
        created_at_ms: 0,
        name: metadata.name.clone().or(name),
        machine: metadata.machine.clone(),
        axis: metadata.axis.clone(),
        operator: metadata.operator.clone(),
        measured_at: metadata.measured_at.map(|time| time.to_string()),
        labels: serde_json::json!(metadata.labels).to_string(),
        sha256: measurement.sha256().to_owned(),
        experiments: (experiments.len() + transients.len()) as i64,
        highest_harmonic: highest_harmonic.unwrap_or_default() as i64,
        magnitude_min,
        magnitude_max,
        omega_min_rad_s,
        omega_max_rad_s,
        notes: serde_json::json!(notes).to_string(),
        quantities: Some(serde_json::json!(Quantities::of(metadata)).to_string()),
        files: "[]".to_owned(),
        simulation_s: Some(cost.simulation_s),
        diagnosis_s: Some(cost.diagnosis_s),
    }
}
