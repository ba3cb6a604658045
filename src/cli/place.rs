//! Where a server keeps its data: a folder, or a Postgres database.

use std::fmt;
use std::fs::{File, TryLockError};
use std::path::PathBuf;
use std::sync::Arc;

use crate::config::{Address, ServeConfig, Settings};
use crate::store::{Postgres, Sqlite, Store, StoreError};

use super::Failure;

/// Bytes of a mebibyte.
const MIB: usize = 1 << 20;

/// Name of the file in a folder that whoever has the folder to itself holds locked.
const LOCK: &str = "servoscope.lock";

/// Arguments of commands on the data of a server.
#[derive(Debug, clap::Args)]
#[group(skip)]
pub(super) struct Folder {
    /// File of settings of the server, TOML [default: none].
    #[arg(long = "config", value_name = "FILE", env = "SERVOSCOPE_CONFIG")]
    file: Option<PathBuf>,
    /// Directory of the server's database [default: servoscope-data].
    #[arg(long, value_name = "DIR", env = "SERVOSCOPE_DATA_DIR")]
    data_dir: Option<PathBuf>,
    /// Postgres database of the server [default: none].
    #[arg(long, value_name = "URL", env = "SERVOSCOPE_DATABASE", hide_env_values = true)]
    database: Option<Address>,
}

impl Folder {
    /// Where it is.
    ///
    /// # Errors
    /// [`Failure::Input`] where the file of settings cannot be read.
    pub(super) fn place(&self) -> Result<Place, Failure> {
        let file = self.file.as_deref().map(Settings::read).transpose().map_err(Failure::input)?;
        let told = Settings {
            data_dir: self.data_dir.clone(),
            database: self.database.clone(),
            ..Settings::default()
        };
        let config = ServeConfig::check(told.over(file.unwrap_or_default()));
        Ok(Place::of(&config.map_err(Failure::input)?))
    }
}

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

    /// Sees to it that there is something.
    ///
    /// # Errors
    /// [`Failure::Input`] where there is nothing.
    pub(super) fn must_exist(&self) -> Result<(), Failure> {
        match self {
            Self::Folder(path, _) if !Sqlite::is_in(path) => Err(Failure::Input(format!(
                "there is no database in {self}; name it with --data-dir"
            ))),
            _ => Ok(()),
        }
    }

    /// Keeps the folder from every other server until the value is dropped or the process ends,
    /// however it ends. A database is for any number of servers.
    ///
    /// # Errors
    /// [`Failure::Other`] where another one has it.
    pub(super) fn hold(&self) -> Result<Option<File>, Failure> {
        let Self::Folder(path, _) = self else { return Ok(None) };
        let unusable =
            |error| Failure::Other(format!("cannot keep data in {self}: data directory: {error}"));
        std::fs::create_dir_all(path).map_err(unusable)?;
        let lock = File::options().create(true).append(true).open(path.join(LOCK));
        let lock = lock.map_err(unusable)?;
        match lock.try_lock() {
            Ok(()) => Ok(Some(lock)),
            Err(TryLockError::WouldBlock) => Err(Failure::Other(format!(
                "another server runs on {self}; stop it first, or give this one a folder of its \
                 own with --data-dir (several servers share a Postgres database, --database)"
            ))),
            Err(TryLockError::Error(error)) => Err(unusable(error)),
        }
    }

    /// Opens what is there, and makes what is missing.
    ///
    /// # Errors
    /// [`Failure::Other`] where it cannot be used.
    pub(super) async fn open(&self) -> Result<Arc<dyn Store>, Failure> {
        let opened = match self {
            Self::Folder(path, bytes) => shared(Sqlite::open_limited(path, *bytes).await),
            Self::Database(address) => shared(Postgres::open(address.reveal()).await),
        };
        opened.map_err(|error| Failure::Other(format!("cannot keep data in {self}: {error}")))
    }

    /// Opens what is there, and changes nothing.
    ///
    /// # Errors
    /// [`Failure::Input`] where there is nothing, [`Failure::Other`] where it cannot be used.
    pub(super) async fn open_existing(&self) -> Result<Arc<dyn Store>, Failure> {
        self.must_exist()?;
        let opened = match self {
            Self::Folder(path, _) => shared(Sqlite::open_existing(path).await),
            Self::Database(address) => shared(Postgres::open_existing(address.reveal()).await),
        };
        opened.map_err(|error| Failure::Other(format!("cannot read {self}: {error}")))
    }

    /// How another command is told of it.
    pub(super) fn flag(&self) -> String {
        match self {
            Self::Folder(path, _) => format!("--data-dir {}", path.display()),
            Self::Database(address) => format!("--database {address}"),
        }
    }
}

fn shared(opened: Result<impl Store, StoreError>) -> Result<Arc<dyn Store>, StoreError> {
    Ok(Arc::new(opened?))
}

impl fmt::Display for Place {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Folder(path, _) => write!(formatter, "{}", path.display()),
            Self::Database(address) => write!(formatter, "{address}"),
        }
    }
}
