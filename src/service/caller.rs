//! Who asks, and what it may.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::store::{KeyRow, Millis, Reach};

use super::ServiceError;
use super::quotas::Quotas;

/// Something that a key may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Scope {
    /// Stores and deletes measurements and mappings of its own.
    #[serde(rename = "upload")]
    Upload,
    /// Runs and deletes jobs, plans and validations, and registers webhooks.
    #[serde(rename = "run")]
    Run,
    /// Reads what it has made itself.
    #[serde(rename = "read")]
    Read,
    /// Reads what anybody has made.
    #[serde(rename = "read:all")]
    ReadAll,
    /// Reads the metrics.
    #[serde(rename = "metrics")]
    Metrics,
    /// Everything, with the data of every key.
    #[serde(rename = "admin")]
    Admin,
}

impl Scope {
    /// Every scope.
    pub const ALL: [Self; 6] =
        [Self::Upload, Self::Run, Self::Read, Self::ReadAll, Self::Metrics, Self::Admin];

    /// Its name on the wire, in the store and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Upload => "upload",
            Self::Run => "run",
            Self::Read => "read",
            Self::ReadAll => "read:all",
            Self::Metrics => "metrics",
            Self::Admin => "admin",
        }
    }
}

impl FromStr for Scope {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|scope| scope.name() == text).ok_or_else(|| {
            format!("it is no scope; known: {}", Self::ALL.map(Self::name).join(", "))
        })
    }
}

impl fmt::Display for Scope {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// A stored key, without what only its holder knows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key {
    /// The part of the key by which it is found.
    pub id: String,
    /// Its name, for people.
    pub name: String,
    /// What it may do.
    pub scopes: Vec<Scope>,
    /// When it was made.
    pub created_at_ms: Millis,
    /// When it expires; `None`: never.
    pub expires_at_ms: Option<Millis>,
    /// When it was revoked.
    pub revoked_at_ms: Option<Millis>,
    /// When it was last used, to the minute.
    pub used_at_ms: Option<Millis>,
    /// Whether it opens anything.
    pub valid: bool,
    /// What it may have, where it is not what every key may.
    pub quotas: Quotas,
}

impl Key {
    /// Whether its scopes include this one.
    pub fn may(&self, scope: Scope) -> bool {
        let has = |scope| self.scopes.contains(&scope);
        has(Scope::Admin) || has(scope) || (scope == Scope::Read && has(Scope::ReadAll))
    }

    /// Whose rows it reads and changes.
    pub(super) fn reach(&self) -> Reach {
        Reach {
            owner: self.id.clone(),
            reads_all: self.may(Scope::ReadAll),
            changes_all: self.may(Scope::Admin),
        }
    }
}

impl TryFrom<KeyRow> for Key {
    type Error = ServiceError;

    fn try_from(row: KeyRow) -> Result<Self, ServiceError> {
        let corrupt = |source| ServiceError::Corrupt { what: "key", source };
        let scopes = serde_json::from_str(&row.scopes).map_err(corrupt)?;
        let quotas = serde_json::from_str(&row.quotas).map_err(corrupt)?;
        let valid = row.is_valid();
        let KeyRow { id, name, created_at_ms, expires_at_ms, revoked_at_ms, used_at_ms, .. } = row;
        Ok(Self {
            id,
            name,
            scopes,
            created_at_ms,
            expires_at_ms,
            revoked_at_ms,
            used_at_ms,
            valid,
            quotas,
        })
    }
}

/// Who asks for something.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Caller {
    /// The server itself, its operator, and anybody who asks a server without keys.
    Everybody,
    /// Somebody without a key, who asks a server that has keys.
    Nobody,
    /// The holder of a valid key.
    Holder(Box<Key>),
}

impl Caller {
    /// Whether it may do this.
    pub fn may(&self, scope: Scope) -> bool {
        match self {
            Self::Everybody => true,
            Self::Nobody => false,
            Self::Holder(key) => key.may(scope),
        }
    }

    /// The key, where there is one.
    pub fn key(&self) -> Option<&Key> {
        match self {
            Self::Holder(key) => Some(key),
            Self::Everybody | Self::Nobody => None,
        }
    }

    /// Whose rows it reads and changes.
    pub(super) fn reach(&self) -> Reach {
        match self {
            Self::Everybody => Reach::everything(),
            Self::Nobody => Reach::nothing(),
            Self::Holder(key) => key.reach(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(scopes: &[Scope]) -> Key {
        Key {
            id: "a".into(),
            name: "rig".into(),
            scopes: scopes.to_vec(),
            created_at_ms: 0,
            expires_at_ms: None,
            revoked_at_ms: None,
            used_at_ms: None,
            valid: true,
            quotas: Quotas::default(),
        }
    }

    #[test]
    fn a_scope_includes_no_other_but_for_admin_and_read_all() {
        for given in Scope::ALL {
            for wanted in Scope::ALL {
                let includes = given == wanted
                    || given == Scope::Admin
                    || (given, wanted) == (Scope::ReadAll, Scope::Read);
                assert_eq!(key(&[given]).may(wanted), includes, "{given} {wanted}");
            }
        }
    }

    #[test]
    fn a_key_reaches_its_own_rows_and_others_as_its_scopes_say() {
        let of = |scopes: &[Scope]| {
            let reach = key(scopes).reach();
            (reach.reads_all, reach.changes_all)
        };
        assert_eq!(of(&[Scope::Upload, Scope::Run, Scope::Read, Scope::Metrics]), (false, false));
        assert_eq!(of(&[Scope::Upload, Scope::Run, Scope::ReadAll]), (true, false));
        assert_eq!(of(&[Scope::Admin]), (true, true));
        assert_eq!(key(&[]).reach().owner, "a");
    }

    #[test]
    fn the_names_are_those_that_are_stored() {
        for scope in Scope::ALL {
            assert_eq!(serde_json::json!(scope), scope.name());
        }
    }
}
