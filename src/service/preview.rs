//! What would be understood of an upload. Nothing is stored.

use std::collections::BTreeMap;

use servoscope_core::measurement::formats::{Look, ParseError};

use crate::store::MeasurementRow;

use super::measurements::{Measured, Upload, check_files, check_points, measured, row};
use super::reading::look_at;
use super::{Service, ServiceError};

/// What would be understood of an upload.
#[derive(Debug, Clone, PartialEq)]
pub struct Preview {
    /// What is seen of its files.
    pub look: Look,
    /// All that is given: by the upload, and by the mapping where the upload says nothing.
    pub given: BTreeMap<String, String>,
    /// The stored mapping that would be used.
    pub mapping: Option<String>,
    /// The measurement, or why it would be refused.
    pub read: Result<Measured, ParseError>,
}

impl Service {
    /// Reads an upload without storing it, and says how.
    ///
    /// # Errors
    /// [`ServiceError::Request`] for too many files, a name that is too long, too many experiments
    /// or a mapping that there is not. Files that cannot be read are no error.
    pub async fn preview(&self, upload: Upload) -> Result<Preview, ServiceError> {
        check_files(&upload)?;
        let Upload { name, given, mapping, files } = upload;
        let reading = self.read_upload(files, given, mapping.as_deref()).await?;
        let read = match reading.measurement {
            Ok(measurement) => {
                check_points(&measurement)?;
                let row: MeasurementRow = row(name, reading.note, &measurement);
                Ok(measured(row)?)
            }
            Err(error) => Err(error),
        };
        let look = look_at(&self.place().await?, reading.files).await;
        Ok(Preview { look, given: reading.given, mapping: reading.mapping, read })
    }
}
