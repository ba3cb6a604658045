//! Recognising who holds a key, and browsers that are signed in with one.

use std::time::Duration;

use subtle::ConstantTimeEq as _;
use tracing::warn;

use crate::store::{KeyRow, Millis};

use super::caller::Key;
use super::keys::{no_random_numbers, now_ms};
use super::token::{Token, digest, random};
use super::{Service, ServiceError};

/// How exactly it is known when a key was last used: a write for each request would be too much.
const USED_WITHIN_MS: Millis = 60_000;

/// How long a browser stays signed in.
const SESSION: Duration = Duration::from_secs(12 * 3600);

/// Most browsers that are signed in with one key.
const MOST_SESSIONS: u32 = 20;

/// A browser that has just been signed in.
pub struct Session {
    /// What its cookie holds; only a digest of it is stored.
    pub secret: String,
    /// For how long.
    pub lifetime: Duration,
    /// Who is signed in.
    pub key: Key,
}

impl Service {
    /// The key that somebody sends.
    ///
    /// # Errors
    /// [`ServiceError::Unrecognised`] where it opens nothing.
    pub async fn holder_of(&self, text: &str) -> Result<Key, ServiceError> {
        let wrong = ServiceError::Unrecognised { reason: "this key is not known here" };
        let Some(token) = Token::parse(text) else { return Err(wrong) };
        match self.store.key(token.id()).await? {
            Some(row) if is_of(&token.sha256(), &row.sha256) => self.used(row).await,
            _ => Err(wrong),
        }
    }

    /// The key that a session was begun with.
    ///
    /// # Errors
    /// [`ServiceError::Unrecognised`] where it has ended, or its key opens nothing any more.
    pub async fn signed_in(&self, secret: &str) -> Result<Key, ServiceError> {
        let row = self.store.session(&digest(secret)).await?;
        let ended = ServiceError::Unrecognised { reason: "the session has ended; sign in again" };
        self.used(row.ok_or(ended)?).await
    }

    /// Signs a browser in with a key. Its session of `before` ends, and so does the oldest of a key
    /// that has more than 20.
    ///
    /// # Errors
    /// As [`Service::holder_of`].
    pub async fn sign_in(&self, text: &str, before: Option<&str>) -> Result<Session, ServiceError> {
        let key = self.holder_of(text).await?;
        if let Some(secret) = before {
            self.sign_out(secret).await?;
        }
        let secret = random::<32>().ok_or_else(no_random_numbers)?;
        let lifetime_ms = i64::try_from(SESSION.as_millis()).unwrap_or(i64::MAX);
        self.store.insert_session(&digest(&secret), &key.id, now_ms() + lifetime_ms).await?;
        self.store.end_oldest_sessions(&key.id, MOST_SESSIONS).await?;
        Ok(Session { secret, lifetime: SESSION, key })
    }

    /// Signs a browser out.
    ///
    /// # Errors
    /// When the database does not answer.
    pub async fn sign_out(&self, secret: &str) -> Result<(), ServiceError> {
        Ok(self.store.delete_session(&digest(secret)).await?)
    }

    /// A key that its holder has proved to have, if it opens anything.
    async fn used(&self, row: KeyRow) -> Result<Key, ServiceError> {
        let (now_ms, id) = (row.now_ms, row.id.clone());
        let key = Key::try_from(row)?;
        if key.revoked_at_ms.is_some() {
            return Err(ServiceError::Unrecognised { reason: "this key was revoked" });
        }
        if !key.valid {
            return Err(ServiceError::Unrecognised { reason: "this key has expired" });
        }
        if key.used_at_ms.is_none_or(|at| now_ms - at >= USED_WITHIN_MS)
            && let Err(error) = self.store.key_used(&id).await
        {
            // A full disk must not lock everybody out.
            warn!(key = id, %error, "it is not remembered that a key was used");
        }
        Ok(key)
    }
}

/// Whether two digests are equal, in a time that does not tell how much of them is.
pub(super) fn is_of(sha256: &str, stored: &str) -> bool {
    sha256.as_bytes().ct_eq(stored.as_bytes()).into()
}
