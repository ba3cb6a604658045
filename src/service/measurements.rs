//! Uploading and looking up measurements.

use std::collections::BTreeMap;
use std::sync::Arc;

use servoscope_core::measurement::formats::{Given, Source};
use servoscope_core::measurement::{Experiment, Measurement, Transient};
use sha2::{Digest, Sha256};

use crate::store::{FileRow, IdempotencyKey, Inserted, MeasurementFilter, MeasurementRow};

use super::{Added, Listed, Service, ServiceError, aside, page, paged};

/// Most files that are read as one measurement.
pub const MAX_FILES: usize = 64;

/// Most experiments of one measurement: a fit simulates each of them thousands
/// of times.
pub const MAX_POINTS: usize = 20_000;

/// Files to be read as one measurement.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Upload {
    /// Name of the measurement where the files do not give one.
    pub name: Option<String>,
    /// Metadata that is given beside the files, and holds before theirs.
    pub given: BTreeMap<String, String>,
    /// The files.
    pub files: Vec<FileRow>,
}

impl Upload {
    /// Whether metadata of this name can be given beside the files.
    pub fn can_give(key: &str) -> bool {
        Given::knows(key)
    }

    /// Adds what is given beside the files to them, so that it is stored and read with them.
    fn with_given(mut self) -> Result<Self, ServiceError> {
        let mut given = Given::default();
        for (key, value) in std::mem::take(&mut self.given) {
            given.set(&key, &value).map_err(ServiceError::Upload)?;
        }
        let name = Given::NAME.to_owned();
        let file = |text: String| FileRow {
            name,
            content_type: "text/plain".into(),
            bytes: text.into_bytes(),
        };
        self.files.extend(given.text().map(file));
        Ok(self)
    }

    fn sources(&self) -> Vec<Source<'_>> {
        sources(&self.files)
    }

    /// What tells two uploads apart.
    fn digest(&self) -> String {
        let mut hash = Sha256::new();
        let mut add = |part: &[u8]| {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        };
        add(self.name.as_deref().unwrap_or_default().as_bytes());
        for file in &self.files {
            add(file.name.as_bytes());
            add(file.content_type.as_bytes());
            add(&file.bytes);
        }
        hexadecimal(&hash.finalize())
    }
}

/// A stored measurement as it is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// What the store keeps of it.
    pub row: MeasurementRow,
    /// `label.*` entries.
    pub labels: BTreeMap<String, String>,
    /// Remarks of the reader.
    pub notes: Vec<String>,
}

impl Service {
    /// Reads and stores a measurement; nothing is stored when it cannot be read.
    ///
    /// # Errors
    /// [`ServiceError::Upload`] says where the data is wrong.
    pub async fn add_measurement(
        &self,
        upload: Upload,
        key: Option<String>,
    ) -> Result<Added<Measured>, ServiceError> {
        at_most("files", upload.files.len(), MAX_FILES)?;
        let upload = upload.with_given()?;
        let numerics = Arc::clone(&self.numerics);
        let reading = aside(move || {
            let read = numerics.read(&upload.sources());
            (upload, read)
        });
        let (upload, read) = reading.await;
        let measurement = read?;
        at_most("experiments", measurement.experiments().len(), MAX_POINTS)?;
        let row = row(&upload, &measurement);
        let key = key.map(|key| IdempotencyKey { key, body_sha256: upload.digest() });
        match self.store.insert_measurement(&row, &upload.files, key.as_ref()).await? {
            Inserted::Created => {
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
        let row = self.store.measurement(id).await?;
        measured(row.ok_or_else(|| ServiceError::Unknown { what: "measurement", id: id.into() })?)
    }

    /// Removes a measurement with its files and every job on it. Jobs that run are
    /// stopped.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn delete_measurement(&self, id: &str) -> Result<(), ServiceError> {
        if !self.store.delete_measurement(id).await? {
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
        let rows = self.store.measurements(filter, &page(limit, cursor)?).await?;
        paged(rows, limit, |row| &row.id, measured)
    }
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

pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn measured(row: MeasurementRow) -> Result<Measured, ServiceError> {
    let corrupt = |what| move |source| ServiceError::Corrupt { what, source };
    let labels = serde_json::from_str(&row.labels).map_err(corrupt("labels"))?;
    let notes = serde_json::from_str(&row.notes).map_err(corrupt("notes"))?;
    Ok(Measured { row, labels, notes })
}

fn row(upload: &Upload, measurement: &Measurement) -> MeasurementRow {
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
    let highest_harmonic = experiments.iter().map(Experiment::highest_harmonic).max();
    MeasurementRow {
        id: uuid::Uuid::now_v7().to_string(),
        created_at_ms: 0,
        name: metadata.name.clone().or_else(|| upload.name.clone()),
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
        notes: serde_json::json!(measurement.notes()).to_string(),
    }
}
