//! What is given beside files of one layout, kept under names.

use async_trait::async_trait;

use super::{Millis, Reach, StoreError};

/// What is given beside files of one layout, under a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MappingRow {
    /// Its name.
    pub name: String,
    /// JSON object of keys and values.
    pub settings: String,
    /// Layout of the files that it is for; `None`: it is used by its name alone.
    pub layout: Option<String>,
    /// When it was last stored; the store says.
    pub updated_at_ms: Millis,
}

/// The part of a store that remembers mappings.
#[async_trait]
pub trait Mappings {
    /// Stores a mapping under its name; `false`: in place of another. `None`: it would be a new one,
    /// and its owner has `most` of them already.
    async fn put_mapping(
        &self,
        reach: &Reach,
        row: &MappingRow,
        most: u32,
    ) -> Result<Option<bool>, StoreError>;

    /// The mapping, if there is one of this name.
    async fn mapping(&self, reach: &Reach, name: &str) -> Result<Option<MappingRow>, StoreError>;

    /// The mapping for files of this layout that was stored last, if there is one.
    async fn mapping_of_layout(
        &self,
        reach: &Reach,
        layout: &str,
    ) -> Result<Option<MappingRow>, StoreError>;

    /// At most `limit` mappings, by name.
    async fn mappings(&self, reach: &Reach, limit: u32) -> Result<Vec<MappingRow>, StoreError>;

    /// Removes a mapping. `false`: there is none of this name.
    async fn delete_mapping(&self, reach: &Reach, name: &str) -> Result<bool, StoreError>;
}
