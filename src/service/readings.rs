//! Stored files read again: in other units, as another kind of response, with other columns.
//!
//! That is possible until there is a job on the measurement. A result stands on how the files were
//! read.

use std::collections::BTreeMap;

use servoscope_core::measurement::formats::{Given, ParseError, Source};

use crate::store::{FileRow, RereadRow, Rereading};

use super::measurements::{Measured, check_points, measured, row};
use super::places::Place;
use super::preview::Preview;
use super::reading::{Reading, look_at};
use super::{Service, ServiceError};

/// Keys of what a measurement says of itself, which does not change how its files are read.
const DESCRIPTION: [&str; 5] = ["name", "machine", "axis", "operator", "measured_at"];

/// What is given beside files, by its keys.
pub type Statements = BTreeMap<String, String>;

impl Service {
    /// What would be understood of the stored files with these statements beside them, in the place
    /// of those that are stored; `None`: with those.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id; [`ServiceError::Request`] for a
    /// statement that does not change how files are read. Files that cannot be read are no error.
    pub async fn preview_reading(
        &self,
        id: &str,
        given: Option<Statements>,
    ) -> Result<Preview, ServiceError> {
        let (place, reading) = self.stored_reading(id, given).await?;
        let read = match reading.measurement {
            Ok(measurement) => {
                check_points(&measurement)?;
                Ok(measured(row(None, None, &measurement))?)
            }
            Err(error) => Err(error),
        };
        let given = statements(reading.given).0;
        let look = look_at(&place, reading.files).await;
        Ok(Preview { look, given, mapping: None, read })
    }

    /// Reads the stored files again with these statements beside them, in the place of those that
    /// are stored. Name, machine, axis and the like stay as they are.
    ///
    /// # Errors
    /// As [`Service::preview_reading`]; [`ServiceError::Upload`] where the files cannot be read like
    /// that, and [`ServiceError::HasJobs`] where there is a job on the measurement. Then nothing is
    /// changed.
    pub async fn read_again(&self, id: &str, given: Statements) -> Result<Measured, ServiceError> {
        let (_, reading) = self.stored_reading(id, Some(given)).await?;
        let measurement = reading.measurement?;
        check_points(&measurement)?;
        let row = row(None, None, &measurement);
        let given = reading.files.into_iter().find(|file| file.name == Given::NAME);
        let reread = RereadRow { row, given_name: Given::NAME, given };
        match self.store.reread_measurement(&self.reach, id, &reread).await? {
            Rereading::Stored => self.measurement(id).await,
            Rereading::HasJobs => Err(ServiceError::HasJobs { id: id.into() }),
            Rereading::Unknown => Err(ServiceError::Unknown { what: "measurement", id: id.into() }),
        }
    }

    /// The stored files as they are read with these statements, and the place they are read in.
    async fn stored_reading(
        &self,
        id: &str,
        given: Option<Statements>,
    ) -> Result<(Place, Reading), ServiceError> {
        // Whoever may only read it does not read it in another way.
        let reach = self.reach.for_changes();
        if self.store.measurement(&reach, id).await?.is_none() {
            return Err(ServiceError::Unknown { what: "measurement", id: id.into() });
        }
        let (place, files) = self.place_with_files(id).await?;
        let (beside, files): (Vec<FileRow>, Vec<FileRow>) =
            files.into_iter().partition(|file| file.name == Given::NAME);
        let (stored, description) = statements(stated(&beside)?);
        let mut all = given.unwrap_or(stored);
        all.retain(|_, value| !value.trim().is_empty());
        if let Some(key) = all.keys().find(|key| describes(key)) {
            let reason = "it does not change how the files are read; change it with `PATCH \
                          /v1/measurements/{id}`";
            return Err(ServiceError::Request {
                member: format!("given.{key}"),
                reason: reason.into(),
            });
        }
        all.extend(description);
        let reading = self.read_given(&place, files, all).await;
        Ok((place, reading))
    }
}

/// Whether a key is of what a measurement says of itself.
fn describes(key: &str) -> bool {
    DESCRIPTION.contains(&key) || key.starts_with("label.")
}

/// What changes how files are read, and what a measurement says of itself.
fn statements(given: Statements) -> (Statements, Statements) {
    given.into_iter().partition(|(key, _)| !describes(key))
}

/// What is given by the files that carry it.
fn stated(files: &[FileRow]) -> Result<Statements, ParseError> {
    let mut all = Statements::new();
    for file in files {
        let source = Source { name: &file.name, bytes: &file.bytes };
        let Some(given) = Given::of(&source).transpose()? else { continue };
        let entries = given.entries().map(|(key, value)| (key.to_owned(), value.to_owned()));
        all.extend(entries);
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_measurement_says_of_itself_is_no_statement_on_its_files() {
        let given = [("response", "position mm"), ("machine", "press 4"), ("label.site", "north")];
        let given = given.map(|(key, value)| (key.to_owned(), value.to_owned()));
        let (statements, description) = statements(given.into());
        assert_eq!(statements.into_keys().collect::<Vec<_>>(), ["response"]);
        assert_eq!(description.into_keys().collect::<Vec<_>>(), ["label.site", "machine"]);
    }
}
