//! Making, listing and revoking keys.

use jiff::Timestamp;

use crate::store::{KeyRow, Millis};

use super::caller::{Key, Scope};
use super::holders::is_of;
use super::quotas::Quotas;
use super::token::Token;
use super::{Service, ServiceError};

/// Most keys that are listed.
const MOST_LISTED: u32 = 1000;

/// Most characters of a name.
const MOST_CHARACTERS: usize = 64;

/// A key to be made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewKey {
    /// Its name, for people.
    pub name: String,
    /// What it may do.
    pub scopes: Vec<Scope>,
    /// When it expires; `None`: never.
    pub expires_at_ms: Option<Millis>,
    /// What it may have, where it is not what every key may.
    pub quotas: Quotas,
}

impl Service {
    /// Makes a key, and gives what only its holder has: it is not shown again.
    ///
    /// # Errors
    /// [`ServiceError::Request`] for a name, scopes, an end or quotas that no key can have.
    pub async fn add_key(&self, new: NewKey) -> Result<(Key, Token), ServiceError> {
        let NewKey { name, mut scopes, expires_at_ms, quotas } = new;
        let refused = |member: &str, reason: String| {
            Err(ServiceError::Request { member: member.into(), reason })
        };
        let fits = (1..=MOST_CHARACTERS).contains(&name.chars().count());
        if !fits || name.chars().any(char::is_control) || name.trim() != name {
            let reason = format!("`{name}` is not 1 to {MOST_CHARACTERS} characters of one line");
            return refused("name", reason);
        }
        if scopes.is_empty() {
            let known = Scope::ALL.map(Scope::name).join(", ");
            return refused("scopes", format!("name at least one; known: {known}"));
        }
        scopes.sort_by_key(|scope| Scope::ALL.iter().position(|known| known == scope));
        scopes.dedup();
        if expires_at_ms.is_some_and(|end| end <= now_ms()) {
            return refused("expires_at", "this time has passed".into());
        }
        quotas.check()?;
        let token = Token::generate().ok_or_else(no_random_numbers)?;
        let quotas = serde_json::json!(quotas).to_string();
        let row = KeyRow { expires_at_ms, quotas, ..row(&token, name, &scopes) };
        self.store.insert_key(&row).await?;
        Ok((self.key(token.id()).await?, token))
    }

    /// Stores a key that was made elsewhere, with the scope `admin`. One that is stored already
    /// stays as it is, also where it was revoked. `true`: it is new.
    ///
    /// # Errors
    /// [`ServiceError::Request`] for a text that is no key, or one that could be guessed; also where
    /// another key has its id.
    pub async fn import_admin_key(&self, text: &str) -> Result<bool, ServiceError> {
        let refused = |reason: &str| {
            Err(ServiceError::Request { member: "admin key".into(), reason: reason.into() })
        };
        let Some(token) = Token::parse(text.trim()) else {
            return refused(
                "it is not `sk_servoscope_`, 16 hexadecimal digits, `_` and 64 hexadecimal \
                 digits; `servoscope keys generate` prints one",
            );
        };
        if !token.looks_random() {
            return refused("it could be guessed; `servoscope keys generate` prints one");
        }
        let name = "first admin key".to_owned();
        if self.store.insert_key(&row(&token, name, &[Scope::Admin])).await? {
            return Ok(true);
        }
        match self.store.key(token.id()).await? {
            Some(known) if is_of(&token.sha256(), &known.sha256) => Ok(false),
            _ => refused("another key is stored under its id; take a new one"),
        }
    }

    /// Gives a key another secret: its id, name, scopes and data stay, and it lives as long again
    /// as it was to live at first. The old secret and sessions end at once.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id, [`ServiceError::Request`] where it
    /// was revoked.
    pub async fn rotate_key(&self, id: &str) -> Result<(Key, Token), ServiceError> {
        let key = self.key(id).await?;
        let lifetime = key.expires_at_ms.map(|end| end - key.created_at_ms);
        let expires_at_ms = lifetime.map(|lifetime| now_ms() + lifetime);
        let token = Token::with_id(id).ok_or_else(no_random_numbers)?;
        if !self.store.replace_key(id, &token.sha256(), expires_at_ms).await? {
            let reason = format!("key `{id}` was revoked; make a new one");
            return Err(ServiceError::Request { member: "id".into(), reason });
        }
        Ok((self.key(id).await?, token))
    }

    /// Gives a key other quotas, from its next request on; what it has already stays.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id, [`ServiceError::Request`] for quotas
    /// that no key can have.
    pub async fn limit_key(&self, id: &str, quotas: &Quotas) -> Result<Key, ServiceError> {
        quotas.check()?;
        match self.store.limit_key(id, &serde_json::json!(quotas).to_string()).await? {
            true => self.key(id).await,
            false => Err(unknown(id)),
        }
    }

    /// One key.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn key(&self, id: &str) -> Result<Key, ServiceError> {
        self.store.key(id).await?.ok_or_else(|| unknown(id))?.try_into()
    }

    /// Keys, those that were made last first, at most 1000; also those that open nothing any more.
    ///
    /// # Errors
    /// When the database does not answer.
    pub async fn keys(&self) -> Result<Vec<Key>, ServiceError> {
        self.store.keys(MOST_LISTED).await?.into_iter().map(Key::try_from).collect()
    }

    /// Revokes a key for good; what it made stays. Revoking twice is no error.
    ///
    /// # Errors
    /// [`ServiceError::Unknown`] when there is none with this id.
    pub async fn revoke_key(&self, id: &str) -> Result<(), ServiceError> {
        match self.store.revoke_key(id).await? {
            true => Ok(()),
            false => Err(unknown(id)),
        }
    }

    /// Whether requests need a key: they do as soon as any was stored.
    ///
    /// # Errors
    /// When the database does not answer.
    pub async fn has_keys(&self) -> Result<bool, ServiceError> {
        Ok(self.store.has_keys().await?)
    }

    /// Whether some key opens anything.
    ///
    /// # Errors
    /// When the database does not answer.
    pub async fn has_valid_key(&self) -> Result<bool, ServiceError> {
        Ok(self.store.has_valid_key().await?)
    }
}

fn row(token: &Token, name: String, scopes: &[Scope]) -> KeyRow {
    KeyRow {
        id: token.id().to_owned(),
        name,
        scopes: serde_json::json!(scopes).to_string(),
        sha256: token.sha256(),
        created_at_ms: 0,
        expires_at_ms: None,
        revoked_at_ms: None,
        used_at_ms: None,
        quotas: "{}".into(),
        now_ms: 0,
    }
}

pub(super) fn now_ms() -> Millis {
    Timestamp::now().as_millisecond()
}

fn unknown(id: &str) -> ServiceError {
    ServiceError::Unknown { what: "key", id: id.into() }
}

pub(super) fn no_random_numbers() -> ServiceError {
    let reason = "the system has no random numbers; try again".to_owned();
    ServiceError::Request { member: "key".into(), reason }
}
