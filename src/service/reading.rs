//! Reading an upload, with what is given beside its files and with a stored mapping.

use std::collections::BTreeMap;
use std::sync::Arc;

use servoscope_core::measurement::Measurement;
use servoscope_core::measurement::formats::{Given, Look, ParseError, look};

use crate::store::FileRow;

use super::mappings::Mapping;
use super::measurements::sources;
use super::places::Place;
use super::{Service, ServiceError};

/// An upload that was read, or that was refused.
pub(super) struct Reading {
    /// The files, with what is given beside them.
    pub(super) files: Vec<FileRow>,
    /// All that is given: by the upload, and by the mapping where the upload says nothing.
    pub(super) given: BTreeMap<String, String>,
    /// The stored mapping that is used.
    pub(super) mapping: Option<String>,
    /// What is said of the mapping.
    pub(super) note: Option<String>,
    pub(super) measurement: Result<Measurement, ParseError>,
}

impl Service {
    /// Reads files. With `mapping`, the stored one of this name is used. Otherwise, where the files
    /// cannot be read, the one for files of their layout is used, if there is one.
    ///
    /// # Errors
    /// [`ServiceError::Request`] for a mapping that there is not; [`ServiceError::Busy`]. Files that
    /// cannot be read are no error.
    pub(super) async fn read_upload(
        &self,
        files: Vec<FileRow>,
        given: BTreeMap<String, String>,
        mapping: Option<&str>,
    ) -> Result<Reading, ServiceError> {
        if let Some(name) = mapping {
            let mapping = self.mapping(name).await.map_err(|error| unknown(error, name))?;
            let place = self.place().await?;
            return Ok(self.read_with(&place, files, given, &mapping, "as asked for").await);
        }
        let place = self.place().await?;
        let reading = self.read_given(&place, files, given.clone()).await;
        if reading.measurement.is_ok() {
            return Ok(reading);
        }
        let looking = place.compute(move || {
            let look = look(&sources(&reading.files));
            (reading, look)
        });
        let (reading, look) = looking.await;
        let Some(layout) = &look.layout else { return Ok(reading) };
        let Some(mapping) = self.mapping_of_layout(layout).await? else { return Ok(reading) };
        let files = reading.files.into_iter().filter(|file| file.name != Given::NAME).collect();
        let why = match look.without_names() {
            Some(seen) => format!(
                "since it is for files of {seen} and no column names; other files look like that, too, so \
                 check that this one has the same columns"
            ),
            None => {
                "since it is for files of this layout, which is not understood without it".into()
            }
        };
        Ok(self.read_with(&place, files, given, &mapping, &why).await)
    }

    async fn read_with(
        &self,
        place: &Place,
        files: Vec<FileRow>,
        given: BTreeMap<String, String>,
        mapping: &Mapping,
        why: &str,
    ) -> Reading {
        let mut all = mapping.settings.clone();
        all.extend(given);
        let reading = self.read_given(place, files, all).await;
        let name = &mapping.name;
        let measurement = reading.measurement.map_err(|mut error| {
            error.reason += &format!(" (read with the stored mapping `{name}`)");
            error
        });
        let words = mapping.in_words();
        let note = Some(format!("the stored mapping `{name}` is used, {why}: {words}"));
        Reading { mapping: Some(name.clone()), note, measurement, ..reading }
    }

    /// Reads files with what is given beside them, and with no mapping.
    pub(super) async fn read_given(
        &self,
        place: &Place,
        mut files: Vec<FileRow>,
        given: BTreeMap<String, String>,
    ) -> Reading {
        let text = text(&given);
        let numerics = Arc::clone(&self.numerics);
        let reading = place.compute(move || match text {
            Ok(stated) => {
                files.extend(stated);
                let measurement = numerics.read(&sources(&files));
                (files, measurement)
            }
            Err(error) => (files, Err(error)),
        });
        let (files, measurement) = reading.await;
        Reading { files, given, mapping: None, note: None, measurement }
    }
}

/// Looks at files that were read.
pub(super) async fn look_at(place: &Place, files: Vec<FileRow>) -> Look {
    place.compute(move || look(&sources(&files))).await
}

/// What is given, as one more file.
pub(super) fn text(given: &BTreeMap<String, String>) -> Result<Option<FileRow>, ParseError> {
    let mut stated = Given::default();
    for (key, value) in given {
        stated.set(key, value)?;
    }
    let file = |text: String| FileRow {
        name: Given::NAME.to_owned(),
        content_type: "text/plain".into(),
        bytes: text.into_bytes(),
    };
    Ok(stated.text().map(file))
}

fn unknown(error: ServiceError, name: &str) -> ServiceError {
    match error {
        ServiceError::Unknown { .. } => ServiceError::Request {
            member: "mapping".into(),
            reason: format!(
                "there is no mapping `{name}`; `GET /v1/mappings` lists those there are"
            ),
        },
        other => other,
    }
}
