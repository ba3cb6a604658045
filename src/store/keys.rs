//! Keys by which callers are recognised, and browsers that are signed in with one.

use std::time::Duration;

use async_trait::async_trait;

use super::{Millis, StoreError, Usage};

/// A key, without what only its holder knows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyRow {
    /// The part of the key by which it is found.
    pub id: String,
    /// Its name, for people.
    pub name: String,
    /// JSON array of the names of its scopes.
    pub scopes: String,
    /// Hexadecimal digest of the whole key.
    pub sha256: String,
    /// When it was stored; ignored on insertion.
    pub created_at_ms: Millis,
    /// When it expires; `None`: never.
    pub expires_at_ms: Option<Millis>,
    /// When it was revoked; ignored on insertion.
    pub revoked_at_ms: Option<Millis>,
    /// When it was last used, to the minute; ignored on insertion.
    pub used_at_ms: Option<Millis>,
    /// JSON object of what it may have, where it is not what every key may.
    pub quotas: String,
    /// When this was read; ignored on insertion.
    pub now_ms: Millis,
}

impl KeyRow {
    /// Whether it opens anything: it is neither revoked nor expired.
    pub fn is_valid(&self) -> bool {
        self.revoked_at_ms.is_none() && self.expires_at_ms.is_none_or(|end| end > self.now_ms)
    }
}

/// The part of a store that remembers keys.
#[async_trait]
pub trait Keyring {
    /// Stores a key. `false`: there is one with this id, and nothing was stored.
    async fn insert_key(&self, row: &KeyRow) -> Result<bool, StoreError>;

    /// Gives a key that is not revoked another digest and end, and signs out those who signed in
    /// with it. `false`: there is none with this id.
    async fn replace_key(
        &self,
        id: &str,
        sha256: &str,
        expires_at_ms: Option<Millis>,
    ) -> Result<bool, StoreError>;

    /// The key, if there is one with this id.
    async fn key(&self, id: &str) -> Result<Option<KeyRow>, StoreError>;

    /// At most `limit` keys, those that were stored last first.
    async fn keys(&self, limit: u32) -> Result<Vec<KeyRow>, StoreError>;

    /// Whether any key was ever stored.
    async fn has_keys(&self) -> Result<bool, StoreError>;

    /// Whether some key is neither revoked nor expired.
    async fn has_valid_key(&self) -> Result<bool, StoreError>;

    /// Revokes a key for good, and signs out those who signed in with it. `false`: there is none
    /// with this id.
    async fn revoke_key(&self, id: &str) -> Result<bool, StoreError>;

    /// Gives a key other quotas. `false`: there is none with this id.
    async fn limit_key(&self, id: &str, quotas: &str) -> Result<bool, StoreError>;

    /// Remembers that a key is used now.
    async fn key_used(&self, id: &str) -> Result<(), StoreError>;

    /// What the key with this id has stored and has waiting, and what its jobs computed within the
    /// `last` time, at most seven days: in every attempt, and whether or not they are still there.
    async fn usage(&self, id: &str, last: Duration) -> Result<Usage, StoreError>;

    /// Signs in: stores the digest of a session with a key until a time, and removes sessions that
    /// have ended.
    async fn insert_session(
        &self,
        sha256: &str,
        key_id: &str,
        expires_at_ms: Millis,
    ) -> Result<(), StoreError>;

    /// Ends the sessions of a key that expire first, but for `most`.
    async fn end_oldest_sessions(&self, key_id: &str, most: u32) -> Result<(), StoreError>;

    /// The key of the session with this digest, if there is one that has not ended.
    async fn session(&self, sha256: &str) -> Result<Option<KeyRow>, StoreError>;

    /// Signs out.
    async fn delete_session(&self, sha256: &str) -> Result<(), StoreError>;
}
