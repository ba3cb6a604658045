//! Mappings: what is given beside files of one layout, kept under a name.

use std::collections::BTreeMap;

use servoscope_core::measurement::formats::Given;

use crate::store::{MappingRow, Millis};

use super::{Added, Service, ServiceError, fitting};

/// Most mappings of one owner.
const MOST_MAPPINGS: u32 = 1000;

/// Most mappings that are listed.
const MOST_LISTED: u32 = 1000;

/// Most bytes of the settings and the layout of a mapping.
const MOST_BYTES: usize = 16 << 10;

/// Most characters of a name.
const MOST_CHARACTERS: usize = 64;

/// Settings and metadata for files of one layout.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mapping {
    /// Its name.
    pub name: String,
    /// Keys and values, as they are given beside a file.
    pub settings: BTreeMap<String, String>,
    /// Layout of the files that it is for; `None`: it is used by its name alone.
    pub layout: Option<String>,
    /// When it was last stored.
    pub updated_at_ms: Millis,
}

impl Mapping {
    /// The settings as TOML, which the command line reads.
    pub fn toml(&self) -> String {
        let value = |value: &String| toml::Value::String(value.clone());
        let settings = self.settings.iter().map(|(key, text)| (key.clone(), value(text)));
        settings.collect::<toml::Table>().to_string()
    }

    /// The settings in words.
    pub(super) fn in_words(&self) -> String {
        let settings = self.settings.iter().map(|(key, value)| format!("{key} is `{value}`"));
        settings.collect::<Vec<_>>().join(", ")
    }
}

impl Service {
    /// Stores a mapping under a name, in place of one that has it.
    ///
    /// # Errors
    /// [`ServiceError::Request`] for a name that cannot be one, no setting at all, a setting that
    /// means nothing, and a new mapping where there are 1000 already.
    pub async fn put_mapping(
        &self,
        name: &str,
        settings: BTreeMap<String, String>,
        layout: Option<String>,
    ) -> Result<Added<Mapping>, ServiceError> {
        let refused = |member: String, reason: String| ServiceError::Request { member, reason };
        check_name(name).map_err(|reason| refused("name".into(), reason))?;
        let mut given = Given::default();
        for (key, value) in &settings {
            given
                .set(key, value)
                .map_err(|error| refused(format!("settings.{key}"), error.reason))?;
        }
        if settings.is_empty() {
            let reason = "at least one is needed, such as `response`".to_owned();
            return Err(refused("settings".into(), reason));
        }
        let settings = serde_json::json!(settings).to_string();
        let bytes = settings.len() + layout.as_ref().map_or(0, String::len);
        if bytes > MOST_BYTES {
            let reason = format!("with the layout they have {bytes} bytes, more than {MOST_BYTES}");
            return Err(refused("settings".into(), reason));
        }
        let row = MappingRow { name: name.to_owned(), settings, layout, updated_at_ms: 0 };
        let created = self.store.put_mapping(&self.reach, &row, MOST_MAPPINGS).await?;
        let Some(created) = created else {
            let reason = format!("there are {MOST_MAPPINGS} mappings already; delete one");
            return Err(refused("name".into(), reason));
        };
        Ok(Added { resource: self.mapping(name).await?, replayed: !created })
    }

    /// One mapping.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none of this name.
    pub async fn mapping(&self, name: &str) -> Result<Mapping, ServiceError> {
        let row = self.store.mapping(&self.reach, name).await?;
        mapping(row.ok_or_else(|| ServiceError::Unknown { what: "mapping", id: name.into() })?)
    }

    /// Mappings by name, at most 1000, and no more than there is room for on a page.
    ///
    /// # Errors
    /// When the database does not answer.
    pub async fn mappings(&self) -> Result<Vec<Mapping>, ServiceError> {
        let mut rows = self.store.mappings(&self.reach, MOST_LISTED).await?;
        let layout = |row: &MappingRow| row.layout.as_ref().map_or(0, String::len);
        rows.truncate(fitting(&rows, |row| row.name.len() + row.settings.len() + layout(row)));
        rows.into_iter().map(mapping).collect()
    }

    /// Removes a mapping. Measurements that were read with it stay as they are.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none of this name.
    pub async fn delete_mapping(&self, name: &str) -> Result<(), ServiceError> {
        match self.store.delete_mapping(&self.reach, name).await? {
            true => Ok(()),
            false => Err(ServiceError::Unknown { what: "mapping", id: name.into() }),
        }
    }

    /// The mapping for files of a layout, if one is stored.
    pub(super) async fn mapping_of_layout(
        &self,
        layout: &str,
    ) -> Result<Option<Mapping>, ServiceError> {
        self.store.mapping_of_layout(&self.reach, layout).await?.map(mapping).transpose()
    }
}

fn mapping(row: MappingRow) -> Result<Mapping, ServiceError> {
    let settings = serde_json::from_str(&row.settings)
        .map_err(|source| ServiceError::Corrupt { what: "mapping", source })?;
    let MappingRow { name, layout, updated_at_ms, .. } = row;
    Ok(Mapping { name, settings, layout, updated_at_ms })
}

fn check_name(name: &str) -> Result<(), String> {
    let is_fine = |c: char| c.is_alphanumeric() || [' ', '-', '_', '.'].contains(&c);
    let length = (1..=MOST_CHARACTERS).contains(&name.chars().count());
    if length && name.chars().all(is_fine) && name.starts_with(char::is_alphanumeric) {
        return Ok(());
    }
    Err(format!(
        "`{name}` is not 1 to {MOST_CHARACTERS} letters, digits, blanks, `-`, `_` and `.` that \
         begin with a letter or a digit"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_words_and_nothing_of_a_path() {
        for name in ["rig 7", "Prüfstand_2", "a.b-c"] {
            assert_eq!(check_name(name), Ok(()), "{name}");
        }
        for name in ["", " rig", "../x", "a/b", ".toml", "a\nb", &"x".repeat(65)] {
            assert!(check_name(name).is_err(), "{name}");
        }
    }

    #[test]
    fn the_settings_are_toml_whatever_they_say() {
        let settings = [("response", "velocity rad/s"), ("label.site", "\"north\"\\")];
        let settings = settings.map(|(key, value)| (key.to_owned(), value.to_owned()));
        let settings = BTreeMap::from(settings);
        let name = "rig".to_owned();
        let mapping = Mapping { name, settings, layout: None, updated_at_ms: 0 };
        let text = mapping.toml();
        let read: toml::Table = toml::from_str(&text).unwrap();
        assert_eq!(read["label.site"].as_str(), Some("\"north\"\\"), "{text}");
        assert!(text.contains("response = \"velocity rad/s\"\n"), "{text}");
    }
}
