//! Where a server keeps its data: a folder, or a Postgres database.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use crate::config::{Address, ServeConfig};
use crate::store::{Postgres, Sqlite, Store};

use super::Failure;

/// Bytes of a mebibyte.
const MIB: usize = 1 << 20;

/// Where a server keeps its data.
#[derive(Debug, Clone)]
pub(super) enum Place {
    /// A folder, and how many bytes its database may have.
    Folder(PathBuf, Option<u64>),
    /// A database.
    Database(Address),
}

impl Place {
    /// The one that settings say.
    pub(super) fn of(config: &ServeConfig) -> Self {
        match &config.database {
            Some(address) => Self::Database(address.clone()),
            None => {
                let bytes = config.max_store_mib.map(|size| (size * MIB) as u64);
                Self::Folder(config.data_dir.clone(), bytes)
            }
        }
    }

    /// Whether there is nothing yet.
    pub(super) fn is_empty(&self) -> bool {
        match self {
            Self::Folder(path, _) => !Sqlite::is_in(path),
            Self::Database(_) => false,
        }
    }

    /// Opens what is there, and makes what is missing.
    ///
    /// # Errors
    /// [`Failure::Other`] where it cannot be used.
    pub(super) async fn open(&self) -> Result<Arc<dyn Store>, Failure> {
        let opened = match self {
            Self::Folder(path, bytes) => Sqlite::open_limited(path, *bytes)
                .await
                .map(|store| Arc::new(store) as Arc<dyn Store>),
            Self::Database(address) => Postgres::open(address.reveal())
                .await
                .map(|store| Arc::new(store) as Arc<dyn Store>),
        };
        opened.map_err(|error| Failure::Other(format!("cannot keep data in {self}: {error}")))
    }

    /// How another command is told of it.
    pub(super) fn flag(&self) -> String {
        match self {
            Self::Folder(path, _) => format!("--data-dir {}", path.display()),
            Self::Database(address) => format!("--database {address}"),
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Folder(path, _) => write!(formatter, "{}", path.display()),
            Self::Database(address) => write!(formatter, "{address}"),
        }
    }
}
